//! Geometry of one move: how long it is, which way it points, and how fast its axes let it be.

use crate::settings::Settings;
use crate::units::{MmPerSec, MmPerSec2, Steps, StepsPerMm, mul_div};

/// One in the fixed point of unit vectors.
pub(super) const UNIT: i32 = 1 << 30;

/// One in the fixed point of extrusion ratios.
pub(super) const RATIO: u64 = 1 << 24;

/// Bits that a fine acceleration has more than `MmPerSec2`: a corner into a slow axis needs them.
const FINE: u32 = 16;

/// A move as a vector. Lengths are raw `Mm` bits (2^-32 mm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Geometry {
    /// Length of the path of the tool; of the filament if the tool does not move.
    pub length: u64,
    /// Direction of the tool in x, y, z, scaled by [`UNIT`]; zero if only the extruder moves.
    pub unit: [i32; 3],
    /// Filament a length of path, scaled by [`RATIO`] and signed.
    pub extrusion: i64,
}

impl Geometry {
    /// The vector `delta` (x, y, z, e in raw `Mm` bits).
    pub fn new(delta: [i64; 4]) -> Self {
        let [x, y, z, e] = delta;
        let largest = x.unsigned_abs().max(y.unsigned_abs()).max(z.unsigned_abs());
        if largest == 0 {
            let ratio = RATIO as i64 * e.signum();
            return Self { length: e.unsigned_abs(), unit: [0; 3], extrusion: ratio };
        }
        // With the largest component scaled to 31 bits, the squares of all three fit 64.
        let shift = largest.leading_zeros() as i32 - 33;
        let scaled = [x, y, z].map(|d| scale(d.unsigned_abs(), shift));
        let root = scaled.iter().map(|s| s * s).sum::<u64>().isqrt();
        let component = |d: i64, s: u64| (s * UNIT as u64 / root) as i32 * d.signum() as i32;
        let unit = [component(x, scaled[0]), component(y, scaled[1]), component(z, scaled[2])];
        let length = scale(root, -shift);
        let ratio = mul_div(e.unsigned_abs(), RATIO, length).min(i64::MAX as u64) as i64;
        Self { length, unit, extrusion: ratio * e.signum() }
    }

    /// Whether the tool stands still and only filament moves.
    pub fn is_extruder_only(&self) -> bool {
        self.unit == [0; 3]
    }

    /// The fastest that no axis and no belt motor forbids, at most `wanted`.
    pub fn speed_limit(&self, wanted: MmPerSec, s: &Settings) -> MmPerSec {
        let bits = |v: MmPerSec| u64::from(v.to_bits());
        let axes = s.axes.map(|a| bits(a.max_speed)).to_array();
        let most = self.limit(bits(wanted), axes, bits(s.motor_max_speed));
        // Nothing stands still that was asked to move.
        MmPerSec::from_bits((most as u32).max(1))
    }

    /// The greatest acceleration that no axis and no belt motor forbids, at most `wanted`.
    pub fn acceleration_limit(&self, wanted: MmPerSec2, s: &Settings) -> MmPerSec2 {
        MmPerSec2::from_bits(((self.fine_acceleration_limit(wanted, s) >> FINE) as u32).max(1))
    }

    /// The same in 2^-24 mm/s2.
    pub fn fine_acceleration_limit(&self, wanted: MmPerSec2, s: &Settings) -> u64 {
        let bits = |a: MmPerSec2| u64::from(a.to_bits()) << FINE;
        let axes = s.axes.map(|a| bits(a.max_acceleration)).to_array();
        self.limit(bits(wanted), axes, bits(s.motor_max_acceleration))
    }

    /// What every axis and motor allows along the path; its share of the path is at most what it bears.
    fn limit(&self, wanted: u64, axes: [u64; 4], motor: u64) -> u64 {
        let [ux, uy, uz] = self.unit;
        let mut value = wanted;
        let mut bound = |most: u64, share: u64, one: u64| {
            if share != 0 && u128::from(value) * u128::from(share) > u128::from(most) * u128::from(one) {
                value = mul_div(most, one, share);
            }
        };
        let one = UNIT as u64;
        bound(axes[0], u64::from(ux.unsigned_abs()), one);
        bound(axes[1], u64::from(uy.unsigned_abs()), one);
        bound(axes[2], u64::from(uz.unsigned_abs()), one);
        bound(axes[3], self.extrusion.unsigned_abs(), RATIO);
        bound(motor, ux.abs_diff(-uy).into(), one);
        bound(motor, ux.abs_diff(uy).into(), one);
        value
    }
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
    fn a_diagonal_is_as_fast_as_its_motors() {
        let s = Settings::prototype();
        let g = Geometry::new([mm(10.0), mm(10.0), 0, 0]);
        let v = g.speed_limit(MmPerSec::from_num(1000), &s).to_num::<f64>();
        // u = x + y runs sqrt(2) times as fast as the tool: 450 / 1.414, below the axes' 300 * 1.414.
        assert!((v - 318.198).abs() < 0.01, "{v}");
    }

    #[test]
    fn a_dense_extrusion_is_as_fast_as_the_extruder() {
        let s = Settings::prototype();
        let g = Geometry::new([mm(0.001), 0, 0, mm(10.0)]);
        let v = g.speed_limit(MmPerSec::from_num(100), &s).to_num::<f64>();
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
