//! Drivers: the TMC2209 settings of each group of motors, and of single motors.

use super::motor_keys::{MotorKeys, motor_keys, texts};
use super::rows::{Spec, rows};
use super::{Range, Settings, ranges};
use crate::motors::{MOTORS, Motor, MotorSet};
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
    /// Whether the driver interpolates its microsteps to 256.
    pub interpolate: bool,
    /// stealthChop instead of spreadCycle (M569).
    pub stealth: bool,
    /// Speed above which spreadCycle replaces stealthChop, 0 for never (M913).
    pub hybrid_threshold: MmPerSec,
    /// StallGuard threshold SGTHRS: the higher, the sooner a load counts as a stall; 0 for never (M914).
    pub stall_threshold: u8,
}

/// Values of a single motor's driver. 0 stands for the value of its group.
///
/// Motors of one axis may be of different kinds, so each may need its own current, and its own threshold to tell a load
/// from a stall. One that holds a weight needs more current at rest than the others of its group. Microsteps must agree
/// within an axis, so no motor has its own.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Default, Serialize, Deserialize)]
pub struct OwnDriver {
    /// [`DriverSettings::current_ma`] (M906 I).
    pub current_ma: u16,
    /// [`DriverSettings::hold_percent`].
    pub hold_percent: u8,
    /// [`DriverSettings::stall_threshold`] (M914 I).
    pub stall_threshold: u8,
}

impl OwnDriver {
    /// All values are the group's.
    pub const NONE: Self = Self { current_ma: 0, hold_percent: 0, stall_threshold: 0 };
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
    /// Values of single motors, in the order of [`Motor::ALL`].
    pub own: [OwnDriver; MOTORS],
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
            interpolate: true,
            stealth: false,
            hybrid_threshold: MmPerSec::ZERO,
            stall_threshold: 0,
        };
        Self { belt, z: DriverSettings { hold_percent: 100, ..belt }, e: belt, own: [OwnDriver::NONE; MOTORS] }
    }
}

/// The key of the drivers of the belt in machine files.
const BELT: &str = "drivers.belt";
/// The same of the drivers of z.
const Z: &str = "drivers.z";
/// The same of the drivers of the filament.
const E: &str = "drivers.e";

impl DriverGroups {
    /// The names of the groups in machine files. A motor with such a name has no section of its own.
    pub const NAMES: [&str; 3] = ["belt", "z", "e"];

    /// A group, by its place in [`NAMES`](Self::NAMES).
    const fn group_mut(&mut self, group: usize) -> Option<&mut DriverSettings> {
        match group {
            0 => Some(&mut self.belt),
            1 => Some(&mut self.z),
            2 => Some(&mut self.e),
            _ => None,
        }
    }

    /// The own values of a motor.
    #[must_use]
    pub fn own(&self, motor: Motor) -> OwnDriver {
        self.own.get(motor.index()).copied().unwrap_or(OwnDriver::NONE)
    }
}

impl Settings {
    /// The group of a motor's driver, and its key in machine files: the belt's for a motor that moves x or y, else the
    /// group of z or e.
    #[must_use]
    pub fn driver_group(&self, motor: Motor) -> (&DriverSettings, &'static str) {
        match self.mechanism.axis_of(motor) {
            Some(0 | 1) => (&self.drivers.belt, BELT),
            Some(2) => (&self.drivers.z, Z),
            _ => (&self.drivers.e, E),
        }
    }

    /// The settings of a motor's driver: its own where it has any, else its group's.
    #[must_use]
    pub fn driver_of(&self, motor: Motor) -> DriverSettings {
        let (own, mut driver) = (self.drivers.own(motor), *self.driver_group(motor).0);
        if own.current_ma != 0 {
            driver.current_ma = own.current_ma;
        }
        if own.hold_percent != 0 {
            driver.hold_percent = own.hold_percent;
        }
        if own.stall_threshold != 0 {
            driver.stall_threshold = own.stall_threshold;
        }
        driver
    }

    /// The motors of an axis that a line can give values of their own, by their places (I of M906): those that move
    /// this axis alone. A motor without another one in its group has the group's values, unless it has its own already.
    /// Motors of one closed belt are alike.
    #[must_use]
    pub fn single_drivers(&self, axis: usize) -> MotorSet {
        let fitted = self.mechanism.fitted();
        let group = |motor: Motor| self.driver_group(motor).1;
        let is_single = |motor: &Motor| {
            let row = self.mechanism.rows.get(motor.index()).copied().unwrap_or_default();
            let moves_it_alone = row.iter().enumerate().all(|(other, times)| (*times != 0) == (other == axis));
            let has_others = fitted.iter().any(|other| other != *motor && group(other) == group(*motor));
            moves_it_alone
                && (has_others || self.drivers.own(*motor) != OwnDriver::NONE)
                && !DriverGroups::NAMES.contains(&self.name_of(*motor).as_str())
                && !(self.belt.is_closed && group(*motor) == BELT)
        };
        fitted.iter().filter(is_single).fold(MotorSet::NONE, |set, motor| set.with(MotorSet::of(motor)))
    }
}

