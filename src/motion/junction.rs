//! Junction speeds: how fast a corner may be taken.
//!
//! Junction deviation (S. Jeon, "Improving Grbl: Cornering Algorithm", 2011): the tool is thought to follow
//! an arc that touches both moves and leaves the corner by the deviation d; with the angle t between the
//! moves that arc has the radius `d sin(t/2) / (1 - sin(t/2))`, and `v^2 = a r`. A square-corner velocity w
//! is the same law with the deviation for which 90 degrees give w: `d = w^2 (sqrt 2 - 1) / a`, so that
//! `v^2 = w^2 (sqrt 2 - 1) sin(t/2) / (1 - sin(t/2))` does not depend on the acceleration.
//!
//! A curve that is cut into chords of length L is a row of such corners, each of them harmless and all of them
//! together a turn of radius `L/2 tan(t/2)`: its speed is limited by `v^2 = a L/2 tan(t/2)` too. Where the angles are
//! those of rounded coordinates, this would be slow at every greater one of them. So a corner that is no sharper than
//! rounding makes it need not be slower than the radius allows that the path has on average (see
//! [`trend`](super::trend)).
//!
//! The acceleration on that arc points along the change of direction, so it is limited by what the axes
//! bear in that direction: a corner between the bed plane and Z is as slow as Z is.

use super::geometry::{Belts, Geometry, Limits, Shares, UNIT, speed};
use super::number::{from_bits, root, to_bits};
use super::trend::Trend;
use crate::settings::{CornerRule, Settings};
use core::f32::consts::SQRT_2;

/// Half an angle with less than this is that of a way back: directions have 30 bits.
const LEAST_SINE: f32 = 1e-7;

/// The square of a turn that is none: by less than a millionth the coordinates' own digits turn moves of a metre. At 1 m/s the
/// tool's speed jumps by a thousandth of a mm/s.
const LEAST_TURN_SQ: f32 = 1e-12;

/// A corner from which the tool keeps within so many mm may be due to rounded coordinates: thousandths of a millimetre put a
/// corner up to 0.0014 mm off the line between its neighbours. At 3 m/s2 the direction may jump by 6 mm/s then: by 0.03 at
/// 200 mm/s, the greatest angle that they make of chords of 0.1 mm.
const ROUNDING: f32 = 0.0016;

/// What a corner depends on beside its two moves.
pub(super) struct Bearing<'a> {
    /// Acceleration of the second move, in mm/s2.
    pub acceleration: f32,
    /// What axes and motors bear of it.
    pub limits: &'a Limits,
    /// The belt motors.
    pub belts: &'a Belts,
}

impl Bearing<'_> {
    /// What axes and motors bear along a change of direction of that length.
    fn along(&self, [x, y, z]: [f32; 3], length: f32) -> f32 {
        let part = 1.0 / length;
        Shares::new([x * part, y * part, z * part], 0.0, self.belts).bound(self.acceleration, self.limits)
    }
}

/// The greatest speed squared, in raw bits of 2^-32 mm2/s2, at which `before` may turn into `after`, with which the path has
/// got the trend `trend`.
#[inline(always)]
pub(super) fn corner_speed_sq(
    before: &Geometry,
    after: &Geometry,
    trend: &Trend,
    bearing: &Bearing<'_>,
    s: &Settings,
) -> u64 {
    if before.is_extruder_only() || after.is_extruder_only() {
        // The tool stands still in one of the two.
        return if before.is_extruder_only() && after.is_extruder_only() { extruder_only(before, after) } else { 0 };
    }
    let turn = difference(before, after);
    let turn_sq = square(turn);
    let mut most = if turn_sq < LEAST_TURN_SQ { f32::INFINITY } else { bend(before, after, turn, trend, bearing, s) };
    let jump = (before.extrusion - after.extrusion).abs();
    if jump > 0.0 {
        let jerk = speed(s.extruder_jerk) / jump;
        most = least(most, jerk * jerk);
    }
    to_bits(most)
}

