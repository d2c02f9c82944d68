//! Junction speeds: how fast a corner may be taken.
//!
//! Junction deviation (S. Jeon, "Improving Grbl: Cornering Algorithm", 2011) replaces the corner by an arc that touches
//! both moves and leaves the corner by the deviation d. With the angle t between the moves that arc has the radius
//! `d sin(t/2) / (1 - sin(t/2))`, and `v^2 = a r`. A square-corner velocity w is the same law with the deviation for
//! which 90 degrees give w at the commanded acceleration c: `d = w^2 (sqrt 2 - 1) / c`. Each of the two moves has its
//! own. A move that an axis slows down has the acceleration a, less than c, and so a slower corner:
//! `v^2 = w^2 a / c` for 90 degrees. The move with the lesser `a d` counts, and the law along the turn, below. Klipper
//! has the same two (klippy/toolhead.py, `calc_junction`), and no law along the turn.
//!
//! A slicer cuts a curve into chords. Each corner between two chords is harmless by itself, and together they are a
//! turn, so three more rules limit the speed on curves:
//!
//! - **Long chords**, of a millimetre or more. A chord of the length L with such a corner at both ends is a part of a
//!   circle of the radius `L/2 tan(t/2)`, so `v^2 = a L/2 tan(t/2)`. One corner is enough to find it.
//! - **Shorter chords in a long curve**: the radius r comes from the path over some distance
//!   ([`path_curvature`](super::path_curvature)), and `v^2 = a r`.
//! - **Shorter chords in a short bend**, over before the curvature is known. At a corner with a small change of
//!   direction p, junction deviation lets the velocity jump by `v p = sqrt(8 a d)`. All corners of a bend together may
//!   change the velocity by no more than that, plus the change that the acceleration allows in the time between them.
//!   The sum of the jumps, less the second part, is the lead of `path_curvature`. Corners that are more than
//!   [`BEND_TIME`] apart are of different bends.
//! - **A bend has one speed.** It is over before the lead is known, too: a first corner that uses up all of the jump
//!   makes all others slow. So between short chords the law of long ones bounds the bend from two sides. A corner is
//!   never slower than by its own shape, `a L/2 tan(t/2)` for the shorter chord. It is no faster than the circle of
//!   both chords, because the next corner may be alike. A corner that stays a single one loses little, because it keeps
//!   [`SINGLE`] of its `v^2`. Between chords below [`SHORTEST`] it keeps none if it [goes on](GOES_ON) with a turn to
//!   the same side. A quarter of 7.5 degrees on a radius of 0.3 mm is more than the circle allows.
//!
//! The acceleration on that arc points along the change of direction, so the axes limit it in that direction. A corner
//! between the bed plane and Z is as slow as Z.
//!
//! Two limits count whatever the rule is: the speeds of the extruder and of z jump by no more than their jerks.
//!
//! The law is written down again on purpose, as checks that do not share a mistake with it: in `tests/motion`
//! (`corners`, `model`, `curves`, `properties`) and in `sim/board/src/limits.rs`. Another rule is a variant of
//! [`CornerRule`]. The compiler asks for it in all these places, and `sim/board/tests/every_setting.rs` for its key in
//! machine files and its letter of M205. The checker of prints has its assumptions in `sim/board/src/check.rs` and
//! `check/changes.rs` (`BEND`, windows as long as [`BEND_TIME`]): another law may need another bound there.
//!
//! A rule is one number, acceleration times deviation, which the laws for bends use too. A law that is no such number,
//! as a jerk of x and y, needs its own `corner` and laws for bends.

use super::bed::Demand;
use super::geometry::{Belts, Geometry, Limits, Shares, UNIT};
use super::path_curvature::{PathCurvature, SHORTEST};
use crate::motion::number::{mm, root, speed, speed_sq};
use crate::settings::{CornerRule, Settings};
use crate::units::{Length, SpeedSq};
use core::f32::consts::SQRT_2;

/// Where the sine of half the angle is less than this, the second move goes straight back: directions have 30 bits.
const LEAST_SINE: f32 = 1e-7;

/// A turn with a smaller square counts as straight. That is a turn of a millionth: the last digits of coordinates turn
/// a move of a metre by as much. At 1 m/s the tool's speed jumps by a thousandth of a mm/s.
const LEAST_TURN_SQ: f32 = 1e-12;

/// Chords of at least this length, in mm, are rated corner by corner. Shorter ones are rated by the
/// [curvature](super::path_curvature) of the path, which forgets a corner over a millimetre.
const LONG_CHORD: f32 = 1.0;

