//! Geometry of one move: its length, its direction, and the speed limit of its axes.
//!
//! Length and direction have 30 bits, because times and corners are computed from them. Limits and ratios are in single
//! precision (see [`number`](crate::motion::number)).

use super::bed::Demand;
use crate::kinematics::{Groups, direction};
use crate::motion::number::{acceleration, large_root, mm, speed};
use crate::motors::MOST_GROUPS;
use crate::settings::{Axes, AxisSettings, Settings};
use crate::units::{Length, Mm};
use heapless::Vec;

/// One in the fixed point of unit vectors.
pub(in crate::motion) const UNIT: i32 = 1 << 30;

/// A move as a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::motion) struct Geometry {
    /// Length of the path of the tool; of the filament if the tool does not move.
    pub length: Length,
    /// The same in mm.
    pub size: f32,
    /// Direction of the tool in x, y, z, scaled by [`UNIT`]; zero if only the extruder moves.
    pub unit: [i32; 3],
    /// Direction of the tool.
    pub direction: [f32; 3],
    /// Filament a length of path, signed.
    pub extrusion: f32,
}

/// The part of a move that each axis, and the belt motor with the most of it, must make; without signs.
#[derive(Clone, Copy)]
pub(in crate::motion) struct Shares {
    axes: [f32; 4],
    belt: f32,
}

/// The limits of axes and belt motors: speeds in mm/s, or accelerations in mm/s2.
#[derive(Clone, Copy)]
pub(in crate::motion) struct Limits {
    pub axes: [f32; 4],
    pub belt: f32,
}

impl Shares {
    /// The limits for a path of the length 1 in that direction, with this much filament, on a surface that demands more
    /// of z.
    #[inline(always)]
    pub fn new([x, y, z]: [f32; 3], extrusion: f32, belts: &Belts, demand: &Demand) -> Self {
        let of_z = demand.of_z([x, y, z]);
        let belt = belts.most_of([x, y, z], of_z - z.abs());
        Self { axes: [x.abs(), y.abs(), of_z, extrusion.abs()], belt }
    }

    /// The greatest value along the move that neither axes nor motors forbid, at most `wanted`.
    #[inline(always)]
    pub fn bound(&self, wanted: f32, limits: &Limits) -> f32 {
        // Written out: firmware is made for size, which leaves loops as they are.
        let ([x, y, z, e], [most_x, most_y, most_z, most_e]) = (self.axes, limits.axes);
        let value = bounded(wanted, x, most_x);
        let value = bounded(value, y, most_y);
        let value = bounded(value, z, most_z);
        let value = bounded(value, e, most_e);
        bounded(value, self.belt, limits.belt)
    }
}

#[inline(always)]
fn bounded(value: f32, share: f32, most: f32) -> f32 {
    if value * share > most { most / share } else { value }
}

impl Limits {
    /// The speed limits.
    #[inline(always)]
    pub fn of_speed(s: &Settings) -> Self {
        let Axes { x, y, z, e } = &s.axes;
        let axes = [speed(x.max_speed), speed(y.max_speed), speed(z.max_speed), speed(e.max_speed)];
        Self { axes, belt: speed(s.motor_max_speed) }
    }

    /// The acceleration limits.
    #[inline(always)]
    pub fn of_acceleration(s: &Settings) -> Self {
        let Axes { x, y, z, e } = &s.axes;
        let bears = |axis: &AxisSettings| acceleration(axis.max_acceleration);
        Self { axes: [bears(x), bears(y), bears(z), bears(e)], belt: acceleration(s.motor_max_acceleration) }
    }
}

/// The belt motors' coordinates: the part of a move of x, y and z that each of them makes. One group is the extruder's.
#[derive(Clone, PartialEq, Debug)]
pub(in crate::motion) struct Belts(Vec<[f32; 3], { MOST_GROUPS - 1 }>);

impl Belts {
    /// The limits of a mechanism.
    #[inline(never)]
    pub fn new(groups: &Groups) -> Self {
        let belts = groups.iter().filter(|group| group.is_belt());
        Self(
            belts
                .map(|belt| direction(belt.row))
                .map(|[x, y, z, _]| [x, y, z].map(f32::from))
                .take(MOST_GROUPS - 1)
                .collect(),
        )
    }