/// The greatest speed squared, in mm2/s2, at which the direction of the tool may change by `turn`.
fn bend(
    before: &Geometry,
    after: &Geometry,
    turn: [f32; 3],
    trend: &Trend,
    bearing: &Bearing<'_>,
    s: &Settings,
) -> f32 {
    // The angle between the moves is pi minus the change of direction: its half has the cosine and the sine of half
    // the difference and half the sum of the two directions.
    let turn_length = root(square(turn));
    let cosine = 0.5 * turn_length;
    let sine = 0.5 * root(square(sum(before, after)));
    if sine < LEAST_SINE {
        return 0.0;
    }
    let bears = bearing.along(turn, turn_length);
    let base = match s.corner {
        CornerRule::JunctionDeviation(d) => bears * from_bits(d.to_bits().unsigned_abs()),
        CornerRule::SquareCorner(w) => speed(w) * speed(w) * (SQRT_2 - 1.0),
    };
    // 1 - sine without its cancellation.
    let sharpness = sine * (1.0 + sine) / (cosine * cosine);
    let bend = base * sharpness;
    let curve = 0.5 * least(before.size, after.size) * bears * sine / cosine;
    if bend < curve {
        return bend;
    }
    let rounding = bears * ROUNDING * sharpness;
    // The average is asked for only where it matters.
    if rounding < curve { curve } else { least(bend, greatest(curve, least(average(trend, bearing), rounding))) }
}

/// What a curve allows that bends as the path does on average.
fn average(trend: &Trend, bearing: &Bearing<'_>) -> f32 {
    let (turn, length, radius) = trend.bend();
    if length > 0.0 { bearing.along(turn, length) * radius } else { f32::INFINITY }
}

/// The lesser of two limits; one over nothing is none.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two limits.
fn greatest(a: f32, b: f32) -> f32 {
    if a < b { b } else { a }
}

/// The change of direction. It has 30 bits, which single precision would not leave of it.
fn difference(before: &Geometry, after: &Geometry) -> [f32; 3] {
    let ([px, py, pz], [qx, qy, qz]) = (before.unit, after.unit);
    let axis = |p: i32, q: i32| q.saturating_sub(p) as f32 * const { 1.0 / UNIT as f32 };
    [axis(px, qx), axis(py, qy), axis(pz, qz)]
}

/// The sum of the two directions.
fn sum(before: &Geometry, after: &Geometry) -> [f32; 3] {
    let ([px, py, pz], [qx, qy, qz]) = (before.unit, after.unit);
    let axis = |p: i32, q: i32| q.saturating_add(p) as f32 * const { 1.0 / UNIT as f32 };
    [axis(px, qx), axis(py, qy), axis(pz, qz)]
}

fn square([x, y, z]: [f32; 3]) -> f32 {
    x * x + y * y + z * z
}

