//! Endstops: at which end of its axis each switch sits, where that is, and in which order G28 looks for them.

use super::rows::{Choice, Chosen, Spec, rows};
use super::{Range, Settings, ranges};
use crate::units::Mm;
use serde::{Deserialize, Serialize};

/// An end of an axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum AxisEnd {
    /// Where positions are small: homing goes down.
    Min,
    /// Where positions are great: homing goes up.
    Max,
}

impl AxisEnd {
    /// Its name in machine files and M119.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Max => "max",
        }
    }

    /// Where an endstop at this end of an axis of this length may sit: in its half, or somewhat outside.
    #[must_use]
    pub fn positions(self, length: Mm) -> Range<Mm> {
        let half = length / 2;
        match self {
            Self::Min => Range { least: -ranges::ENDSTOP_OUTSIDE, most: half },
            Self::Max => Range { least: half, most: length.saturating_add(ranges::ENDSTOP_OUTSIDE) },
        }
    }

    /// The end that is opposite.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Min => Self::Max,
            Self::Max => Self::Min,
        }
    }
}

/// Where the switch of an axis sits. It stays pressed beyond that place; the rig of simulator and QEMU presses it in
/// the same way.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Endstop {
    /// The end of the axis.
    pub end: AxisEnd,
    /// The position at which the switch is met. It may lie somewhat outside the reachable space.
    pub position: Mm,
}

impl Endstop {
    /// A switch where positions begin.
    #[must_use]
    pub const fn at_zero() -> Self {
        Self { end: AxisEnd::Min, position: Mm::ZERO }
    }

    /// A distance towards the switch, with its sign.
    #[must_use]
    pub fn towards(self, distance: Mm) -> Mm {
        match self.end {
            AxisEnd::Min => -distance,
            AxisEnd::Max => distance,
        }
    }

    /// The largest distance of the axis behind the switch, where it stays pressed: from the switch to the end of an
    /// axis of this length.
    #[must_use]
    pub fn depth(self, length: Mm) -> Mm {
        let depth = match self.end {
            AxisEnd::Min => self.position,
            AxisEnd::Max => length - self.position,
        };
        depth.max(Mm::ZERO)
    }

    /// The distance of the switch from the other end of an axis of this length.
    #[must_use]
    pub fn longest_way(self, length: Mm) -> Mm {
        match self.end {
            AxisEnd::Min => length - self.position,
            AxisEnd::Max => self.position,
        }
    }
}

/// An axis that has an endstop.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum HomedAxis {
    /// Left to right.
    X,
    /// Front to back.
    Y,
    /// Bed to nozzle.
    Z,
}

impl HomedAxis {
    /// All of them, in their order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// Its letter.
    #[must_use]
    pub const fn letter(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
        }
    }
}

impl Choice for AxisEnd {
    const ALL: &'static [(Self, &'static str)] = &[(Self::Min, "min"), (Self::Max, "max")];
}

impl Choice for HomedAxis {
    const ALL: &'static [(Self, &'static str)] = &[(Self::X, "x"), (Self::Y, "y"), (Self::Z, "z")];
}

fn parts(s: &mut Settings) -> [&mut Endstop; 3] {
    [&mut s.endstops.x, &mut s.endstops.y, &mut s.endstops.z]
}

rows! {
    for endstop in parts, named &["homing.x", "homing.y", "homing.z"];

    /// The end of the axis at which its switch sits.
    46 "end" = Chosen(&mut endstop.end), "", [Spec::choice::<AxisEnd>()];
    /// The position at which the switch is met: in that half of the axis, or somewhat outside.
    47 "position" = endstop.position, "mm", [ranges::ENDSTOP_POSITION.spec()];
}

/// Rows of the order in which axes are homed.
pub(super) mod order {
    use super::*;

    fn parts(s: &mut Settings) -> [&mut HomedAxis; 3] {
        s.homing_order.each_mut()
    }

    rows! {
        for axis in parts, named &["homing.order"; 3];

        /// The order in which G28 homes the axes: x, y and z once each.
        48 "" = Chosen(axis), "", [Spec::choice::<HomedAxis>()];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_go_by_their_names() {
        assert_eq!([AxisEnd::Min, AxisEnd::Max].map(AxisEnd::name), ["min", "max"]);
    }

    #[test]
    fn the_switch_lies_down_or_up() {
        let low = Endstop { end: AxisEnd::Min, position: Mm::from_num(-5) };
        let high = Endstop { end: AxisEnd::Max, position: Mm::from_num(305) };
        let (ten, length) = (Mm::from_num(10), Mm::from_num(300));
        assert_eq!((low.towards(ten), high.towards(ten)), (-ten, ten));
        assert_eq!([low, high].map(|switch| switch.depth(length)), [Mm::ZERO; 2]);
        let (inside, far) = (Endstop { position: ten, ..low }, Endstop { position: Mm::from_num(280), ..high });
        assert_eq!((inside.depth(length), far.depth(length)), (ten, Mm::from_num(20)));
        assert_eq!((low.longest_way(length), high.longest_way(length)), (Mm::from_num(305), Mm::from_num(305)));
    }
}
