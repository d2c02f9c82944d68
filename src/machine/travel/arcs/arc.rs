//! Arcs: G2 and G3 become chords that stay within a tolerance.
//!
//! Every chord's end is computed from the arc itself, not from the chord before, so nothing adds up. If the slicer's
//! rounding gives different radii at the start and the end, the radius changes evenly along the arc. The end is met
//! exactly.
//!
//! No two places are compared to the bit: coordinates are rounded to their decimals where they come from, and steps of
//! relative moves add up. Places nearer than the last decimal (`Modal::rounding`) are one. So an arc between them is a
//! full turn. An arc with a radius within that rounding of half its chord is a half circle.

use super::angle::{TURN, cos_sin, direction};
use crate::gcode::{ArcShape, Plane};
use crate::text::Packed;
use crate::units::{Mm, mul_div, part_of, whole_root, wide_root};

/// Why there is no such arc.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum ArcError {
    /// Neither I, J, K nor R was given.
    MissingCentre,
    /// The centre is not in the plane.
    OffPlane,
    /// The start is the centre.
    ZeroRadius,
    /// The centre is farther away than any machine reaches, or there are too many turns.
    TooLarge,
    /// With R the end must differ from the start, and be no farther away than twice the radius.
    NoSuchCircle,
}

impl ArcError {
    /// The message to the host.
    pub const fn text(self) -> Packed {
        match self {
            Self::MissingCentre => packed!("echo:arc ignored: give I and J, or R"),
            Self::OffPlane => {
                packed!("echo:arc ignored: its centre is not in its plane (G17: I J, G18: I K, G19: J K)")
            }
            Self::ZeroRadius => packed!("echo:arc ignored: its radius is 0"),
            Self::TooLarge => packed!("echo:arc ignored: too large, or too many turns"),
            Self::NoSuchCircle => packed!("echo:arc ignored: no circle of that R passes through both ends"),
        }
    }
}

/// Chords of one arc at most: finer than any machine sees, and a bound on the work of one line.
const MOST_CHORDS: u64 = 100_000;

/// The centre of an arc lies within 100 m: ten times as far as any target, and no square overflows.
const FARTHEST_CENTRE: Mm = Mm::const_from_int(100_000);

/// A chord spans an eighth of a turn at most, even on a small circle. An octagon leaves its circle by 8 % of the
/// radius; a tolerance that allowed fewer chords would be larger than that.
const LEAST_CHORDS_A_TURN: i64 = 8;

/// A position as its part in a plane, and the two coordinates outside: the axis across it, and the extruder. The first
/// axis of a plane turns counter-clockwise into the second, seen from where the third points to (RS-274/NGC, section
/// 3.5.3).
pub(in crate::machine) fn split<T>(plane: Plane, position: [T; 4]) -> ([T; 2], [T; 2]) {
    let [x, y, z, e] = position;
    match plane {
        Plane::Xy => ([x, y], [z, e]),
        Plane::Zx => ([z, x], [y, e]),
        Plane::Yz => ([y, z], [x, e]),
    }
}

/// The position with these parts.
pub(in crate::machine) fn join<T>(plane: Plane, [first, second]: [T; 2], [across, e]: [T; 2]) -> [T; 4] {
    match plane {
        Plane::Xy => [first, second, across, e],
        Plane::Zx => [second, across, first, e],
        Plane::Yz => [across, first, second, e],
    }
}

/// An arc in its plane, seen from its centre.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Arc {
    centre: [i64; 2],
    radius: [u64; 2],
    /// Direction of the start.
    from: i64,
    /// Angle swept, negative if clockwise.
    sweep: i64,
    end: [Mm; 2],
    chords: u32,
}

