//! The program's state as one value: everything that the lines before have set and the next line depends on.
//!
//! A pause saves it and restores it. Every other interruption of the program does the same.
//!
//! Overrides (M220, M221, M111) are no part of it: the user sets them to tune a print, also in a pause. Klipper's
//! `RESTORE_GCODE_STATE` puts speed and flow back, Marlin's M24 does not.

use super::commanded::Commanded;
use super::modal::Modal;
use crate::connectors::FANS;
use crate::settings::{CornerRule, Settings};
use crate::units::{MmPerSec, MmPerSec2, Ratio};

/// All of it.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Program {
    /// Absolute or relative, units, plane, F.
    pub modal: Modal,
    /// Position, E, G92, G10.
    pub commanded: Commanded,
    /// M106: the speed of each fan, of 65,535.
    pub fans: [u16; FANS],
    /// M204, M205, SET_VELOCITY_LIMIT.
    pub dynamics: Dynamics,
}

/// Limits that lines of a program change as they go.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Dynamics {
    /// Accelerations of M204 P, R and T.
    pub accelerations: [MmPerSec2; 3],
    /// M205 J, X and Y.
    pub corner: CornerRule,
    /// M205 Z, E, S and T.
    pub speeds: [MmPerSec; 4],
    /// MINIMUM_CRUISE_RATIO.
    pub cruise_ratio: Ratio,
}

impl Dynamics {
    /// Those in force.
    pub const fn of(s: &Settings) -> Self {
        Self {
            accelerations: [s.print_acceleration, s.retract_acceleration, s.travel_acceleration],
            corner: s.corner,
            speeds: [s.z_jerk, s.extruder_jerk, s.min_feed, s.min_travel],
            cruise_ratio: s.minimum_cruise_ratio,
        }
    }

    /// Puts them in force again.
    pub const fn put(&self, s: &mut Settings) {
        [s.print_acceleration, s.retract_acceleration, s.travel_acceleration] = self.accelerations;
        [s.z_jerk, s.extruder_jerk, s.min_feed, s.min_travel] = self.speeds;
        (s.corner, s.minimum_cruise_ratio) = (self.corner, self.cruise_ratio);
    }
}