    /// The distance of the motor that goes farthest, where z goes farther by up to `more`.
    #[inline(always)]
    fn most_of(&self, [x, y, z]: [f32; 3], more: f32) -> f32 {
        let mut most = 0.0;
        for [a, b, c] in &self.0 {
            let way = (a * x + b * y + c * z).abs() + c.abs() * more;
            if way > most {
                most = way;
            }
        }
        most
    }
}

impl Geometry {
    /// No move.
    pub const NONE: Self = Self { length: Length::ZERO, size: 0.0, unit: [0; 3], direction: [0.0; 3], extrusion: 0.0 };

    /// The vector `delta` (x, y, z, e).
    pub fn new(delta: &[Mm; 4]) -> Self {
        let mut new = Self::NONE;
        new.set(delta);
        new
    }

    /// Becomes the vector `delta`. One copy: a call takes less than the code in each place.
    #[inline(never)]
    pub fn set(&mut self, delta: &[Mm; 4]) {
        *self = Self::of(*delta);
    }

    #[inline(always)]
    fn of([x, y, z, e]: [Mm; 4]) -> Self {
        let (of_filament, (x, y, z)) = (Length::of(e), (x.to_bits(), y.to_bits(), z.to_bits()));
        let filament = mm(of_filament);
        // Not the maximum: only the place of its highest bit counts.
        let largest = x.unsigned_abs() | y.unsigned_abs() | z.unsigned_abs();
        if largest == 0 {
            let extrusion = if e == Mm::ZERO { 0.0 } else { sign(e) };
            return Self { length: of_filament, size: filament, unit: [0; 3], direction: [0.0; 3], extrusion };
        }
        // With the largest component scaled to 31 bits, the squares of all three fit 64.
        let shift = largest.leading_zeros() as i32 - 33;
        let (x, y, z) = if shift >= 0 {
            ((x as i32) << shift, (y as i32) << shift, (z as i32) << shift)
        } else {
            let down = shift.unsigned_abs();
            ((x >> down) as i32, (y >> down) as i32, (z >> down) as i32)
        };
        let square = |d: i32| (i64::from(d) * i64::from(d)).cast_unsigned();
        // The largest has bit 30 set, so the sum is at least the 2^60 of `large_root`, and the root has 31 or 32 bits.
        let root = large_root(square(x) + square(y) + square(z));
        let (inverse, part) = (1.0 / root as f32, reciprocal(root));
        // 2^61 / root times d, down by 31 bits, is d / root in units of 2^30. The added half rounds it.
        let component = |d: i32| ((i64::from(d) * i64::from(part) + (1 << 30)) >> 31) as i32;
        let unit = [component(x), component(y), component(z)];
        let direction = [x as f32 * inverse, y as f32 * inverse, z as f32 * inverse];
        let length = Length(if shift > 0 {
            // Rounded: a length that is always cut short would run ahead of the clock in the long run.
            u64::from((root >> shift) + (root >> (shift - 1) & 1))
        } else {
            u64::from(root) << shift.unsigned_abs()
        });
        let root = root as f32;
        // 2^(-32 - shift), with a shift of -33 to 30.
        let size = root * f32::from_bits(((127 - 32 - shift) as u32) << 23);
        let extrusion = if e == Mm::ZERO { 0.0 } else { sign(e) * (filament / size) };
        Self { length, size, unit, direction, extrusion }
    }

    /// Takes over another one. Written out: copied as a whole, it would be a call that takes twice as long.
    #[inline(always)]
    pub const fn copy_from(&mut self, other: &Self) {
        let Self { length, size, unit: [x, y, z], direction: [a, b, c], extrusion } = *other;
        *self = Self { length, size, unit: [x, y, z], direction: [a, b, c], extrusion };
    }

    /// The path of the tool.
    #[inline(always)]
    pub const fn path(&self) -> Length {
        if self.is_extruder_only() { Length::ZERO } else { self.length }
    }

    /// Whether the tool stands still and only filament moves.
    pub const fn is_extruder_only(&self) -> bool {
        // Not a comparison of arrays, which is a call.
        let [x, y, z] = self.unit;
        x | y | z == 0
    }
}

fn sign(value: Mm) -> f32 {
    if value < Mm::ZERO { -1.0 } else { 1.0 }
}

