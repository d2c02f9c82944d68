//! The settings of the motor drivers: M569, M906, M913, M914.
//!
//! X and Y both mean the four belt motors, which have one set of settings. A change reaches the drivers of motors
//! with power within a second, in the background and without stopping the motion; the others before they get it.

use super::settings::shown::exact;
use crate::gcode::{AxisFlags, AxisWords, Number};
use crate::machine::console::{Console, Interrupt, PortSet};
use crate::machine::reports::answer::Answer;
use crate::port::Pend;
use crate::settings::{DriverGroups, DriverSettings, Range, ranges};
use crate::units::MmPerSec;
use core::fmt;

/// A setting that a command reports or changes for each axis.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::machine) enum DriverValue {
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
    pub const fn code(self) -> &'static str {
        match self {
            Self::Current => "M906",
            Self::HybridThreshold => "M913",
            Self::StallThreshold => "M914",
            Self::Mode => "M569",
        }
    }

    /// The number that its command takes.
    pub fn number(self, group: &DriverSettings) -> Number {
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

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M906, M913, M914; and M569 without S. What `words` name is changed, without words all is reported.
    pub(in crate::machine) fn set_drivers(&mut self, value: DriverValue, words: &AxisWords) -> Answer<'static> {
        if self.drivers.lines().is_empty() {
            return Answer::Line("echo:drivers are set by their jumpers");
        }
        if *words == AxisWords::default() {
            return Answer::DriverValues(value);
        }
        let code = value.code();
        if words.x.is_some() && words.y.is_some() && words.x != words.y {
            return Answer::OneBelt(code);
        }
        let mut wanted = self.settings.drivers;
        let DriverGroups { belt, z, e } = &mut wanted;
        let mut is_legal = true;
        let xy = if words.x.is_some() { "X" } else { "Y" };
        for (group, axis, number) in [(belt, xy, words.x.or(words.y)), (z, "Z", words.z), (e, "E", words.e)] {
            if let Some(number) = number {
                is_legal &= self.change(group, value, axis, number);
            }
        }
        if !is_legal {
            // A current that nobody asked for could burn a motor.
            return Answer::IllegalCurrent(code);
        }
        self.settings.drivers = wanted;
        self.drivers.want(&self.settings);
        Answer::Nothing
    }

    /// One of them for each axis.
    pub(in crate::machine) fn say_driver_values(&mut self, value: DriverValue) {
        let DriverGroups { belt, z, e } = self.settings.drivers;
        for (axis, group) in [('X', belt), ('Y', belt), ('Z', z), ('E', e)] {
            self.say(format_args!("{}", Told(axis, value, &group)));
        }
    }

    /// Changes one value; false if it is illegal.
    fn change(&mut self, group: &mut DriverSettings, value: DriverValue, axis: &'static str, number: Number) -> bool {
        match value {
            DriverValue::Current => {
                group.current_ma = u16::try_from(number.to_u32()).unwrap_or(u16::MAX);
                return ranges::CURRENT_MA.holds(group.current_ma);
            }
            DriverValue::HybridThreshold => {
                let range = Range { least: MmPerSec::ZERO, ..ranges::SPEED };
                group.hybrid_threshold = self.clamps.length(&self.modal, [value.code(), axis], number, range);
            }
            DriverValue::StallThreshold => {
                let range = Range { least: 0, most: u16::from(u8::MAX) };
                group.stall_threshold = self.clamps.whole([value.code(), axis], number, range) as u8;
            }
            DriverValue::Mode => group.stealth = number != Number::ZERO,
        }
        true
    }

    /// M569. The motion rests first: a motor that changes its mode at speed may lose steps.
    pub(in crate::machine) async fn set_stealth(
        &mut self,
        on: Option<bool>,
        axes: AxisFlags,
    ) -> Result<Answer<'static>, Interrupt> {
        let mut words = AxisWords::default();
        if let Some(on) = on.filter(|_| !self.drivers.lines().is_empty()) {
            self.finish().await?;
            let all = axes == AxisFlags::default();
            let word = |is_named: bool| (is_named || all).then_some(Number::from(i32::from(on)));
            words = AxisWords { x: word(axes.x), y: word(axes.y), z: word(axes.z), e: word(axes.e) };
        }
        let answer = self.set_drivers(DriverValue::Mode, &words);
        self.until(|c| c.drivers.is_settled()).await?;
        Ok(answer)
    }
}
