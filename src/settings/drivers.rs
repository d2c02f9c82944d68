//! Drivers: the TMC2209 settings of each group of motors.

use super::rows::{Spec, rows};
use super::{Range, Settings, ranges};
use crate::motors::Motor;
use crate::units::MmPerSec;
use serde::{Deserialize, Serialize};

/// The configuration of the drivers of one group of motors.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct DriverSettings {
    /// Root mean square of the current of a running motor, in mA (M906).
    pub current_ma: u16,
    /// Current of a motor at rest, in percent of `current_ma`.
    pub hold_percent: u8,
    /// Microsteps of a full step. Steps per millimetre of an axis are the full steps of its motor times this.
    pub microsteps: u16,
    /// stealthChop instead of spreadCycle (M569).
    pub stealth: bool,
    /// Speed above which spreadCycle replaces stealthChop, 0 for never (M913).
    pub hybrid_threshold: MmPerSec,
    /// StallGuard threshold SGTHRS: the higher, the sooner a load counts as a stall; 0 for never (M914).
    pub stall_threshold: u8,
}

/// Settings of the drivers by group of motors. The four belt motors have one set: they pull one belt.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct DriverGroups {
    /// Motors that move x or y.
    pub belt: DriverSettings,
    /// Motors that move z alone.
    pub z: DriverSettings,
    /// Motors of the filament.
    pub e: DriverSettings,
}

impl DriverGroups {
    /// 800 mA, and half of it at rest, are Marlin's defaults (Configuration_adv.h: X_CURRENT, HOLD_MULTIPLIER), which
    /// suit any NEMA 17 motor of 1.2 A or more. The ball screws hold with the full current: they are not self-locking.
    /// The mode is spreadCycle. Klipper's TMC_Drivers.md advises it where position counts, and stealthChop has to learn
    /// at standstill first. There are 16 microsteps: 80 steps/mm on a pulley of 40 mm, 800 on a lead of 4 mm.
    pub(super) const fn prototype() -> Self {
        let belt = DriverSettings {
            current_ma: 800,
            hold_percent: 50,
            microsteps: 16,
            stealth: false,
            hybrid_threshold: MmPerSec::ZERO,
            stall_threshold: 0,
        };
        Self { belt, z: DriverSettings { hold_percent: 100, ..belt }, e: belt }
    }
}

impl Settings {
    /// The settings of a motor's driver, and their key in machine files: those of the belt for a motor that moves x or
    /// y, else those of z or e.
    #[must_use]
    pub fn driver_of(&self, motor: Motor) -> (&DriverSettings, &'static str) {
        match self.mechanism.axis_of(motor) {
            Some(0 | 1) => (&self.drivers.belt, "drivers.belt"),
            Some(2) => (&self.drivers.z, "drivers.z"),
            _ => (&self.drivers.e, "drivers.e"),
        }
    }
}

fn parts(s: &mut Settings) -> [&mut DriverSettings; 3] {
    [&mut s.drivers.belt, &mut s.drivers.z, &mut s.drivers.e]
}

rows! {
    for driver in parts, named &["drivers.belt", "drivers.z", "drivers.e"];

    /// Current of a running motor, root mean square (M906).
    40 "current_ma" = driver.current_ma, "mA", [ranges::CURRENT_MA.spec()];
    /// Current of a motor at rest, in percent of the running motor's.
    41 "hold_percent" = driver.hold_percent, "%", [ranges::HOLD_PERCENT.spec()];
    /// Microsteps of a full step: 1, 2, 4 and so on up to 256. The axis' steps_per_mm counts them.
    42 "microsteps" = driver.microsteps, "", [ranges::MICROSTEPS.spec()];
    /// Whether motors run in stealthChop instead of spreadCycle (M569).
    43 "stealth" = driver.stealth, "", [Spec::SWITCH];
    /// Speed above which stealthChop gives way to spreadCycle; 0 is never (M913).
    44 "hybrid_threshold" = driver.hybrid_threshold, "mm/s", [ranges::SPEED.spec().from_zero()];
    /// StallGuard threshold: the higher, the sooner a load counts as a stall; 0 is never (M914).
    45 "stall_threshold" = driver.stall_threshold, "", [Range { least: u8::MIN, most: u8::MAX }.spec()];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn screws_hold_with_all_of_their_current_and_the_other_motors_with_half() {
        let DriverGroups { belt, z, e } = DriverGroups::prototype();
        assert_eq!([belt, z, e].map(|group| group.hold_percent), [50, 100, 50]);
    }
}