rows! {
    for driver in |s, part| s.drivers.group_mut(part), named &[BELT, Z, E];

    /// Current of a running motor, root mean square (M906).
    40 "current_ma" = &mut driver.current_ma, "mA", [ranges::CURRENT_MA.spec()];
    /// Current of a motor at rest, in percent of the running motor's.
    41 "hold_percent" = &mut driver.hold_percent, "%", [ranges::HOLD_PERCENT.spec()];
    /// Microsteps of a full step: 1, 2, 4 and so on up to 256. The axis' steps_per_mm counts them.
    42 "microsteps" = &mut driver.microsteps, "", [ranges::MICROSTEPS.spec()];
    /// Whether motors run in stealthChop instead of spreadCycle (M569).
    43 "stealth" = &mut driver.stealth, "", [Spec::SWITCH];
    /// Speed above which stealthChop gives way to spreadCycle; 0 is never (M913).
    44 "hybrid_threshold" = &mut driver.hybrid_threshold, "mm/s", [ranges::SPEED.spec().from_zero()];
    /// StallGuard threshold: the higher, the sooner a load counts as a stall; 0 is never (M914).
    45 "stall_threshold" = &mut driver.stall_threshold, "", [Range { least: u8::MIN, most: u8::MAX }.spec()];
    /// Whether drivers interpolate microsteps to 256: quieter, and the motor follows half a microstep later.
    104 "interpolate" = &mut driver.interpolate, "", [Spec::SWITCH];
}

/// Rows of [`DriverGroups::own`].
pub(super) mod own {
    use super::*;

    /// The tables of the motors, by their numbers.
    const KEYS: MotorKeys<10> = motor_keys(*b"drivers.#0");

    rows! {
        for driver in |s, part| s.drivers.own.get_mut(part), named &texts(&KEYS);

        /// Own current of this motor, root mean square (M906 I). Left out, it has the current of its group, `belt`, `z`
        /// or `e`.
        101 "current_ma" = &mut driver.current_ma, "mA", [ranges::CURRENT_MA.spec().or_group()];
        /// Own StallGuard threshold of this motor (M914 I). Left out, it has the threshold of its group.
        102 "stall_threshold" = &mut driver.stall_threshold, "", [ranges::OWN_STALL_THRESHOLD.spec().or_group()];
        /// Own current of this motor at rest, in percent of the running motor's. Left out, it has that of its group.
        105 "hold_percent" = &mut driver.hold_percent, "%", [ranges::OWN_HOLD_PERCENT.spec().or_group()];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motors::prototype;

    #[test]
    fn screws_hold_with_all_of_their_current_and_the_other_motors_with_half() {
        let DriverGroups { belt, z, e, .. } = DriverGroups::prototype();
        assert_eq!([belt, z, e].map(|group| group.hold_percent), [50, 100, 50]);
    }

    #[test]
    fn a_motor_has_its_own_values_and_those_of_its_group_otherwise() {
        let mut s = Settings::prototype();
        let group = s.drivers.z;
        s.drivers.own[prototype::Z2.index()] = OwnDriver { current_ma: 600, ..OwnDriver::NONE };
        assert_eq!(s.driver_of(prototype::Z1), group);
        assert_eq!(s.driver_of(prototype::Z2), DriverSettings { current_ma: 600, ..group });
        s.drivers.own[prototype::Z2.index()] = OwnDriver { stall_threshold: 7, ..OwnDriver::NONE };
        assert_eq!(s.driver_of(prototype::Z2), DriverSettings { stall_threshold: 7, ..group });
        s.drivers.own[prototype::Z2.index()] = OwnDriver { hold_percent: 40, ..OwnDriver::NONE };
        assert_eq!(s.driver_of(prototype::Z2), DriverSettings { hold_percent: 40, ..group });
    }

    #[test]
    fn lines_reach_single_motors_that_move_an_axis_alone_and_not_those_of_a_closed_belt() {
        let mut s = Settings::prototype();
        let single = |s: &Settings| [0, 1, 2, 3].map(|axis| s.single_drivers(axis));
        let [none, z] = [MotorSet::NONE, prototype::Z];
        assert_eq!(single(&s), [none, none, z, none]);
        s.belt.is_closed = false;
        assert_eq!(single(&s), [none, none, z, none], "each belt motor moves x and y");
        s.mechanism.rows[..4].copy_from_slice(&[[1, 0, 0, 0], [0, 1, 0, 0], [0, -1, 0, 0], [0; 4]]);
        let (x, y) = (MotorSet::of(prototype::M1), MotorSet::of(prototype::M4).with(MotorSet::of(prototype::M8)));
        assert_eq!(single(&s), [x, y, z, none]);
        s.belt.is_closed = true;
        assert_eq!(single(&s), [none, none, z, none]);
        s.drivers.own[prototype::E0.index()].current_ma = 500;
        assert_eq!(single(&s)[3], MotorSet::of(prototype::E0), "alone, but with a value of its own");
        s.motor_names[prototype::Z1.index()] = crate::motors::MotorName::lit("z");
        assert_eq!(single(&s)[2], MotorSet::of(prototype::Z2), "z is the group");
    }
}
