//! Soft endstops: targets outside the reachable space are moved to its edge.

use super::modal::are_apart;
use super::position::Homed;
use crate::settings::{HomedAxis, Range, Settings};
use crate::units::Mm;

/// `position` inside the reachable space, and whether it had to be moved by more than rounding. An axis that was not
/// homed has no known edges; those of `z` depend on its offset. One that comes `from` outside, where its switch may be,
/// may stay there or come in.
pub(in crate::machine) fn clamp(
    position: [Mm; 4],
    from: [Mm; 4],
    homed: Homed,
    s: &Settings,
    z: Range<Mm>,
) -> ([Mm; 4], bool) {
    if !s.soft_endstops {
        return (position, false);
    }
    let ([x, y, at_z, e], [from_x, from_y, from_z, _], [is_x, is_y, is_z]) = (position, from, homed.axes());
    let inside_x = within(x, from_x, is_x, s.reach(HomedAxis::X));
    let inside_y = within(y, from_y, is_y, s.reach(HomedAxis::Y));
    let inside_z = within(at_z, from_z, is_z, z);
    let moved = are_apart(inside_x, x) || are_apart(inside_y, y) || are_apart(inside_z, at_z);
    ([inside_x, inside_y, inside_z, e], moved)
}

/// A coordinate within the reach of its axis, if that is homed.
fn within(at: Mm, from: Mm, is_homed: bool, reach: Range<Mm>) -> Mm {
    if is_homed { at.clamp(from.min(reach.least), from.max(reach.most)) } else { at }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_holds_where_the_position_is_known() {
        let s = Settings::prototype();
        let out = [Mm::from_num(-5), Mm::from_num(500), Mm::from_num(-1), Mm::from_num(-9)];
        let (at, moved) = clamp(out, [Mm::ZERO; 4], Homed::new([true, true, false]), &s, s.reach(HomedAxis::Z));
        assert!(moved);
        assert_eq!(at, [Mm::ZERO, Mm::from_num(417.6), Mm::from_num(-1), Mm::from_num(-9)]);
        // Relative moves lead to the edge within their rounding.
        let edge = [s.axes.x.length + Mm::from_bits(9), Mm::ZERO, Mm::ZERO, Mm::ZERO];
        let at_edge = clamp(edge, [Mm::ZERO; 4], Homed::new([true; 3]), &s, s.reach(HomedAxis::Z));
        assert_eq!(at_edge, ([s.axes.x.length, Mm::ZERO, Mm::ZERO, Mm::ZERO], false));
        let off = Settings { soft_endstops: false, ..s };
        assert_eq!(clamp(out, [Mm::ZERO; 4], Homed::new([true; 3]), &off, s.reach(HomedAxis::Z)), (out, false));
        // From where the switch is: it may stay or come in, and goes no farther.
        let there = [Mm::from_num(-3), Mm::from_num(10), Mm::ZERO, Mm::ZERO];
        let x = |x: i32| [Mm::from_num(x), there[1], there[2], there[3]];
        let ends = [-3, -1, -9].map(|to| clamp(x(to), there, Homed::new([true; 3]), &s, s.reach(HomedAxis::Z)));
        assert_eq!(ends, [(x(-3), false), (x(-1), false), (x(-3), true)]);
    }

    #[test]
    fn an_axis_on_both_sides_of_0_has_its_own_edges() {
        let mut s = Settings::prototype();
        (s.axis_min.x, s.axes.x.length) = (Mm::from_num(-60), Mm::from_num(290));
        let x = |x: f64| [Mm::from_num(x), Mm::ZERO, Mm::ZERO, Mm::ZERO];
        let ends = [-60.0, -60.5, 230.0, 230.5]
            .map(|to| clamp(x(to), x(0.0), Homed::new([true; 3]), &s, s.reach(HomedAxis::Z)));
        assert_eq!(ends, [(x(-60.0), false), (x(-60.0), true), (x(230.0), false), (x(230.0), true)]);
    }
}