/// The part of the squared speed of junction deviation that a corner between short chords may have whatever follows it.
/// With a fifth, straight lines in rounded chords of 0.02 mm take 4 % longer; with 0.4, small fillets shake the tool
/// more (measured on `tests/motion/joining.rs` and `fillets.rs`).
const SINGLE: f32 = 0.25;

/// A corner whose turn is up to four times the one before it, to the same side, goes on with a bend. With 0.4, the
/// second corner of a bend is faster than its circle if the first one turns half as much (`tests/motion/fillets.rs`).
/// Rounded points on a line turn to both sides by turns.
const GOES_ON: f32 = 0.25;

/// Where the curvature allows less than this times what the two chords allow, it counts alone. With 1.15, rounded
/// corners in twelve chords shake the tool more, and curves with errors take as long (measured likewise).
const NEARLY: f32 = 1.05;

/// The lead is made up for faster than the acceleration says, by this factor. So a circle at the limit is limited by
/// its curvature alone, which rounded coordinates hardly change.
const MAKING_UP: f32 = 1.15;

/// A corner counts for this many seconds after it was passed. That is half a period at 125 Hz, above which printers
/// hardly resonate, and the time over which `corehbot run` looks at changes of velocity.
const BEND_TIME: f32 = 0.004;

/// Coordinates have three decimals, so a point is half a thousandth of a millimetre off. The slopes of two moves then
/// differ by this over the length of each, though none was commanded. That is less than a step of most screws.
const ROUNDING: f32 = 0.001;

/// What the rule for corners gives a move.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(in crate::motion) struct Arc {
    /// How far the arc may leave the corner, in mm.
    deviation: f32,
    /// That times the acceleration of the move, in mm2/s2; none where the rule has one deviation for all moves.
    base: f32,
}

impl Arc {
    /// No limit.
    pub const NONE: Self = Self { deviation: f32::INFINITY, base: f32::INFINITY };

    /// For a move with this acceleration, of the one that is commanded.
    #[inline(always)]
    pub fn new(rule: CornerRule, acceleration: f32, commanded: f32) -> Self {
        match rule {
            CornerRule::JunctionDeviation(d) => Self { deviation: mm(Length::of(d)), ..Self::NONE },
            CornerRule::SquareCorner(w) => {
                let deviation = speed(w) * speed(w) * (SQRT_2 - 1.0) / commanded;
                Self { deviation, base: deviation * acceleration }
            }
        }
    }
}

/// The inputs of a corner other than its two moves.
pub(in crate::motion) struct AccelLimits<'a> {
    /// Acceleration of the second move, in mm/s2.
    pub acceleration: f32,
    /// The greatest speed of the second move that axes and motors bear, in mm/s.
    pub max_speed: f32,
    /// The limits of axes and motors for it.
    pub limits: &'a Limits,
    /// The belt motors.
    pub belts: &'a Belts,
    /// The surface.
    pub demand: &'a Demand,
    /// What the rule gives the two moves.
    pub arcs: [Arc; 2],
}

impl AccelLimits<'_> {
    /// The limits of axes and motors along a change of direction of that length.
    fn along(&self, [x, y, z]: [f32; 3], length: f32) -> f32 {
        let part = 1.0 / length;
        Shares::new([x * part, y * part, z * part], 0.0, self.belts, self.demand).bound(self.acceleration, self.limits)
    }
}

/// The greatest speed squared at which `before` may turn into `after`. The curvature of the path takes up that corner,
/// and `after`. In the corner the extruder's speed jumps by `jump` times the speed of the tool.
#[inline(always)]
pub(in crate::motion) fn junction_speed_sq(
    before: &Geometry,
    after: &Geometry,
    curvature: &mut PathCurvature,
    jump: f32,
    accel_limits: &AccelLimits<'_>,
    s: &Settings,
) -> SpeedSq {
    if before.is_extruder_only() || after.is_extruder_only() {
        // The tool stands still in one of the two moves, so its earlier direction does not matter.
        *curvature = PathCurvature::default();
        return if before.is_extruder_only() && after.is_extruder_only() {
            extruder_only(before, after)
        } else {
            SpeedSq::ZERO
        };
    }
    let most = bend(before, after, curvature, accel_limits);
    let ([_, _, from_up], [_, _, up]) = (before.unit, after.unit);
    let rise = up.saturating_sub(from_up);
    let most = if rise == 0 {
        most
    } else {
        let rounded = ROUNDING / before.size + ROUNDING / after.size;
        capped(most, rise.unsigned_abs() as f32 * const { 1.0 / UNIT as f32 } - rounded, speed(s.z_jerk))
    };
    speed_sq(capped(most, jump, speed(s.extruder_jerk)))
}

