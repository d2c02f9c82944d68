//! The commands for the motor drivers: M122, M569, M906, M913, M914.
//!
//! X and Y both mean the four belt motors, which have one set of settings. A change reaches the drivers of motors
//! with power within a second, in the background and without stopping the motion; the others before they get it.

use super::console::{Console, Interrupt, PortSet};
use super::report::{Hundredths, exact};
use crate::driver::{Config, DriverError, Job, Name, Reading};
use crate::gcode::{AxisFlags, AxisWords, Number};
use crate::port::{Motor, MotorSet, Pend};
use crate::settings::{DriverGroups, DriverSettings, ranges};
use crate::units::{Mm, MmPerSec};
use core::fmt;

/// Full steps of a turn of almost every stepper motor (1.8 degrees).
const FULL_STEPS: u64 = 200;

/// A setting that a command reports or changes for each axis.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum DriverValue {
    /// M906.
    Current,
    /// M913.
    HybridThreshold,
    /// M914.
    StallThreshold,
    /// M569.
    Mode,
}

impl DriverValue {
    const fn code(self) -> &'static str {
        match self {
            Self::Current => "M906",
            Self::HybridThreshold => "M913",
            Self::StallThreshold => "M914",
            Self::Mode => "M569",
        }
    }

    /// The number that its command takes.
    fn number(self, group: &DriverSettings) -> Number {
        match self {
            Self::Current => exact(i32::from(group.current_ma)),
            Self::HybridThreshold => exact(group.hybrid_threshold),
            Self::StallThreshold => exact(i32::from(group.stall_threshold)),
            Self::Mode => exact(i32::from(group.stealth)),
        }
    }
}

/// The value of one axis in Marlin's words.
struct Told<'g>(char, DriverValue, &'g DriverSettings);

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(axis, value, group) = *self;
        let what = match value {
            DriverValue::Current => "driver current",
            DriverValue::HybridThreshold => "stealthChop max speed",
            DriverValue::StallThreshold => "homing sensitivity",
            DriverValue::Mode if group.stealth => return write!(f, "{axis} driver mode: stealthChop"),
            DriverValue::Mode => return write!(f, "{axis} driver mode: spreadCycle"),
        };
        write!(f, "{axis} {what}: {}", value.number(group))
    }
}