impl Arc {
    /// The arc from `start` to `end`; `i`, `j` and `r` of the shape in mm. Chords leave it by the `tolerance` at most,
    /// and places nearer than `rounding` are one.
    ///
    /// # Errors
    /// If no such arc exists.
    pub fn new(
        start: [Mm; 2],
        end: [Mm; 2],
        shape: Shape,
        Way { clockwise, turns }: Way,
        tolerance: Mm,
        rounding: Mm,
    ) -> Result<Self, ArcError> {
        let given = match shape {
            Shape::Centre(offset) => offset,
            Shape::Radius(r) => [r, r],
        };
        if given.iter().any(|length| length.saturating_abs() > FARTHEST_CENTRE) {
            return Err(ArcError::TooLarge);
        }
        let [sx, sy] = start.map(Mm::to_bits);
        let [ex, ey] = end.map(Mm::to_bits);
        let centre = match shape {
            Shape::Centre([i, j]) => [sx + i.to_bits(), sy + j.to_bits()],
            Shape::Radius(r) => centre_from_radius([sx, sy], [ex, ey], r.to_bits(), clockwise, rounding)?,
        };
        let [cx, cy] = centre;
        let radius = [hypotenuse(sx - cx, sy - cy), hypotenuse(ex - cx, ey - cy)];
        if radius[0] == 0 {
            return Err(ArcError::ZeroRadius);
        }
        let from = direction(sx - cx, sy - cy);
        let is_whole = hypotenuse(ex - sx, ey - sy) < rounding.to_bits().unsigned_abs();
        let sweep = if is_whole { 0 } else { direction(ex - cx, ey - cy) - from };
        // Counter-clockwise sweeps are in (0, TURN], clockwise ones in [-TURN, 0).
        let once = if clockwise { -((-sweep - 1).rem_euclid(TURN) + 1) } else { (sweep - 1).rem_euclid(TURN) + 1 };
        let more = TURN * i64::from(turns.max(1) - 1);
        let sweep = if clockwise { once - more } else { once + more };
        let chords = chords(sweep, radius[0].max(radius[1]), tolerance).ok_or(ArcError::TooLarge)?;
        Ok(Self { centre, radius, from, sweep, end, chords })
    }

    /// The angle that is swept, negative if clockwise.
    #[cfg(test)]
    pub const fn sweep(&self) -> i64 {
        self.sweep
    }

    /// The number of its chords.
    pub const fn chords(&self) -> u32 {
        self.chords
    }

    /// Where chord `index` (from 1) ends.
    pub fn point(&self, index: u32) -> [Mm; 2] {
        if index >= self.chords {
            return self.end;
        }
        let part = |value: i64| part_of(value, u64::from(index), u64::from(self.chords));
        let (cos, sin) = cos_sin(self.from + part(self.sweep));
        let [first, last] = self.radius.map(|radius| radius as i64);
        let radius = i128::from(first + part(last - first));
        let along = |component: i64| ((radius * i128::from(component)) >> 60) as i64;
        let [x, y] = self.centre;
        [Mm::from_bits(x + along(cos)), Mm::from_bits(y + along(sin))]
    }
}

/// The direction of an arc, and its number of turns.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Way {
    pub clockwise: bool,
    pub turns: u16,
}

/// An [`ArcShape`] that was given, in mm.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) enum Shape {
    Centre([Mm; 2]),
    Radius(Mm),
}

impl Shape {
    /// The shape in mm, as `length` reads numbers.
    pub fn new(shape: ArcShape, plane: Plane, length: impl Fn(crate::gcode::Number) -> Mm) -> Result<Self, ArcError> {
        match shape {
            ArcShape::Centre { i, j, k } => {
                let (centre, [across, _]) = split(plane, [length(i), length(j), length(k), Mm::ZERO]);
                if across == Mm::ZERO { Ok(Self::Centre(centre)) } else { Err(ArcError::OffPlane) }
            }
            ArcShape::Radius(r) => Ok(Self::Radius(length(r))),
            ArcShape::Missing => Err(ArcError::MissingCentre),
        }
    }
}

/// A chord that spans the angle t leaves the circle by `r (1 - cos(t/2))`, about `r t^2 / 8`. The number of chords is
/// the sweep over `sqrt(8 tolerance / r)`.
fn chords(sweep: i64, radius: u64, tolerance: Mm) -> Option<u32> {
    // Radians times 2^16: 2 pi is 411775 / 65536.
    let sweep = sweep.unsigned_abs();
    let radians = mul_div(sweep, 411_775, TURN as u64);
    let ratio = mul_div(radians.checked_mul(radians)?, radius, 8 * tolerance.to_bits().unsigned_abs());
    let by_tolerance = (whole_root(ratio) >> 16) + 1;
    let by_angle = sweep * LEAST_CHORDS_A_TURN as u64 / TURN as u64 + 1;
    let chords = by_tolerance.max(by_angle);
    (chords <= MOST_CHORDS).then_some(chords as u32)
}

