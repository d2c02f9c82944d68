//! The bed: where the machine can print, which may be less than where its tool can go.

use super::rows::rows;
use super::{Range, Settings, ranges};
use crate::units::Mm;
use serde::{Deserialize, Serialize};

/// A rectangle in the coordinates of the homed machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Bed {
    /// Its size in x.
    pub width: Mm,
    /// Its size in y.
    pub depth: Mm,
    /// x of its left edge.
    pub left: Mm,
    /// y of its front edge.
    pub front: Mm,
    /// How far z stands above the place that the program names, from homing on (M290, SET_GCODE_OFFSET).
    pub z_offset: Mm,
}

impl Bed {
    /// All that the tool reaches.
    #[must_use]
    pub const fn of_reach(x: Range<Mm>, y: Range<Mm>) -> Self {
        let (width, depth) = (x.most.saturating_sub(x.least), y.most.saturating_sub(y.least));
        Self { width, depth, left: x.least, front: y.least, z_offset: Mm::ZERO }
    }
}

impl Settings {
    /// Whether the probe's offset is the one of z that is kept over homing. Otherwise [`Bed::z_offset`] is.
    #[must_use]
    pub const fn keeps_by_probe(&self) -> bool {
        self.probe.is_fitted() && self.probe.homes_z
    }

    /// The offset of z that is kept over homing.
    #[must_use]
    pub const fn z_offset(&self) -> Mm {
        if self.keeps_by_probe() { self.probe.offset.z } else { self.bed.z_offset }
    }

    /// Sets it.
    pub const fn set_z_offset(&mut self, offset: Mm) {
        if self.keeps_by_probe() {
            self.probe.offset.z = offset;
        } else {
            self.bed.z_offset = offset;
        }
    }
}

fn parts(s: &mut Settings) -> [&mut Bed; 1] {
    [&mut s.bed]
}

rows! {
    for bed in parts, named &["bed"];

    /// Size in x.
    27 "width" = bed.width, "mm", [ranges::AXIS_LENGTH.spec()];
    /// Size in y.
    28 "depth" = bed.depth, "mm", [ranges::AXIS_LENGTH.spec()];
    /// x of its left edge.
    29 "left" = bed.left, "mm", [ranges::PLACE.spec()];
    /// y of its front edge.
    30 "front" = bed.front, "mm", [ranges::PLACE.spec()];
    /// How far z stands above the place that the program names, from homing on (M290, SET_GCODE_OFFSET).
    125 "z_offset" = bed.z_offset, "mm", [ranges::Z_OFFSET.spec()];
}