/// `2^61 / root` with an error of two at most, clamped to `i32::MAX`, for a root of 31 or 32 bits. Single precision
/// knows 24 bits of it, one of Newton's steps the others: a division of 64 bits takes four times as long.
fn reciprocal(root: u32) -> i32 {
    let one = const { (1u64 << 61) as f32 };
    let guess = (one / root as f32) as i32;
    let remainder = (1i64 << 61) - i64::from(guess) * i64::from(root);
    let correction = ((remainder >> 8) as i32) as f32 * 256.0 / root as f32;
    guess.saturating_add(correction as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn belts(s: &Settings) -> Belts {
        Belts::new(&Groups::new(&s.mechanism))
    }

    fn mm(v: f64) -> Mm {
        Mm::from_num(v)
    }

    #[test]
    fn lengths_are_true_from_nanometres_to_metres() {
        for scale in [1e-6, 1e-3, 0.05, 1.0, 300.0, 4000.0] {
            let g = Geometry::new(&[mm(0.6 * scale), mm(-0.64 * scale), mm(0.48 * scale), Mm::ZERO]);
            let exact = scale * (0.36f64 + 0.4096 + 0.2304).sqrt() * 2f64.powi(32);
            assert!((g.length.0 as f64 - exact).abs() <= 2.0 + exact * 2e-9, "{scale}: {} {exact}", g.length.0);
        }
    }

    #[test]
    fn reciprocals_are_right_to_two() {
        let mut root = 1u64 << 30;
        while root <= u64::from(u32::MAX) {
            for root in [root, (root + root / 3).min(u64::from(u32::MAX)), u64::from(u32::MAX) - root / 5] {
                let exact = ((1 << 61) / root).min(i32::MAX.unsigned_abs().into());
                assert!((i64::from(reciprocal(root as u32)) - exact as i64).abs() <= 2, "{root}");
            }
            root += root / 1000;
        }
    }

    #[test]
    fn directions_have_thirty_bits() {
        for scale in [1e-4, 0.2, 0.7, 50.0, 3000.0] {
            for d in [[0.6, -0.64, 0.48], [-1.0, 0.0, 0.0], [0.0, 0.8, -0.6], [1e-4, 1.0, 0.0]] {
                let [x, y, z] = d.map(|d: f64| mm(d * scale));
                let raw = [x, y, z].map(Mm::to_bits);
                let size = raw.iter().map(|d| (*d as f64).powi(2)).sum::<f64>().sqrt();
                let g = Geometry::new(&[x, y, z, Mm::ZERO]);
                for ((unit, direction), d) in g.unit.into_iter().zip(g.direction).zip(raw) {
                    let exact = d as f64 / size;
                    assert!((f64::from(unit) / f64::from(UNIT) - exact).abs() < 4e-9, "{d} of {scale}: {unit}");
                    assert!((f64::from(direction) - exact).abs() < 2e-7, "{d} of {scale}: {direction}");
                }
                assert!((f64::from(g.size) / (size / 2f64.powi(32)) - 1.0).abs() < 1.3e-7);
            }
        }
    }

    fn speed_limit(g: &Geometry, wanted: f32, s: &Settings) -> f32 {
        Shares::new(g.direction, g.extrusion, &belts(s), &Demand::FLAT).bound(wanted, &Limits::of_speed(s))
    }

    #[test]
    fn a_diagonal_is_as_fast_as_its_motors() {
        let s = Settings::prototype();
        let g = Geometry::new(&[mm(10.0), mm(10.0), Mm::ZERO, Mm::ZERO]);
        let v = speed_limit(&g, 1000.0, &s);
        // u = x + y runs sqrt(2) times as fast as the tool: 450 / 1.414, below the axes' 300 * 1.414.
        assert!((v - 318.198).abs() < 0.01, "{v}");
    }

    #[test]
    fn a_dense_extrusion_is_as_fast_as_the_extruder() {
        let s = Settings::prototype();
        let g = Geometry::new(&[mm(0.001), Mm::ZERO, Mm::ZERO, mm(10.0)]);
        let v = speed_limit(&g, 100.0, &s);
        assert!((v - 0.008).abs() < 2e-5, "{v}");
    }
}