/// The centre on the side that R's sign asks for: a positive R sweeps at most half a turn.
///
/// Rounding moves each end by up to sqrt(2)/2 of the last decimal, half the chord by as much, and R by half of the
/// decimal: together 1.21 of it. Within that, all arcs with such ends are alike, from a little less to a little more
/// than a half circle; it is the one between.
fn centre_from_radius(
    start: [i64; 2],
    end: [i64; 2],
    radius: i64,
    clockwise: bool,
    rounding: Mm,
) -> Result<[i64; 2], ArcError> {
    let (dx, dy) = (end[0] - start[0], end[1] - start[1]);
    let chord = hypotenuse(dx, dy);
    let (half, most) = (chord / 2, radius.unsigned_abs());
    let rounding = rounding.to_bits().unsigned_abs();
    let slack = rounding + rounding / 4;
    if chord < rounding || half > most + slack {
        return Err(ArcError::NoSuchCircle);
    }
    let square = |length: u64| u128::from(length) * u128::from(length);
    let is_half_circle = most <= half + slack;
    let height = if is_half_circle { 0 } else { wide_root(square(most).saturating_sub(square(half))).cast_signed() };
    // To the left of the line from start to end, unless exactly one of these holds.
    let height = if clockwise == (radius > 0) { -height } else { height };
    let share = |leg: i64| leg.signum() * part_of(height, leg.unsigned_abs(), chord);
    Ok([(start[0] + end[0]) / 2 - share(dy), (start[1] + end[1]) / 2 + share(dx)])
}

