//! The curvature of the path over more than one corner.
//!
//! A finely cut curve is a row of corners, each of them harmless by itself. Two things are kept of the path so far, at
//! a cost that depends neither on the chords nor on the curve:
//!
//! - **The curvature**, for curves that go on. The direction of the path is averaged over a distance l: a passed part
//!   counts less by a factor of e for each l that it is back. On a circle of the radius r such a mean direction lags
//!   behind the direction by the angle l/r, however long the chords are. A mean over 2 l lags by 2 l/r. So the two
//!   means differ by the angle by which the path turns over l. Means are kept for five distances, each twice as long as
//!   the one before. The short ones see small curves. The long ones are hardly disturbed by rounded coordinates: a
//!   point that is off by p turns a mean over l by p/l at most. So this much is subtracted from each difference before
//!   it counts as curvature.
//! - **The lead**, for a bend that is over before the means have seen it. Imagine a velocity that follows the tool's
//!   velocity and changes no faster than the acceleration allows. The lead is the turn that the tool has made and that
//!   velocity has not made yet: each corner adds its turn to the lead, and time reduces it. The speed at a corner is
//!   the one that junction deviation gives to a corner with a turn of the lead plus the greatest recent lead. Time
//!   reduces the latter at the same rate. The greatest counts too because after a turn there and back no lead is left,
//!   though the velocity has changed twice.

use crate::motion::number::root;

/// The longest of the distances, in mm. The curvature has an error of [`ROUNDING`] over the square of half of it,
/// 0.0015 per mm: at 200 mm/s and 3 m/s2 a circle may have 0.075 per mm.
const REACH: f32 = 1.28;

/// Distances. A turn within less than the [shortest](SHORTEST) shows as a lead.
const SCALES: usize = 5;

/// The shortest of the distances, in mm: [`ROUNDING`] is less than a hundredth of it.
pub(in crate::motion) const SHORTEST: f32 = REACH / (1 << (SCALES - 1)) as f32;

/// The error of coordinates, in mm: thousandths of a millimetre put a point up to 0.0007 mm off, and a mean covers
/// several points.
const ROUNDING: f32 = 0.0006;

/// How the path has turned up to its last corner, that one included.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::motion) struct PathCurvature {
    /// Mean directions less the direction, from the longest distance to the shortest.
    means: [[f32; 3]; SCALES],
    /// The lead.
    lead: [f32; 3],
    /// The length of the greatest recent lead.
    greatest_lead: f32,
}

/// How the path bends where it bends most.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::motion) struct Bend {
    /// Its direction: the difference of two directions.
    pub turn: [f32; 3],
    /// The length of that.
    pub size: f32,
    /// One over the radius, in 1/mm.
    pub curvature: f32,
    /// The product of the turn of this corner and the turn over the last [`SHORTEST`] mm before it. It is more than 0
    /// where the path goes on turning to the same side.
    pub same_side: f32,
}

impl PathCurvature {
    /// The lead after a corner that turns the direction by `turn`.
    #[inline(always)]
    pub const fn lead_with(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [lead_x, lead_y, lead_z] = self.lead;
        [x + lead_x, y + lead_y, z + lead_z]
    }

    /// The length of the greatest recent lead, which time reduces as much as the lead.
    #[inline(always)]
    pub const fn greatest_lead(&self) -> f32 {
        self.greatest_lead
    }

    /// The lead is `lead` with that length now; time takes away `most` of it.
    #[inline(always)]
    pub const fn follow_lead(&mut self, [x, y, z]: [f32; 3], length: f32, most: f32) {
        let left = if length > most { 1.0 - most / length } else { 0.0 };
        self.lead = [x * left, y * left, z * left];
        let greatest = if length > self.greatest_lead { length } else { self.greatest_lead };
        self.greatest_lead = if greatest > most { greatest - most } else { 0.0 };
    }