/// Two retractions in a row are one if they go the same way.
fn extruder_only(before: &Geometry, after: &Geometry) -> u64 {
    if (before.extrusion < 0.0) == (after.extrusion < 0.0) { u64::MAX } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::geometry::acceleration;
    use crate::units::{Mm, MmPerSec, MmPerSec2};

    fn belts(s: &Settings) -> Belts {
        Belts::new(&crate::kinematics::Groups::new(&s.mechanism))
    }

    fn at_corner(before: &Geometry, after: &Geometry, trend: &Trend, a: MmPerSec2, s: &Settings) -> u64 {
        let bearing = Bearing { acceleration: acceleration(a), limits: &Limits::of_acceleration(s), belts: &belts(s) };
        corner_speed_sq(before, after, trend, &bearing, s)
    }

    fn heading(degrees: f64) -> Geometry {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Geometry::new([Mm::from_num(10.0 * cos).to_bits(), Mm::from_num(10.0 * sin).to_bits(), 0, 0])
    }

    /// Behind a long way that led to `before`.
    fn corner(before: &Geometry, after: &Geometry, a: MmPerSec2, s: &Settings) -> u64 {
        let mut trend = Trend::default();
        for way in [before, before, after] {
            trend.follow(way);
        }
        at_corner(before, after, &trend, a, s)
    }

    fn speed(turn: f64, s: &Settings) -> f64 {
        let a = MmPerSec2::from_num(3000);
        (corner(&heading(20.0), &heading(20.0 + turn), a, s) as f64 / 2f64.powi(32)).sqrt()
    }

    #[test]
    fn corners_follow_the_junction_deviation_law() {
        let mut s = Settings::prototype();
        s.corner = CornerRule::JunctionDeviation(Mm::from_num(0.013));
        for turn in [5.0, 30.0, 45.0, 90.0, 135.0, 170.0] {
            let half = ((180.0 - turn) / 2.0f64).to_radians().sin();
            let exact = (3000.0 * 0.013 * half / (1.0 - half)).sqrt();
            assert!((speed(turn, &s) / exact - 1.0).abs() < 1e-3, "{turn}: {} {exact}", speed(turn, &s));
        }
    }

    #[test]
    fn a_corner_into_z_is_as_slow_as_z() {
        let s = Settings::prototype();
        let up = Geometry::new([0, 0, Mm::ONE.to_bits(), 0]);
        let sq = corner(&heading(0.0), &up, MmPerSec2::from_num(3000), &s) as f64 / 2f64.powi(32);
        // Z bears 200 mm/s2 and has 0.707 of the change.
        let exact = 200.0 * 2f64.sqrt() * 0.013 * 0.5f64.sqrt() / (1.0 - 0.5f64.sqrt());
        assert!((sq / exact - 1.0).abs() < 1e-3, "{sq} {exact}");
    }

    #[test]
    fn a_curve_of_chords_turns_no_faster_than_its_circle_allows() {
        let mut s = Settings::prototype();
        s.corner = CornerRule::JunctionDeviation(Mm::ONE);
        // Chords of 0.1 mm that turn by 0.1 rad each: a circle of 1 mm.
        let chord = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            Geometry::new([Mm::from_num(0.1 * cos).to_bits(), Mm::from_num(0.1 * sin).to_bits(), 0, 0])
        };
        let sq = corner(&chord(0.3), &chord(0.4), MmPerSec2::from_num(3000), &s) as f64 / 2f64.powi(32);
        assert!((sq / 3000.0 - 1.0).abs() < 2e-3, "{sq}");
        // A circle of 10 mm, of which rounding has made one angle twice as great.
        let mut trend = Trend::default();
        for i in 0..40 {
            trend.follow(&chord(0.01 * f64::from(i)));
        }
        let a = MmPerSec2::from_num(3000);
        let sq = at_corner(&chord(0.37), &chord(0.39), &trend, a, &s) as f64 / 2f64.powi(32);
        assert!((sq / 30_000.0 - 1.0).abs() < 1e-2, "{sq}");
        // Three times as great on a circle of 1 mm is none that rounding makes.
        let sq = at_corner(&chord(0.1), &chord(0.4), &trend, a, &s) as f64 / 2f64.powi(32);
        assert!((sq / 1000.0 - 1.0).abs() < 1e-2, "{sq}");
    }

    #[test]
    fn a_square_corner_is_taken_at_the_square_corner_velocity() {
        let mut s = Settings::prototype();
        s.corner = CornerRule::SquareCorner(MmPerSec::from_num(8));
        assert!((speed(90.0, &s) - 8.0).abs() < 1e-3);
        assert!(speed(179.99, &s) < 0.2);
        assert!(speed(0.0, &s) > 1000.0);
    }

    #[test]
    fn the_extruder_limits_a_corner_where_its_speed_jumps() {
        let s = Settings::prototype();
        let mut printing = heading(0.0);
        printing.extrusion = 0.05;
        let sq = corner(&printing, &heading(0.0), MmPerSec2::from_num(3000), &s);
        let v = (sq as f64 / 2f64.powi(32)).sqrt();
        assert!((v - 100.0).abs() < 0.01, "5 mm/s of filament at 0.05 mm a mm: {v}");
    }
}
