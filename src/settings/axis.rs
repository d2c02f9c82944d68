//! Axes: one value per axis, and the properties of an axis.

use super::rows::rows;
use super::{HomedAxis, ranges};
use crate::units::{Mm, MmPerSec, MmPerSec2, StepsPerMm};
use serde::{Deserialize, Serialize};

/// One value for each of X, Y, Z and E.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Hash, Serialize, Deserialize)]
pub struct Axes<T> {
    /// Left to right.
    pub x: T,
    /// Front to back.
    pub y: T,
    /// Bed to nozzle.
    pub z: T,
    /// Filament.
    pub e: T,
}

impl<T: Copy> Axes<T> {
    /// The values in the order x, y, z, e.
    #[must_use]
    pub const fn to_array(self) -> [T; 4] {
        [self.x, self.y, self.z, self.e]
    }

    /// The same shape with every value put through `f`.
    #[must_use]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Axes<U> {
        Axes { x: f(self.x), y: f(self.y), z: f(self.z), e: f(self.e) }
    }
}

impl<T> Axes<T> {
    /// The value of an axis, by its number.
    #[must_use]
    pub const fn get(&self, axis: usize) -> Option<&T> {
        match axis {
            0 => Some(&self.x),
            1 => Some(&self.y),
            2 => Some(&self.z),
            3 => Some(&self.e),
            _ => None,
        }
    }

    /// The value of an axis, by its number.
    #[must_use]
    pub const fn get_mut(&mut self, axis: usize) -> Option<&mut T> {
        match axis {
            0 => Some(&mut self.x),
            1 => Some(&mut self.y),
            2 => Some(&mut self.z),
            3 => Some(&mut self.e),
            _ => None,
        }
    }
}

impl<T> From<[T; 4]> for Axes<T> {
    fn from([x, y, z, e]: [T; 4]) -> Self {
        Self { x, y, z, e }
    }
}

/// One value for each of X, Y and Z.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Hash, Serialize, Deserialize)]
pub struct Cartesian<T> {
    /// Left to right.
    pub x: T,
    /// Front to back.
    pub y: T,
    /// Bed to nozzle.
    pub z: T,
}

impl<T> Cartesian<T> {
    /// The value of an axis, by its number.
    pub(super) const fn get_mut(&mut self, axis: usize) -> Option<&mut T> {
        match axis {
            0 => Some(&mut self.x),
            1 => Some(&mut self.y),
            2 => Some(&mut self.z),
            _ => None,
        }
    }
}

impl<T: Copy> Cartesian<T> {
    /// The values in the order x, y, z.
    #[must_use]
    pub const fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }

    /// The value of an axis.
    #[must_use]
    pub const fn of(&self, axis: HomedAxis) -> T {
        match axis {
            HomedAxis::X => self.x,
            HomedAxis::Y => self.y,
            HomedAxis::Z => self.z,
        }
    }
}

/// Resolution, limits and length of one axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct AxisSettings {
    /// Steps a millimetre (M92).
    pub steps_per_mm: StepsPerMm,
    /// Speed limit (M203).
    pub max_speed: MmPerSec,
    /// Acceleration limit (M201).
    pub max_acceleration: MmPerSec2,
    /// Travel of the axis: its positions are [`Settings::reach`](super::Settings::reach). For E, the longest single
    /// move.
    pub length: Mm,
}

impl AxisSettings {
    /// An axis of the prototype's belt stage.
    pub(super) const fn belt(length: Mm) -> Self {
        Self {
            steps_per_mm: StepsPerMm::const_from_int(80),
            max_speed: MmPerSec::const_from_int(300),
            max_acceleration: MmPerSec2::const_from_int(5000),
            length,
        }
    }
}

/// How an axis finds its endstop; where that sits is its [`Endstop`](super::Endstop).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Homing {
    /// Speed of the first approach.
    pub fast: MmPerSec,
    /// Speed of the second approach, which decides the position.
    pub slow: MmPerSec,
    /// Back-off distance of the axis between the two.
    pub back_off: Mm,
    /// What the program counts more than the machine, from homing on (M206).
    pub offset: Mm,
}

impl Homing {
    /// The stop at the switch is sudden; 40 mm/s is 25 N on a 0.6 kg head that stops in 1 mm.
    pub(super) const fn belt() -> Self {
        Self {
            fast: MmPerSec::const_from_int(40),
            slow: MmPerSec::const_from_int(5),
            back_off: Mm::const_from_int(5),
            offset: Mm::ZERO,
        }
    }

    pub(super) const fn screw() -> Self {
        Self {
            fast: MmPerSec::const_from_int(8),
            slow: MmPerSec::const_from_int(1),
            back_off: Mm::const_from_int(2),
            offset: Mm::ZERO,
        }
    }
}

rows! {
    for axis in |s, part| s.axes.get_mut(part), named &["axes.x", "axes.y", "axes.z", "axes.e"];

    /// Steps a millimetre.
    20 "steps_per_mm" = &mut axis.steps_per_mm, "steps/mm", [ranges::STEPS_PER_MM.spec()], "M92" "X" "Y" "Z" "E";
    /// Speed limit.
    21 "max_speed" = &mut axis.max_speed, "mm/s", [ranges::SPEED.spec()], "M203" "X" "Y" "Z" "E";
    /// Acceleration limit.
    22 "max_acceleration" = &mut axis.max_acceleration, "mm/s2", [ranges::ACCELERATION.spec()], "M201" "X" "Y" "Z" "E";
    /// Travel of the axis, from min on; for the extruder, the longest single move.
    23 "length" = &mut axis.length, "mm", [ranges::AXIS_LENGTH.spec()];
}

/// Rows of the places where axes begin.
pub(super) mod min {
    use super::*;

    rows! {
        for min in |s, part| s.axis_min.get_mut(part), named &["axes.x", "axes.y", "axes.z"];

        /// The least position of the axis; the greatest is this and its length, at most 5000.
        103 "min" = min, "mm", [ranges::PLACE.spec()];
    }
}

/// Rows of [`Homing`].
pub(super) mod homing {
    use super::*;

    rows! {
        for axis in |s, part| s.homing.get_mut(part), named &["homing.x", "homing.y", "homing.z"];

        /// Speed of the first approach.
        24 "fast" = &mut axis.fast, "mm/s", [ranges::SPEED.spec()];
        /// Speed of the second approach, which decides the position.
        25 "slow" = &mut axis.slow, "mm/s", [ranges::SPEED.spec()];
        /// How far the axis backs off between the two.
        26 "back_off" = &mut axis.back_off, "mm", [ranges::BACK_OFF.spec()];
        /// Home offset: the program counts this more than the machine, from homing on.
        126 "offset" = &mut axis.offset, "mm", [ranges::PLACE.spec()], "M206" "X" "Y" "Z";
    }
}