#[inline(never)]
fn hypotenuse(x: i64, y: i64) -> u64 {
    let square = |v: i64| u128::from(v.unsigned_abs()) * u128::from(v.unsigned_abs());
    wide_root(square(x) + square(y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mm(x: f64, y: f64) -> [Mm; 2] {
        [Mm::from_num(x), Mm::from_num(y)]
    }

    const ONCE: Way = Way { clockwise: true, turns: 1 };

    /// Three decimals.
    const ROUNDING: Mm = Mm::lit("0.001");

    fn arc(start: [Mm; 2], end: [Mm; 2], shape: Shape, clockwise: bool) -> Arc {
        Arc::new(start, end, shape, Way { clockwise, ..ONCE }, Mm::from_num(0.005), ROUNDING).unwrap()
    }

    /// Greatest distance between the circle and the chords, and the turning sense of the chords.
    fn leaves(a: &Arc, start: [Mm; 2], centre: [f64; 2], radius: f64) -> (f64, f64) {
        let mut at = start.map(|v| v.to_num::<f64>());
        let (mut worst, mut area) = (0f64, 0f64);
        for i in 1..=a.chords() {
            let to = a.point(i).map(|v| v.to_num::<f64>());
            let middle = [(at[0] + to[0]) / 2.0 - centre[0], (at[1] + to[1]) / 2.0 - centre[1]];
            worst = worst.max((middle[0].hypot(middle[1]) - radius).abs());
            area += (at[0] - centre[0]) * (to[1] - centre[1]) - (to[0] - centre[0]) * (at[1] - centre[1]);
            at = to;
        }
        (worst, area / 2.0)
    }

    #[test]
    fn a_quarter_stays_within_the_tolerance() {
        let a = arc(mm(10.0, 0.0), mm(0.0, 10.0), Shape::Centre(mm(-10.0, 0.0)), false);
        let (worst, area) = leaves(&a, mm(10.0, 0.0), [0.0, 0.0], 10.0);
        assert!(worst < 0.0051, "{worst}");
        assert!((area - 78.54).abs() < 0.1, "{area}");
        assert_eq!(a.point(a.chords()), mm(0.0, 10.0));
    }

    #[test]
    fn the_same_ends_clockwise_take_the_other_three_quarters() {
        let a = arc(mm(10.0, 0.0), mm(0.0, 10.0), Shape::Centre(mm(-10.0, 0.0)), true);
        let (worst, area) = leaves(&a, mm(10.0, 0.0), [0.0, 0.0], 10.0);
        assert!(worst < 0.0051, "{worst}");
        assert!((area + 235.62).abs() < 0.3, "{area}");
    }

    #[test]
    fn no_way_at_all_is_a_full_circle() {
        for clockwise in [false, true] {
            let a = arc(mm(5.0, 5.0), mm(5.0, 5.0), Shape::Centre(mm(3.0, 0.0)), clockwise);
            let (_, area) = leaves(&a, mm(5.0, 5.0), [8.0, 5.0], 3.0);
            assert!((area.abs() - 28.27).abs() < 0.1 && (area < 0.0) == clockwise, "{area}");
        }
    }

    #[test]
    fn a_radius_chooses_the_short_way_and_a_negative_one_the_long() {
        let short = arc(mm(10.0, 0.0), mm(0.0, 10.0), Shape::Radius(Mm::from_num(10)), false);
        assert!((leaves(&short, mm(10.0, 0.0), [0.0, 0.0], 10.0).1 - 78.54).abs() < 0.1);
        let long = arc(mm(10.0, 0.0), mm(0.0, 10.0), Shape::Radius(Mm::from_num(-10)), false);
        let (worst, area) = leaves(&long, mm(10.0, 0.0), [10.0, 10.0], 10.0);
        assert!(worst < 0.0051 && (area - 235.62).abs() < 0.3, "{worst} {area}");
    }

    #[test]
    fn what_is_no_arc_is_refused() {
        let new = |end, shape| Arc::new(mm(0.0, 0.0), end, shape, ONCE, Mm::from_num(0.005), ROUNDING);
        assert_eq!(new(mm(5.0, 0.0), Shape::Centre(mm(0.0, 0.0))).err(), Some(ArcError::ZeroRadius));
        assert_eq!(new(mm(0.0, 0.0), Shape::Radius(Mm::from_num(5))).err(), Some(ArcError::NoSuchCircle));
        assert_eq!(new(mm(1.0, 0.0), Shape::Centre(mm(1e9, 0.0))).err(), Some(ArcError::TooLarge));
        assert_eq!(new(mm(1.0, 0.0), Shape::Radius(Mm::from_num(-1e9))).err(), Some(ArcError::TooLarge));
        let often = Way { clockwise: false, turns: 60_000 };
        let turns = Arc::new(mm(1.0, 0.0), mm(1.0, 0.0), Shape::Centre(mm(-1.0, 0.0)), often, Mm::ONE, ROUNDING);
        assert_eq!(turns.err(), Some(ArcError::TooLarge));
        assert_eq!(new(mm(50.0, 0.0), Shape::Radius(Mm::from_num(5))).err(), Some(ArcError::NoSuchCircle));
    }

    #[test]
    fn a_position_is_split_and_joined() {
        for plane in [Plane::Xy, Plane::Zx, Plane::Yz] {
            let (inside, across) = split(plane, ['x', 'y', 'z', 'e']);
            assert_eq!(join(plane, inside, across), ['x', 'y', 'z', 'e']);
        }
        let centre = |plane| {
            let [i, j, k] = [1, 2, 0].map(crate::gcode::Number::from);
            Shape::new(ArcShape::Centre { i, j, k }, plane, |n| Mm::from_num(n.value()))
        };
        assert!(matches!(centre(Plane::Xy), Ok(Shape::Centre(offset)) if offset == mm(1.0, 2.0)));
        assert!(matches!(centre(Plane::Zx), Err(ArcError::OffPlane)));
    }

    /// RS-274/NGC, section 3.5.3: clockwise as seen from the positive end of the axis across the plane.
    #[test]
    fn arcs_of_every_plane_against_circles_in_floating_point() {
        for (plane, across) in [(Plane::Xy, 2), (Plane::Zx, 1), (Plane::Yz, 0)] {
            for (clockwise, sense) in [(true, -1.0), (false, 1.0)] {
                let start = [3.0, -7.0, 12.0, 0.0].map(Mm::from_num);
                let offset = [6.0, 2.0, -5.0].map(|v| if v == [6.0, 2.0, -5.0][across] { 0.0 } else { v });
                let centre = [0, 1, 2].map(|axis| start[axis].to_num::<f64>() + offset[axis]);
                let radius = offset.iter().map(|v| v * v).sum::<f64>().sqrt();
                // A third of a turn on, by rotation about the axis across.
                let angle = sense * core::f64::consts::TAU / 3.0;
                let (a, b) = ((across + 1) % 3, (across + 2) % 3);
                let mut end = start;
                end[a] = Mm::from_num(centre[a] - offset[a] * angle.cos() + offset[b] * angle.sin());
                end[b] = Mm::from_num(centre[b] - offset[a] * angle.sin() - offset[b] * angle.cos());
                let given = ArcShape::Centre {
                    i: crate::gcode::Number::saturating(fixed::types::I32F32::from_num(offset[0])),
                    j: crate::gcode::Number::saturating(fixed::types::I32F32::from_num(offset[1])),
                    k: crate::gcode::Number::saturating(fixed::types::I32F32::from_num(offset[2])),
                };
                let shape = Shape::new(given, plane, |n| Mm::from_num(n.value())).unwrap();
                let (from, outside) = split(plane, start);
                let way = Way { clockwise, turns: 1 };
                let arc = Arc::new(from, split(plane, end).0, shape, way, Mm::from_num(0.005), ROUNDING).unwrap();
                assert!((arc.sweep as f64 / TURN as f64 - sense / 3.0).abs() < 1e-6, "{plane:?} {clockwise}");
                let mut at = start.map(|v| v.to_num::<f64>());
                for chord in 1..=arc.chords() {
                    let to = join(plane, arc.point(chord), outside).map(|v| v.to_num::<f64>());
                    let spoke = |p: [f64; 4]| [p[a] - centre[a], p[b] - centre[b]];
                    let ([ua, ub], [va, vb]) = (spoke(at), spoke(to));
                    assert!((va.hypot(vb) - radius).abs() < 1e-5, "{plane:?}: {to:?}");
                    assert!((ua * vb - ub * va) * sense > 0.0 && to[across] == at[across], "{plane:?} {clockwise}");
                    at = to;
                }
            }
        }
    }

    #[test]
    fn turns_are_counted_in_all() {
        let thrice = Way { clockwise: false, turns: 3 };
        let shape = Shape::Centre(mm(-1.0, 0.0));
        let a = Arc::new(mm(1.0, 0.0), mm(1.0, 0.0), shape, thrice, Mm::from_num(0.005), ROUNDING);
        assert_eq!(a.unwrap().sweep, 3 * TURN);
    }

    #[test]
    fn half_a_chord_is_the_radius_within_the_rounding() {
        let ends = (mm(100.0, 100.0), mm(114.143, 100.0));
        for (radius, is_half) in [(7.071, true), (7.0715, true), (7.0727, true), (7.0703, true), (7.09, false)] {
            for clockwise in [false, true] {
                let a = arc(ends.0, ends.1, Shape::Radius(Mm::from_num(radius)), clockwise);
                let off = (a.sweep.abs() - TURN / 2).abs() as f64 / TURN as f64;
                assert_eq!(off < 1e-9, is_half, "{radius}: {off}");
            }
        }
        let too_small = Shape::Radius(Mm::from_num(7.07));
        let refused = Arc::new(ends.0, ends.1, too_small, ONCE, Mm::from_num(0.005), ROUNDING);
        assert_eq!(refused.err(), Some(ArcError::NoSuchCircle));
        // Coordinates with two decimals.
        let a = Arc::new(ends.0, ends.1, Shape::Radius(Mm::from_num(7.06)), ONCE, Mm::from_num(0.005), Mm::lit("0.01"));
        assert_eq!(a.unwrap().sweep.abs() / (TURN / 1000), 500);
    }

    #[test]
    fn ends_nearer_than_the_rounding_are_a_full_turn() {
        for (off, is_whole) in [(1e-9, true), (0.0009, true), (0.002, false)] {
            for clockwise in [false, true] {
                let ahead = if clockwise { -off } else { off };
                let a = arc(mm(100.0, 100.0), mm(100.0 + ahead, 100.0), Shape::Centre(mm(0.0, 5.0)), clockwise);
                assert_eq!(a.sweep.abs() > TURN / 2, is_whole, "{off} {clockwise}");
            }
        }
        let none = Arc::new(
            mm(100.0, 100.0),
            mm(100.0005, 100.0),
            Shape::Radius(Mm::from_num(-5)),
            ONCE,
            Mm::from_num(0.005),
            ROUNDING,
        );
        assert_eq!(none.err(), Some(ArcError::NoSuchCircle));
    }
}
