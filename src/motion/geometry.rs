//! Geometry of one move: how long it is, which way it points, and how fast its axes let it be.
//!
//! Lengths are exact to a bit; what is a limit or a ratio is in single precision (see [`number`](super::number)).

use super::number::{from_bits, root_of};
use crate::kinematics::Groups;
use crate::motors::MOST_GROUPS;
use crate::settings::Settings;
use crate::units::{MmPerSec, MmPerSec2, Steps, StepsPerMm};
use heapless::Vec;

/// One in the fixed point of unit vectors.
pub(super) const UNIT: i32 = 1 << 30;

/// A move as a vector. Lengths are raw `Mm` bits (2^-32 mm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Geometry {
    /// Length of the path of the tool; of the filament if the tool does not move.
    pub length: u64,
    /// Direction of the tool in x, y, z, scaled by [`UNIT`]; zero if only the extruder moves.
    pub unit: [i32; 3],
    /// Filament a length of path, signed.
    pub extrusion: f32,
}

/// Shares of a way that axes and motors have, and the greatest value along the way by what each of them bears.
pub(super) struct Bounds {
    value: f32,
    is_bound: bool,
}

impl Bounds {
    /// No bound but what is wanted.
    pub const fn new(wanted: f32) -> Self {
        Self { value: wanted, is_bound: false }
    }

    /// An axis or motor of which a way of `one` asks `share` bears no more than `most`.
    pub fn bound(&mut self, most: f32, share: f32, one: f32) {
        let share = share.abs();
        if self.value * share > most * one {
            self.value = most * one / share;
            self.is_bound = true;
        }
    }

    /// The greatest value.
    pub const fn value(&self) -> f32 {
        self.value
    }
}

/// The belt motors' coordinates: how much of a way of x, y and z each of them makes. One group is the extruder's.
#[derive(Clone, Debug)]
pub(super) struct Belts(Vec<[f32; 3], { MOST_GROUPS - 1 }>);

impl Belts {
    /// Those of a mechanism.
    #[inline(never)]
    pub fn new(groups: &Groups) -> Self {
        let belts = groups.iter().filter(|group| group.is_belt());
        Self(belts.map(|belt| [belt.row[0], belt.row[1], belt.row[2]].map(f32::from)).take(MOST_GROUPS - 1).collect())
    }

    /// No belt motor bears more than `most` along a way of length `one`. Not inlined in each of its three places.
    #[inline(never)]
    pub fn bound(&self, bounds: &mut Bounds, most: f32, way: [f32; 3], one: f32) {
        let [x, y, z] = way;
        for [a, b, c] in &self.0 {
            bounds.bound(most, a * x + b * y + c * z, one);
        }
    }
}

/// A speed in mm/s.
pub(super) fn speed(v: MmPerSec) -> f32 {
    v.to_bits() as f32 * const { 1.0 / 65536.0 }
}

/// An acceleration in mm/s2.
pub(super) fn acceleration(a: MmPerSec2) -> f32 {
    a.to_bits() as f32 * const { 1.0 / 256.0 }
}

impl Geometry {
    /// The vector `delta` (x, y, z, e in raw `Mm` bits).
    pub fn new(delta: [i64; 4]) -> Self {
        let [x, y, z, e] = delta;
        let sign = if e < 0 { -1.0 } else { 1.0 };
        let largest = x.unsigned_abs().max(y.unsigned_abs()).max(z.unsigned_abs());
        if largest == 0 {
            let extrusion = if e == 0 { 0.0 } else { sign };
            return Self { length: e.unsigned_abs(), unit: [0; 3], extrusion };
        }
        // With the largest component scaled to 31 bits, the squares of all three fit 64.
        let shift = largest.leading_zeros() as i32 - 33;
        let scaled = [x, y, z].map(|d| scale(d.unsigned_abs(), shift));
        let root = u64::from(root_of(scaled.iter().map(|s| s * s).sum::<u64>()));
        // One division for all three.
        let part = reciprocal(root);
        let component = |d: i64, s: u64| ((s * part) >> 32) as i32 * d.signum() as i32;
        let unit = [component(x, scaled[0]), component(y, scaled[1]), component(z, scaled[2])];
        let length = scale(root, -shift);
        let extrusion = if e == 0 { 0.0 } else { sign * (from_bits(e.unsigned_abs()) / from_bits(length)) };
        Self { length, unit, extrusion }
    }

    /// Whether the tool stands still and only filament moves.
    pub fn is_extruder_only(&self) -> bool {
        // Not a comparison of arrays, which is a call.
        let [x, y, z] = self.unit;
        x | y | z == 0
    }

    /// The fastest that no axis and no belt motor forbids, at most `wanted`.
    pub fn speed_limit(&self, wanted: MmPerSec, belts: &Belts, s: &Settings) -> MmPerSec {
        let axes = s.axes.map(|a| speed(a.max_speed)).to_array();
        let bounds = self.bounds(speed(wanted), axes, belts, speed(s.motor_max_speed));
        let most = if bounds.is_bound { MmPerSec::from_bits((bounds.value * 65536.0) as u32) } else { wanted };
        // Nothing stands still that was asked to move.
        most.max(MmPerSec::DELTA)
    }

    /// The greatest acceleration that no axis and no belt motor forbids, at most `wanted`.
    pub fn acceleration_limit(&self, wanted: MmPerSec2, belts: &Belts, s: &Settings) -> MmPerSec2 {
        let axes = s.axes.map(|a| acceleration(a.max_acceleration)).to_array();
        let bounds = self.bounds(acceleration(wanted), axes, belts, acceleration(s.motor_max_acceleration));
        let most = if bounds.is_bound { MmPerSec2::from_bits((bounds.value * 256.0) as u32) } else { wanted };
        most.max(MmPerSec2::DELTA)
    }

