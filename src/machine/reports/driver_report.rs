//! M122: what the motor drivers say of themselves.

use super::report::Hundredths;
use super::speaker::Speaker;
use crate::driver::{Config, DriverError, Drivers, Name, Reading};
use crate::port::Motor;
use crate::settings::Settings;
use crate::units::{Mm, StepsPerMm};
use core::fmt;

/// Full steps of a turn of almost every stepper motor (1.8 degrees).
const FULL_STEPS: u64 = 200;

/// A driver, and what it said; `None` without a UART.
#[derive(Clone, Copy)]
pub(in crate::machine) struct DriverReport {
    motor: Motor,
    reading: Option<Result<Reading, DriverError>>,
}

/// What M122 says of a driver that answers.
struct State<'r> {
    reading: &'r Reading,
    held: Option<Config>,
    power: &'static str,
    turn: Hundredths,
}

impl fmt::Display for State<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (power, turn) = (self.power, &self.turn);
        let Some(held) = self.held else { return write!(f, "not configured yet, motor {power}") };
        let (current, mode) = (held.run_current_ma(), self.reading.mode());
        write!(f, "configured, motor {power}, {current} mA, {mode}, ")?;
        match self.reading.microsteps() {
            Some(microsteps) => write!(f, "{microsteps} microsteps, {turn} mm a turn"),
            None => f.write_str("microsteps by its pins"),
        }
    }
}

/// How a driver is, and how well it is understood.
struct Health<'r>(&'r Reading, Option<DriverError>, u16);

impl fmt::Display for Health<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(reading, problem, failures) = self;
        let open = if reading.seems_open() { ", coil open?" } else { "" };
        let (temperature, stall, writes) = (reading.temperature(), reading.stall(), reading.writes());
        write!(f, "{temperature}{open}, stall result {stall}, {writes} writes, {failures} failed exchanges")?;
        match problem {
            Some(problem) => write!(f, ", {problem}"),
            None => Ok(()),
        }
    }
}

impl DriverReport {
    /// What the driver of `motor` said; `None` if it has no UART.
    pub const fn new(motor: Motor, reading: Option<Result<Reading, DriverError>>) -> Self {
        Self { motor, reading }
    }
}

/// M122, the lines of one driver.
pub(in crate::machine) fn say_driver(to: &mut Speaker<'_>, report: &DriverReport, drivers: &Drivers, s: &Settings) {
    let motor = report.motor;
    let name = Name(motor);
    let reading = match report.reading {
        None => return to.say(format_args!("Driver {name}: no UART, set by its jumpers")),
        Some(Err(error)) => return to.say(format_args!("Driver {name}: {error}")),
        Some(Ok(reading)) => reading,
    };
    let (held, failures) = drivers.known(motor);
    let power = if drivers.powered().has(motor) { "on" } else { "off" };
    let turn = turn_of(s.steps_per_mm(motor), reading.microsteps().unwrap_or_default());
    let state = State { reading: &reading, held, power, turn };
    to.say(format_args!("Driver {name}: {state}"));
    // A driver that nobody has spoken to yet says rightly that it was reset.
    let problem = held.and(reading.problem());
    to.say(format_args!("  {}", Health(&reading, problem, failures)));
}

/// How far a turn of a motor of 200 full steps goes, which shows whether microsteps and steps/mm agree.
fn turn_of(steps_per_mm: StepsPerMm, microsteps: u32) -> Hundredths {
    let steps = (FULL_STEPS * u64::from(microsteps)) << 48;
    Hundredths(Mm::from_bits((steps / u64::from(steps_per_mm.to_bits().max(1))) as i64))
}
