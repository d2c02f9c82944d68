//! Reports of motor drivers: their state (M122), and their settings (M569, M906, M913, M914).

use crate::driver::{Chip, DriverError, Drivers, Held, Reading, Shown};
use crate::gcode::Number;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::Hundredths;
use crate::machine::reports::driver_value::DriverValue;
use crate::port::Motor;
use crate::settings::{DriverGroups, Settings};
use crate::units::StepsPerMm;
use core::fmt;

/// Full steps of a turn of almost every stepper motor (1.8 degrees).
const FULL_STEPS: i64 = 200;

/// The state of a driver that answers, for M122.
struct State<'r> {
    shown: &'r Shown,
    held: Option<Held>,
    power: &'static str,
    turn: Hundredths,
    /// The speed at which stealthChop ends.
    threshold: Option<Hundredths>,
}

impl fmt::Display for State<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (power, turn) = (self.power, &self.turn);
        let Some(held) = self.held else { return put!(f, "not configured yet, motor {power}") };
        let (current, mode) = (held.run_ma, self.shown.mode);
        put!(f, "configured, motor {power}, {current} mA, {mode}")?;
        if let (Some(threshold), true) = (&self.threshold, self.shown.is_quiet) {
            put!(f, " up to {threshold} mm/s")?;
        }
        match self.shown.microsteps {
            Some(microsteps) => {
                let steps = if self.shown.interpolates { "microsteps" } else { "plain microsteps" };
                put!(f, ", {microsteps} {steps}, {turn} mm a turn")?;
            }
            None => put!(f, ", microsteps by its pins")?,
        }
        put!(f, ", {} mA at rest", held.hold_ma)
    }
}

/// How a driver is, and how well it is understood.
struct Health<'r>(&'r Reading, &'r Shown, Option<DriverError>, u16);

impl fmt::Display for Health<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(reading, shown, problem, failures) = self;
        let open = if shown.seems_open { ", coil open?" } else { "" };
        let (temperature, stall, writes) = (shown.temperature, reading.load(), reading.writes);
        put!(f, "{temperature}{open}, stall result {stall}, {writes} writes, {failures} failed exchanges")?;
        match problem {
            Some(problem) => write!(f, ", {problem}"),
            None => Ok(()),
        }
    }
}

/// What is known of a driver that has answered.
pub(super) struct Seen {
    reading: Reading,
    shown: Shown,
    held: Option<Held>,
    failures: u16,
    has_power: bool,
}

impl Seen {
    pub fn new<C: Chip>(drivers: &Drivers<C>, motor: Motor, reading: Reading) -> Self {
        let (held, failures) = drivers.known(motor);
        Self { reading, shown: drivers.shown(&reading), held, failures, has_power: drivers.powered().has(motor) }
    }
}

/// M122, the lines of one driver; `None` without a UART.
pub(super) fn report_driver(
    to: &mut ReplyWriter<'_>,
    motor: Motor,
    seen: Option<&Result<Seen, DriverError>>,
    s: &Settings,
) {
    let name = s.name_of(motor);
    let Seen { reading, shown, held, failures, has_power } = match seen {
        None => return to.say(text!("Driver {name}: no UART, set by its jumpers")),
        Some(Err(error)) => return to.say(text!("Driver {name}: {error}")),
        Some(Ok(seen)) => seen,
    };
    let power = if *has_power { "on" } else { "off" };
    let turn = turn_of(s.steps_per_mm(motor), shown.microsteps.unwrap_or_default());
    let rate = held.and_then(|held| held.quiet_steps_per_s);
    let threshold = rate.map(|rate| Hundredths::of(s.steps_per_mm(motor).length_of(rate.into())));
    let state = State { shown, held: *held, power, turn, threshold };
    to.say(text!("Driver {name}: {state}"));
    // A driver that got no message yet rightly reports that it was reset.
    let problem = held.and(shown.problem);
    to.say(text!("  {}", Health(reading, shown, problem, *failures)));
}

/// The distance for a turn of a motor of 200 full steps, which shows whether microsteps and steps/mm agree.
fn turn_of(steps_per_mm: StepsPerMm, microsteps: u32) -> Hundredths {
    Hundredths::of(steps_per_mm.length_of(FULL_STEPS * i64::from(microsteps)))
}

/// The value of one axis, or of a motor with its own, in Marlin's words.
struct DriverValueLine<N>(N, DriverValue, Number);

impl<N: fmt::Display> fmt::Display for DriverValueLine<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(name, value, number) = self;
        let what = match value {
            DriverValue::Current => packed!("driver current"),
            DriverValue::HybridThreshold => packed!("stealthChop max speed"),
            DriverValue::StallThreshold => packed!("homing sensitivity"),
            DriverValue::Mode if *number == Number::ZERO => return put!(f, "{name} driver mode: spreadCycle"),
            DriverValue::Mode => return put!(f, "{name} driver mode: stealthChop"),
        };
        write!(f, "{name} {what}: {number}")
    }
}

/// One value of each axis, and of each motor that has its own.
pub(super) fn report_driver_values(to: &mut ReplyWriter<'_>, value: DriverValue, s: &Settings) {
    let DriverGroups { belt, z, e, .. } = s.drivers;
    for (axis, group) in [('X', belt), ('Y', belt), ('Z', z), ('E', e)] {
        to.say(text!("{}", DriverValueLine(axis, value, value.number(&group))));
    }
    report_own_driver_values(to, value, s);
}

/// The value of each motor that has its own.
pub(super) fn report_own_driver_values(to: &mut ReplyWriter<'_>, value: DriverValue, s: &Settings) {
    for (motor, number) in value.of_motors(s) {
        to.say(text!("{}", DriverValueLine(s.name_of(motor), value, number)));
    }
}
