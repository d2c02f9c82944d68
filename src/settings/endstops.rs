//! Endstops: at which end of its axis each switch sits, where that is, and in which order G28 looks for them.

use super::rows::{Choice, Spec, numbers, rows};
use super::{Range, ranges};
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

    /// Where an endstop at this end of an axis with this reach may sit: in its half, or somewhat outside.
    #[must_use]
    pub fn positions(self, reach: Range<Mm>) -> Range<Mm> {
        let middle = reach.least.saturating_add(reach.most) / 2;
        match self {
            Self::Min => Range { least: reach.least.saturating_sub(ranges::ENDSTOP_OUTSIDE), most: middle },
            Self::Max => Range { least: middle, most: reach.most.saturating_add(ranges::ENDSTOP_OUTSIDE) },
        }
    }

    /// The place of this end of an axis with this reach.
    #[must_use]
    pub const fn of(self, reach: Range<Mm>) -> Mm {
        match self {
            Self::Min => reach.least,
            Self::Max => reach.most,
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
    /// axis with this reach.
    #[must_use]
    pub fn depth(self, reach: Range<Mm>) -> Mm {
        self.towards(self.end.of(reach).saturating_sub(self.position)).max(Mm::ZERO)
    }

    /// The distance of the switch from the other end of an axis with this reach.
    #[must_use]
    pub fn longest_way(self, reach: Range<Mm>) -> Mm {
        self.towards(self.position.saturating_sub(self.end.other().of(reach)))
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

    numbers!(Min Max);
}

impl Choice for HomedAxis {
    const ALL: &'static [(Self, &'static str)] = &[(Self::X, "x"), (Self::Y, "y"), (Self::Z, "z")];

    numbers!(X Y Z);
}

rows! {
    for endstop in |s, part| s.endstops.get_mut(part), named &["homing.x", "homing.y", "homing.z"];

    /// The end of the axis at which its switch sits.
    46 "end" = &mut endstop.end, "", [Spec::choice::<AxisEnd>()];
    /// The position at which the switch is met: in that half of the axis, or somewhat outside.
    47 "position" = &mut endstop.position, "mm", [ranges::ENDSTOP_POSITION.spec()];
}

/// Rows of the order in which axes are homed.
pub(super) mod order {
    use super::*;

    rows! {
        for axis in |s, part| s.homing_order.get_mut(part), named &["homing.order"; 3];

        /// The order in which G28 homes the axes: x, y and z once each.
        48 "" = axis, "", [Spec::choice::<HomedAxis>()];
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
        let (ten, reach) = (Mm::from_num(10), Range { least: Mm::ZERO, most: Mm::from_num(300) });
        assert_eq!((low.towards(ten), high.towards(ten)), (-ten, ten));
        assert_eq!([low, high].map(|switch| switch.depth(reach)), [Mm::ZERO; 2]);
        let (inside, far) = (Endstop { position: ten, ..low }, Endstop { position: Mm::from_num(280), ..high });
        assert_eq!((inside.depth(reach), far.depth(reach)), (ten, Mm::from_num(20)));
        assert_eq!((low.longest_way(reach), high.longest_way(reach)), (Mm::from_num(305), Mm::from_num(305)));
    }

    #[test]
    fn the_switch_lies_in_its_half_of_an_axis_on_both_sides_of_0() {
        let mm = |mm: f64| Mm::from_num(mm);
        let reach = Range { least: mm(-60.0), most: mm(230.0) };
        let range = |end: AxisEnd| [end.positions(reach).least, end.positions(reach).most];
        assert_eq!(range(AxisEnd::Min), [mm(-110.0), mm(85.0)]);
        assert_eq!(range(AxisEnd::Max), [mm(85.0), mm(280.0)]);
        let low = Endstop { end: AxisEnd::Min, position: mm(-59.5) };
        let high = Endstop { end: AxisEnd::Max, position: mm(229.0) };
        assert_eq!((low.depth(reach), high.depth(reach)), (mm(0.5), mm(1.0)));
        assert_eq!((low.longest_way(reach), high.longest_way(reach)), (mm(289.5), mm(289.0)));
    }
}
