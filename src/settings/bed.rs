//! The bed: where the machine can print, which may be less than where its tool can go.

use super::{Axes, AxisSettings};
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
}

impl Bed {
    /// All that the tool reaches.
    #[must_use]
    pub const fn of_reach(axes: &Axes<AxisSettings>) -> Self {
        Self { width: axes.x.length, depth: axes.y.length, left: Mm::ZERO, front: Mm::ZERO }
    }
}
