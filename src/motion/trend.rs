//! The trend of the path: how much it bends on average, over some tenths of a millimetre.
//!
//! Coordinates are rounded, to a thousandth of a millimetre by most slicers. Between chords of 0.1 mm that makes angles of
//! up to 0.03, which is three times the turn of a circle of 10 mm: what a single corner tells of the radius is noise.
//!
//! The direction is averaged over the path behind, with weights that fall by e over the length l, and that average is
//! averaged once more. On a circle of the radius r both lag behind the direction and behind each other such that their
//! difference is l/r of the second one, whatever the chords.

use super::geometry::Geometry;
use super::number::root;

/// l in mm. The curvature is wrong by what coordinates are rounded by, over l^2: by 0.003 to 0.01 a mm for a thousandth of a
/// millimetre. At 200 mm/s and 3 m/s2 a circle may have 0.075 a mm. A longer l would see it later where a curve begins.
const REACH: f32 = 0.3;

/// The direction of the path, averaged once and twice.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Trend {
    once: [f32; 3],
    twice: [f32; 3],
}

impl Trend {
    /// The path goes on along `way`.
    #[inline(always)]
    pub fn follow(&mut self, way: &Geometry) {
        if way.is_extruder_only() {
            return;
        }
        let x = way.size * const { 1.0 / REACH };
        // e to the power of -x, so far as it matters.
        let left = 1.0 / (1.0 + x * (1.0 + x * (0.5 + x * (const { 1.0 / 6.0 } + x * const { 1.0 / 24.0 }))));
        for ((once, twice), direction) in self.once.iter_mut().zip(&mut self.twice).zip(way.direction) {
            let lag = *once - direction;
            *twice = direction + (*twice - direction) * left + lag * (x * left);
            *once = direction + lag * left;
        }
    }

    /// Which way the path bends, the length of that vector, and the radius of which it is a part; infinite where it is
    /// straight.
    pub fn bend(&self) -> ([f32; 3], f32, f32) {
        let [ox, oy, oz] = self.once;
        let [tx, ty, tz] = self.twice;
        let turn = [ox - tx, oy - ty, oz - tz];
        let [x, y, z] = turn;
        let size = root(x * x + y * y + z * z);
        (turn, size, REACH * root(tx * tx + ty * ty + tz * tz) / size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;

    fn follow(trend: &mut Trend, x: f64, y: f64) {
        trend.follow(&Geometry::new([Mm::from_num(x).to_bits(), Mm::from_num(y).to_bits(), 0, 0]));
    }

    #[test]
    fn circles_have_their_radius_whatever_the_chords() {
        for radius in [0.3, 1.0, 10.0, 100.0] {
            for chord in [0.01, 0.05, 0.1, 0.3] {
                let turn = chord / radius;
                let mut trend = Trend::default();
                for i in 0..(5.0 / chord) as u32 {
                    // Chords of two lengths by turns: a third, and two thirds.
                    for (middle, part) in [(1.0 / 6.0, 1.0 / 3.0), (2.0 / 3.0, 2.0 / 3.0)] {
                        let (sin, cos) = (turn * (f64::from(i) + middle)).sin_cos();
                        follow(&mut trend, chord * part * cos, chord * part * sin);
                    }
                }
                let (.., found) = trend.bend();
                assert!((f64::from(found) / radius - 1.0).abs() < 0.15, "{radius} {chord}: {found}");
            }
        }
    }

    #[test]
    fn a_long_way_is_straight_whatever_was_before() {
        let mut trend = Trend::default();
        follow(&mut trend, 0.1, 0.1);
        follow(&mut trend, -5.0, 0.1);
        let (.., radius) = trend.bend();
        // 3 m/s2 are no limit to it: 400 mm/s.
        assert!(radius > 50.0, "{radius}");
    }
}