/// The speed squared, at most that one, at which a speed that jumps by `jump` times it keeps to the jerk.
#[inline(always)]
fn capped(most: f32, jump: f32, jerk: f32) -> f32 {
    let reached = jerk / jump;
    if jump > 0.0 { least(most, reached * reached) } else { most }
}

/// The greatest speed squared, in mm2/s2, at which the tool may turn from `before` to `after`.
#[inline(always)]
fn bend(before: &Geometry, after: &Geometry, curvature: &mut PathCurvature, accel_limits: &AccelLimits<'_>) -> f32 {
    let turn = difference(before, after);
    let curve = curvature.advance(turn, after.size);
    let most = if curve.curvature > 0.0 {
        accel_limits.along(curve.turn, curve.size) / curve.curvature
    } else {
        f32::INFINITY
    };
    let (lead, past) = (curvature.lead_with(turn), curvature.greatest_lead());
    let (turn_sq, lead_sq) = (square(turn), square(lead));
    // The acceleration belongs to the greater of the two, because the other may be none.
    let (change, change_sq) = if lead_sq > turn_sq { (lead, lead_sq) } else { (turn, turn_sq) };
    let is_straight = change_sq < LEAST_TURN_SQ;
    if is_straight && past <= 0.0 {
        return most;
    }
    let max_accel = if is_straight { accel_limits.acceleration } else { accel_limits.along(change, root(change_sq)) };
    let [first, second] = accel_limits.arcs;
    let base = max_accel * second.deviation;
    let lead_length = root(lead_sq);
    let most = if turn_sq < LEAST_TURN_SQ {
        most
    } else {
        let (leads, base) = (lead_length + past, least(base, first.base));
        // From `v p = sqrt(8 a d)` of the head, with the leads as p.
        let of_bend = 8.0 * base / (leads * leads);
        let goes_on = curve.same_side > GOES_ON * turn_sq;
        least(most, corner([most, of_bend], [before, after], turn_sq, goes_on, max_accel, base))
    };
    // It was no faster at the corner of the greatest lead (the lead with this corner is in `most` already). From rest
    // it accelerates all along.
    let gain = max_accel * after.size;
    let slow = least(least(most, 8.0 * base / (past * past)), accel_limits.max_speed * accel_limits.max_speed);
    let fast = if slow < gain { gain } else { slow };
    // The way within BEND_TIME, if the tool accelerates all along. After a longer move the next corner is of another
    // bend.
    let farthest = BEND_TIME * (root(slow) + 0.5 * BEND_TIME * accel_limits.acceleration);
    // A lead is a change of velocity over the speed, so time t takes away a t / v. With t = L / v that is a L / v^2.
    let made_up = if after.size < farthest { MAKING_UP * gain / fast } else { f32::INFINITY };
    curvature.follow_lead(lead, lead_length, made_up);
    most
}

/// The greatest speed squared, in mm2/s2, of a corner by itself: from junction deviation for the product of
/// acceleration and deviation in `base`, and from its chords. As a part of a curve it has `of_curve`, and as one of a
/// bend `of_bend`.
#[inline(always)]
fn corner(
    [of_curve, of_bend]: [f32; 2],
    [before, after]: [&Geometry; 2],
    turn_sq: f32,
    goes_on: bool,
    max_accel: f32,
    base: f32,
) -> f32 {
    // The angle between the moves is pi minus the change of direction. So the cosine and the sine of its half are half
    // the difference and half the sum of the two directions.
    let sine = 0.5 * root(square(sum(before, after)));
    if sine < LEAST_SINE {
        return 0.0;
    }
    // 1 - sine without its cancellation.
    let arc = 4.0 * base * sine * (1.0 + sine) / turn_sq;
    let (p, q, curve) = (before.size, after.size, max_accel * sine / root(turn_sq));
    let shorter = least(p, q);
    let circle = least(arc, shorter * curve);
    if shorter >= LONG_CHORD {
        return least(of_bend, circle);
    }
    // A chord behind a long line may be the first of a curve.
    let size = if p < LONG_CHORD && q < LONG_CHORD { 0.5 * (p + q) } else { shorter };
    // The curvature sees no turn within so little, and the lead of a bend at its limit is made up for by then.
    let own = if goes_on && size < SHORTEST { 0.0 } else { SINGLE * arc };
    let (most, alike) = (least(of_bend, arc), greatest(own, size * curve));
    // Where the curvature is known and says nearly the same it counts, because points' errors disturb it less.
    let most = if of_curve >= NEARLY * alike { least(most, alike) } else { most };
    greatest(most, circle)
}

/// The lesser of two limits; a value divided by 0 is infinite, and so is no limit.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two limits.
fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
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