    /// What every axis and motor allows along the path.
    fn bounds(&self, wanted: f32, axes: [f32; 4], belts: &Belts, motor: f32) -> Bounds {
        let [x, y, z] = self.unit.map(|u| u as f32 * const { 1.0 / UNIT as f32 });
        let mut bounds = Bounds::new(wanted);
        for (most, share) in axes.into_iter().zip([x, y, z, self.extrusion]) {
            bounds.bound(most, share, 1.0);
        }
        belts.bound(&mut bounds, motor, [x, y, z], 1.0);
        bounds
    }
}

/// `2^62 / root`, rounded down, for a root of 31 or 32 bits. Single precision knows 24 bits of it, one of Newton's steps
/// the others but for a last one: a division of 64 bits takes four times as long.
fn reciprocal(root: u64) -> u64 {
    let guess = ((1u64 << 62) as f32 / (root as u32) as f32) as u32;
    let rest = (1u64 << 62).wrapping_sub(u64::from(guess).wrapping_mul(root)).cast_signed();
    let correction = ((rest >> 32) as i32) as f32 * 4_294_967_296.0 / (root as u32) as f32;
    let near = i64::from(guess) + i64::from(correction as i32);
    let mut rest = (1i64 << 62) - near * root.cast_signed();
    let (root, mut near) = (root.cast_signed(), near);
    while rest < 0 {
        (rest, near) = (rest + root, near - 1);
    }
    while rest >= root {
        (rest, near) = (rest - root, near + 1);
    }
    near.cast_unsigned()
}

fn scale(value: u64, shift: i32) -> u64 {
    if shift >= 0 {
        value << shift
    } else {
        // Rounded: a length that is always cut short would run ahead of the clock in the long run.
        let down = shift.unsigned_abs();
        (value + (1 << (down - 1))) >> down
    }
}

/// Between millimetres and steps of one axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pitch {
    steps_per_mm: u32,
    /// Raw `Mm` bits a raw `Steps` bit, times 2^48.
    mm_per_step: u64,
}

impl Pitch {
    pub fn new(steps_per_mm: StepsPerMm) -> Self {
        let raw = steps_per_mm.to_bits().max(1);
        Self { steps_per_mm: raw, mm_per_step: (u64::MAX / u64::from(raw)).max(1) }
    }

    /// The position in steps; wraps with the step counters.
    pub fn steps(self, mm: crate::units::Mm) -> Steps {
        let wide = i128::from(mm.to_bits()) * i128::from(self.steps_per_mm);
        Steps::from_bits((wide >> 16) as i64)
    }

    /// A distance of `steps` in raw `Mm` bits.
    pub fn mm_bits(self, steps: Steps) -> i64 {
        let wide = i128::from(steps.to_bits()) * i128::from(self.mm_per_step);
        ((wide + (1 << 47)) >> 48) as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;

    fn belts(s: &Settings) -> Belts {
        Belts::new(&Groups::new(&s.mechanism))
    }

    fn mm(v: f64) -> i64 {
        Mm::from_num(v).to_bits()
    }

    #[test]
    fn lengths_are_true_from_nanometres_to_metres() {
        for scale in [1e-6, 1e-3, 0.05, 1.0, 300.0, 4000.0] {
            let g = Geometry::new([mm(0.6 * scale), mm(-0.64 * scale), mm(0.48 * scale), 0]);
            let exact = scale * (0.36f64 + 0.4096 + 0.2304).sqrt() * 2f64.powi(32);
            assert!((g.length as f64 - exact).abs() <= 2.0 + exact * 2e-9, "{scale}: {} {exact}", g.length);
        }
    }

    #[test]
    fn reciprocals_are_exact() {
        let mut root = 1u64 << 30;
        while root <= u64::from(u32::MAX) {
            for root in [root, (root + root / 3).min(u64::from(u32::MAX)), u64::from(u32::MAX) - root / 5] {
                assert_eq!(reciprocal(root), (1 << 62) / root, "{root}");
            }
            root += root / 1000;
        }
    }

    #[test]
    fn a_diagonal_is_as_fast_as_its_motors() {
        let s = Settings::prototype();
        let g = Geometry::new([mm(10.0), mm(10.0), 0, 0]);
        let v = g.speed_limit(MmPerSec::from_num(1000), &belts(&s), &s).to_num::<f64>();
        // u = x + y runs sqrt(2) times as fast as the tool: 450 / 1.414, below the axes' 300 * 1.414.
        assert!((v - 318.198).abs() < 0.01, "{v}");
    }

    #[test]
    fn a_dense_extrusion_is_as_fast_as_the_extruder() {
        let s = Settings::prototype();
        let g = Geometry::new([mm(0.001), 0, 0, mm(10.0)]);
        let v = g.speed_limit(MmPerSec::from_num(100), &belts(&s), &s).to_num::<f64>();
        assert!((v - 0.008).abs() < 2e-5, "{v}");
    }

    #[test]
    fn steps_and_millimetres_agree() {
        let pitch = Pitch::new(StepsPerMm::from_num(80));
        for v in [-417.6, -1.0, 0.0125, 0.3, 390.0] {
            let steps = pitch.steps(Mm::from_num(v));
            assert!((steps.to_num::<f64>() - 80.0 * v).abs() < 1e-6);
            assert!((pitch.mm_bits(steps) - mm(v)).abs() <= 1);
        }
    }
}