    /// The path turns by `turn` and goes on straight for `length` mm: returns its bend there.
    #[inline(always)]
    pub fn advance(&mut self, [turn_x, turn_y, turn_z]: [f32; 3], length: f32) -> Bend {
        let x = length * const { 1.0 / REACH };
        // e to the power of -x, as far as it matters. Over half the distance it is the square of that.
        let mut left = 1.0 / (1.0 + x * (1.0 + x * (0.5 + x * (const { 1.0 / 6.0 } + x * const { 1.0 / 24.0 }))));
        let (mut reach, mut inverse) = (REACH, const { 1.0 / REACH });
        let [x_ahead, y_ahead, z_ahead] = self.means[SCALES - 1];
        // The mean is less the direction, so it points back: hence the minus. It is the mean before this corner.
        let same_side = -(x_ahead * turn_x + y_ahead * turn_y + z_ahead * turn_z);
        let mut bend = Bend { same_side, ..Bend::default() };
        let mut wider: Option<[f32; 3]> = None;
        for mean in &mut self.means {
            let [x, y, z] = *mean;
            // The direction has turned, so the mean falls behind by the turn. Then the straight way lets it catch up.
            let [x, y, z] = [(x - turn_x) * left, (y - turn_y) * left, (z - turn_z) * left];
            *mean = [x, y, z];
            if let Some([wide_x, wide_y, wide_z]) = wider {
                let [dx, dy, dz] = [x - wide_x, y - wide_y, z - wide_z];
                let square = dx * dx + dy * dy + dz * dz;
                let noise = ROUNDING * inverse;
                // A scale counts if its curvature is greater than that of the longer ones. Their squares are compared,
                // which spares the root of most.
                let known = noise + bend.curvature * reach;
                if square > known * known {
                    let size = root(square);
                    let curvature = (size - noise) * inverse;
                    bend = Bend { turn: [dx, dy, dz], size, curvature, same_side };
                }
            }
            wider = Some([x, y, z]);
            (left, reach, inverse) = (left * left, 0.5 * reach, 2.0 * inverse);
        }
        bend
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chord at `angle`, after one at `before`.
    fn follow(curvature: &mut PathCurvature, before: f64, angle: f64, length: f64) -> Bend {
        let turn = [angle.cos() - before.cos(), angle.sin() - before.sin(), 0.0];
        curvature.advance(turn.map(|v| v as f32), length as f32)
    }

    #[test]
    fn circles_have_their_radius_whatever_the_chords() {
        // Those that are smaller are a matter of the lead.
        for radius in [1.0, 3.0, 10.0, 30.0] {
            for chord in [0.002, 0.01, 0.05, 0.1, 0.3, 0.7] {
                // Coarser ones are separate corners.
                if chord > 0.3 * radius {
                    continue;
                }
                let (mut curvature, mut bend, mut angle) = (PathCurvature::default(), Bend::default(), 0.0);
                for _ in 0..(8.0 / chord) as u32 {
                    // Chords of two lengths by turns: a third, and two thirds.
                    for part in [1.0 / 3.0, 2.0 / 3.0] {
                        bend = follow(&mut curvature, angle, angle + 0.5 * chord / radius, chord * part);
                        angle += 0.5 * chord / radius;
                    }
                }
                let found = 1.0 / f64::from(bend.curvature);
                assert!((found / radius - 1.0).abs() < 0.2, "{radius} {chord}: {found}");
            }
        }
    }

    #[test]
    fn time_takes_the_lead_away() {
        let mut curvature = PathCurvature::default();
        curvature.follow_lead(curvature.lead_with([0.3, 0.4, 0.0]), 0.5, 0.25);
        assert_eq!((curvature.lead_with([0.1, -0.2, 0.0]), curvature.greatest_lead()), ([0.25, 0.0, 0.0], 0.25));
        // There and back: it was far off a moment ago.
        curvature.follow_lead([0.0; 3], 0.0, 0.125);
        assert_eq!((curvature.lead_with([0.0; 3]), curvature.greatest_lead()), ([0.0; 3], 0.125));
        curvature.follow_lead(curvature.lead_with([0.0; 3]), 0.0, 0.5);
        assert_eq!(curvature.greatest_lead(), 0.0);
        // Each coordinate by the same part.
        curvature.follow_lead([0.25, -0.5, 1.0], 2.0, 0.5);
        assert_eq!(curvature.lead_with([0.0; 3]), [0.1875, -0.375, 0.75]);
    }

    #[test]
    fn a_long_way_is_straight_whatever_was_before() {
        let mut curvature = PathCurvature::default();
        let bend = follow(&mut curvature, 0.7, 3.0, 10.0);
        // 3 m/s2 are no limit to it: 380 mm/s.
        assert!(bend.curvature < 0.02, "{bend:?}");
    }

    #[test]
    fn what_rounding_makes_is_no_bend() {
        for chord in [0.02, 0.05, 0.1, 0.2] {
            let (mut curvature, mut before) = (PathCurvature::default(), 0.0);
            let mut most = 0f32;
            for i in 0..500 {
                // Off by half a thousandth to either side in x and y.
                let angle = if i % 2 == 0 { 0.0014 / chord } else { -0.0014 / chord };
                let bend = follow(&mut curvature, before, angle, chord);
                (before, most) = (angle, most.max(bend.curvature));
            }
            // 200 mm/s with 3 m/s2.
            assert!(most < 0.075, "{chord}: {most}");
        }
    }
}