/// Two retractions in a row are one if they go in the same direction.
fn extruder_only(before: &Geometry, after: &Geometry) -> SpeedSq {
    if (before.extrusion < 0.0) == (after.extrusion < 0.0) { SpeedSq::MAX } else { SpeedSq::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::number::acceleration;
    use crate::units::{Mm, MmPerSec, MmPerSec2};

    fn belts(s: &Settings) -> Belts {
        Belts::new(&crate::kinematics::Groups::new(&s.mechanism))
    }

    fn at_corner(
        before: &Geometry,
        after: &Geometry,
        curvature: &mut PathCurvature,
        a: MmPerSec2,
        s: &Settings,
    ) -> u64 {
        let limits = &Limits::of_acceleration(s);
        let (belts, demand) = (&belts(s), &Demand::FLAT);
        let arcs = [Arc::new(s.corner, acceleration(a), acceleration(a)); 2];
        let acceleration = acceleration(a);
        let accel_limits = AccelLimits { acceleration, max_speed: 300.0, limits, belts, demand, arcs };
        let jump = (before.extrusion - after.extrusion).abs();
        junction_speed_sq(before, after, curvature, jump, &accel_limits, s).0
    }

    fn heading(degrees: f64) -> Geometry {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Geometry::new(&[Mm::from_num(10.0 * cos), Mm::from_num(10.0 * sin), Mm::ZERO, Mm::ZERO])
    }

    /// After a long move that led to `before`.
    fn corner(before: &Geometry, after: &Geometry, a: MmPerSec2, s: &Settings) -> u64 {
        at_corner(before, after, &mut PathCurvature::default(), a, s)
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
        let up = Geometry::new(&[Mm::ZERO, Mm::ZERO, Mm::ONE, Mm::ZERO]);
        let sq = corner(&heading(0.0), &up, MmPerSec2::from_num(3000), &s) as f64 / 2f64.powi(32);
        // Z bears 200 mm/s2 and has 0.707 of the change.
        let exact = 200.0 * 2f64.sqrt() * 0.013 * 0.5f64.sqrt() / (1.0 - 0.5f64.sqrt());
        assert!((sq / exact - 1.0).abs() < 1e-3, "{sq} {exact}");
    }

    fn chord(angle: f64, length: f64) -> Geometry {
        let (sin, cos) = angle.sin_cos();
        Geometry::new(&[Mm::from_num(length * cos), Mm::from_num(length * sin), Mm::ZERO, Mm::ZERO])
    }

    #[test]
    fn long_chords_turn_no_faster_than_their_circle_allows() {
        let mut s = Settings::prototype();
        s.corner = CornerRule::JunctionDeviation(Mm::ONE);
        // Chords of 1 mm that turn by 0.2 rad each: a circle of 5 mm.
        let sq = corner(&chord(0.3, 1.001), &chord(0.5, 1.001), MmPerSec2::from_num(3000), &s) as f64 / 2f64.powi(32);
        assert!((sq / 15_000.0 - 1.0).abs() < 5e-3, "{sq}");
    }

    #[test]
    fn a_row_of_small_corners_turns_no_faster_than_its_circle_allows() {
        let (s, a) = (Settings::prototype(), MmPerSec2::from_num(3000));
        for (radius, length) in [(1.0, 0.1), (1.0, 0.02), (10.0, 0.1), (0.2, 0.005)] {
            let mut curvature = PathCurvature::default();
            let mut sq = 0.0;
            for i in 0..(5.0 * radius / length) as u32 {
                let angle = f64::from(i) * length / radius;
                let (p, q) = (chord(angle, length), chord(angle + length / radius, length));
                sq = at_corner(&p, &q, &mut curvature, a, &s) as f64 / 2f64.powi(32);
            }
            // Where the radius is not much more than the shortest distance, means see less of it: 12 % in speed.
            assert!((0.9..1.25).contains(&(sq / (3000.0 * radius))), "{radius} {length}: {sq}");
        }
    }

    /// A bend of 0.004 mm is passed with the speed of the corner that it makes.
    #[test]
    fn a_corner_in_pieces_is_no_faster_than_one() {
        let (s, a) = (Settings::prototype(), MmPerSec2::from_num(3000));
        let (p, q) = (chord(0.0, 1.0), chord(1.0, 1.0));
        let whole = corner(&p, &q, a, &s);
        let mut curvature = PathCurvature::default();
        let mut least = u64::MAX;
        for i in 0..4 {
            let angle = 0.25 * f64::from(i);
            let (p, q) = (chord(angle, 0.001), chord(angle + 0.25, 0.001));
            least = least.min(at_corner(&p, &q, &mut curvature, a, &s));
        }
        assert!(least < whole + whole / 10, "{least} {whole}");
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
