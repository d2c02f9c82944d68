//! Junction speeds: how fast a corner may be taken.
//!
//! Junction deviation (S. Jeon, "Improving Grbl: Cornering Algorithm", 2011): the tool is thought to follow
//! an arc that touches both moves and leaves the corner by the deviation d; with the angle t between the
//! moves that arc has the radius `d sin(t/2) / (1 - sin(t/2))`, and `v^2 = a r`. A square-corner velocity w
//! is the same law with the deviation for which 90 degrees give w: `d = w^2 (sqrt 2 - 1) / a`, so that
//! `v^2 = w^2 (sqrt 2 - 1) sin(t/2) / (1 - sin(t/2))` does not depend on the acceleration.
//!
//! A curve that is cut into chords of length L is a row of such corners, each of them harmless and all of them
//! together a turn of radius `L/2 tan(t/2)`: its speed is limited by `v^2 = a L/2 tan(t/2)` too.
//!
//! The acceleration on that arc points along the change of direction, so it is limited by what the axes
//! bear in that direction: a corner between the bed plane and Z is as slow as Z is.

use super::geometry::{Geometry, RATIO, UNIT};
use crate::settings::{CornerRule, Settings};
use crate::units::{MmPerSec2, mul_div};

/// sqrt(2) - 1, scaled by [`UNIT`].
const SQRT_2_MINUS_1: u64 = 444_758_426;

/// The greatest speed squared, in raw bits of 2^-32 mm2/s2, at which `before` may turn into `after`.
pub(super) fn corner_speed_sq(before: &Geometry, after: &Geometry, a: MmPerSec2, s: &Settings) -> u64 {
    if before.is_extruder_only() || after.is_extruder_only() {
        // The tool stands still in one of the two.
        return if before.is_extruder_only() && after.is_extruder_only() { extruder_only(before, after) } else { 0 };
    }
    let dot = before.unit.iter().zip(after.unit).map(|(p, q)| i64::from(*p) * i64::from(q)).sum::<i64>() >> 30;
    let one = i64::from(UNIT);
    // The angle between the moves is pi minus the change of direction, hence the sign.
    let cosine = (-dot).clamp(-one, one);
    let sine_half = (((one - cosine) as u64 / 2) << 30).isqrt().min(UNIT as u64);
    let cosine_half = (((one + cosine) as u64 / 2) << 30).isqrt();
    let flatness = UNIT as u64 - sine_half;
    let bears = turn(before, after).fine_acceleration_limit(a, s);
    let base = match s.corner {
        CornerRule::JunctionDeviation(d) => mul_div(bears, d.to_bits().unsigned_abs(), 1 << 24),
        CornerRule::SquareCorner(w) => {
            let w = u64::from(w.to_bits());
            mul_div(w * w, SQRT_2_MINUS_1, UNIT as u64)
        }
    };
    let bend = mul_div(base, sine_half, flatness);
    let shorter = before.length.min(after.length);
    let curve = mul_div(mul_div(shorter, bears, 1 << 25), sine_half, cosine_half);
    bend.min(curve).min(extruder_jump(before, after, s))
}

/// The change of direction.
fn turn(before: &Geometry, after: &Geometry) -> Geometry {
    let [px, py, pz] = before.unit;
    let [qx, qy, qz] = after.unit;
    let change = |p: i32, q: i32| i64::from(q) - i64::from(p);
    Geometry::new([change(px, qx), change(py, qy), change(pz, qz), 0])
}

/// Two retractions in a row are one if they go the same way.
fn extruder_only(before: &Geometry, after: &Geometry) -> u64 {
    if before.extrusion.signum() == after.extrusion.signum() { u64::MAX } else { 0 }
}

/// The speed squared at which the extruder's own speed would jump by its jerk limit.
fn extruder_jump(before: &Geometry, after: &Geometry, s: &Settings) -> u64 {
    let jump = before.extrusion.abs_diff(after.extrusion);
    if jump == 0 {
        return u64::MAX;
    }
    let v = mul_div(u64::from(s.extruder_jerk.to_bits()), RATIO, jump);
    v.saturating_mul(v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Mm, MmPerSec};

    fn heading(degrees: f64) -> Geometry {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Geometry::new([Mm::from_num(10.0 * cos).to_bits(), Mm::from_num(10.0 * sin).to_bits(), 0, 0])
    }

    fn speed(turn: f64, s: &Settings) -> f64 {
        let a = MmPerSec2::from_num(3000);
        (corner_speed_sq(&heading(20.0), &heading(20.0 + turn), a, s) as f64 / 2f64.powi(32)).sqrt()
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
        let sq = corner_speed_sq(&heading(0.0), &up, MmPerSec2::from_num(3000), &s) as f64 / 2f64.powi(32);
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
        let sq = corner_speed_sq(&chord(0.3), &chord(0.4), MmPerSec2::from_num(3000), &s) as f64 / 2f64.powi(32);
        assert!((sq / 3000.0 - 1.0).abs() < 2e-3, "{sq}");
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
        printing.extrusion = RATIO as i64 / 20;
        let sq = corner_speed_sq(&printing, &heading(0.0), MmPerSec2::from_num(3000), &s);
        let v = (sq as f64 / 2f64.powi(32)).sqrt();
        assert!((v - 100.0).abs() < 0.01, "5 mm/s of filament at 0.05 mm a mm: {v}");
    }
}