/// The values of all axes as the line that sets them.
struct Line<'g>(DriverValue, &'g DriverGroups);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, DriverGroups { belt, z, e }) = *self;
        let [x, z, e] = [belt, z, e].map(|group| value.number(group));
        write!(f, "{} X{x} Y{x} Z{z} E{e}", value.code())
    }
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

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M906, M913, M914; and M569 without S. What `words` name is changed, without words all is reported.
    pub(super) async fn set_drivers(&mut self, value: DriverValue, words: &AxisWords) -> Result<(), Interrupt> {
        if self.drivers.lines().is_empty() {
            return self.say(format_args!("echo:drivers are set by their jumpers")).await;
        }
        if *words == AxisWords::default() {
            let DriverGroups { belt, z, e } = self.settings.drivers;
            for (axis, group) in [('X', belt), ('Y', belt), ('Z', z), ('E', e)] {
                self.say(format_args!("{}", Told(axis, value, &group))).await?;
            }
            return Ok(());
        }
        let code = value.code();
        if words.x.is_some() && words.y.is_some() && words.x != words.y {
            return self.say(format_args!("echo:{code} ignored: X and Y move one belt and need the same value")).await;
        }
        let mut wanted = self.settings.drivers;
        let DriverGroups { belt, z, e } = &mut wanted;
        let mut is_legal = true;
        for (group, number) in [(belt, words.x.or(words.y)), (z, words.z), (e, words.e)] {
            if let Some(number) = number {
                is_legal &= self.change(group, value, number);
            }
        }
        if !is_legal {
            // A current that nobody asked for could burn a motor.
            let (least, most) = (ranges::CURRENT_MA.least, ranges::CURRENT_MA.most);
            return self.say(format_args!("echo:{code} ignored: {least} to {most} mA")).await;
        }
        self.settings.drivers = wanted;
        self.drivers.want(&self.settings);
        Ok(())
    }

    /// Changes one value; false if it is illegal.
    fn change(&self, group: &mut DriverSettings, value: DriverValue, number: Number) -> bool {
        match value {
            DriverValue::Current => {
                group.current_ma = u16::try_from(number.to_u32()).unwrap_or(u16::MAX);
                return ranges::CURRENT_MA.holds(group.current_ma);
            }
            DriverValue::HybridThreshold => {
                let wanted = MmPerSec::saturating_from_num(self.modal.length(number));
                group.hybrid_threshold = wanted.min(ranges::SPEED.most);
            }
            DriverValue::StallThreshold => group.stall_threshold = u8::try_from(number.to_u32()).unwrap_or(u8::MAX),
            DriverValue::Mode => group.stealth = number != Number::ZERO,
        }
        true
    }

    /// M569. The motion rests first: a motor that changes its mode at speed may lose steps.
    pub(super) async fn set_stealth(&mut self, on: Option<bool>, axes: AxisFlags) -> Result<(), Interrupt> {
        let mut words = AxisWords::default();
        if let Some(on) = on.filter(|_| !self.drivers.lines().is_empty()) {
            self.finish().await?;
            let all = axes == AxisFlags::default();
            let word = |is_named: bool| (is_named || all).then_some(Number::from(i32::from(on)));
            words = AxisWords { x: word(axes.x), y: word(axes.y), z: word(axes.z), e: word(axes.e) };
        }
        self.set_drivers(DriverValue::Mode, &words).await?;
        self.until(|c| c.drivers.is_settled()).await
    }

    /// M503, the part of the drivers.
    pub(super) async fn report_driver_settings(&mut self) -> Result<(), Interrupt> {
        if self.drivers.lines().is_empty() {
            return Ok(());
        }
        let groups = self.settings.drivers;
        for (group, axes) in [(groups.belt, "X Y"), (groups.z, "Z"), (groups.e, "E")] {
            self.say(format_args!("echo:  M569 S{} {axes}", u8::from(group.stealth))).await?;
        }
        for value in [DriverValue::Current, DriverValue::HybridThreshold, DriverValue::StallThreshold] {
            self.say(format_args!("echo:  {}", Line(value, &groups))).await?;
        }
        Ok(())
    }

    /// M122.
    pub(super) async fn report_drivers(&mut self) -> Result<(), Interrupt> {
        for motor in Motor::ALL {
            let name = Name(motor);
            if !self.drivers.lines().has(motor) {
                self.say(format_args!("Driver {name}: no UART, set by its jumpers")).await?;
                continue;
            }
            let reading = match self.ask_driver(Job::Read, motor).await? {
                Ok(reading) => reading,
                Err(error) => {
                    self.say(format_args!("Driver {name}: {error}")).await?;
                    continue;
                }
            };
            let (held, failures) = self.drivers.known(motor);
            let power = if self.drivers.powered().has(motor) { "on" } else { "off" };
            let turn = self.turn_of(motor, reading.microsteps().unwrap_or_default());
            let state = State { reading: &reading, held, power, turn };
            self.say(format_args!("Driver {name}: {state}")).await?;
            // A driver that nobody has spoken to yet says rightly that it was reset.
            let problem = held.and(reading.problem());
            self.say(format_args!("  {}", Health(&reading, problem, failures))).await?;
        }
        Ok(())
    }

    /// How far a turn of a motor of 200 full steps goes, which shows whether microsteps and steps/mm agree.
    fn turn_of(&self, motor: Motor, microsteps: u32) -> Hundredths {
        let (axes, set) = (&self.settings.axes, MotorSet::of(motor));
        let axis = match set {
            s if s.without(MotorSet::BELT).is_empty() => axes.x,
            s if s.without(MotorSet::Z).is_empty() => axes.z,
            _ => axes.e,
        };
        let steps = (FULL_STEPS * u64::from(microsteps)) << 48;
        Hundredths(Mm::from_bits((steps / u64::from(axis.steps_per_mm.to_bits().max(1))) as i64))
    }
}
