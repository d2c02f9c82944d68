//! Profile: the tool's mean deviation in each piece of a side or a circle.

use corehbot_twin::math::{atan2, cos, hypot, sin};
use std::f64::consts::TAU;

/// Length of a piece of a side, in mm.
const PIECE_MM: f64 = 0.1;

/// Pieces of a circle: degrees.
const PIECES: usize = 360;

/// Deviations in mm of the pieces that the tool was in, in order; outwards (to the right of the way) is positive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    pieces: Vec<Option<f64>>,
}

impl Profile {
    /// Along a side from `a` to `b`, by samples of the tool near it.
    #[must_use]
    pub fn of_side(a: [f64; 2], b: [f64; 2], tool: &[[f64; 2]]) -> Self {
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = hypot(along[0], along[1]);
        let [u, v] = along.map(|part| part / length);
        let count = (length / PIECE_MM).round() as usize;
        let of = |at: &[f64; 2]| {
            let [x, y] = [at[0] - a[0], at[1] - a[1]];
            ((x * u + y * v) / PIECE_MM, x * v - y * u)
        };
        Self::new(count, tool.iter().map(of))
    }

    /// Around a circle, counter-clockwise from its right, by all samples.
    #[must_use]
    pub fn of_circle(centre: [f64; 2], radius: f64, tool: &[[f64; 2]]) -> Self {
        let of = |at: &[f64; 2]| {
            let [x, y] = [at[0] - centre[0], at[1] - centre[1]];
            // The first piece is about the right.
            let turned = (atan2(y, x) / TAU * PIECES as f64 + 0.5).rem_euclid(PIECES as f64);
            (turned, hypot(x, y) - radius)
        };
        Self::new(PIECES, tool.iter().map(of))
    }

    /// From places, in pieces, and deviations.
    fn new(count: usize, samples: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut sums = vec![(0.0, 0_u32); count];
        for (place, off) in samples.filter(|(place, _)| *place >= 0.0) {
            if let Some((sum, seen)) = sums.get_mut(place as usize) {
                *sum += off;
                *seen += 1;
            }
        }
        let mean = |(sum, seen): (f64, u32)| (seen > 0).then(|| sum / f64::from(seen));
        Self { pieces: sums.into_iter().map(mean).collect() }
    }

    /// Mean deviation in the middle half.
    #[must_use]
    pub fn middle(&self) -> f64 {
        let quarter = self.pieces.len() / 4;
        mean(self.pieces.iter().skip(quarter).take(self.pieces.len() - 2 * quarter).flatten().copied())
    }

    /// Least and greatest deviation, a millimetre from both ends on.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        let end = (1.0 / PIECE_MM) as usize;
        range(self.pieces.iter().skip(end).take(self.pieces.len().saturating_sub(2 * end)).flatten().copied())
    }

    /// Sum with the profile of the opposite side, which was passed the other way.
    #[must_use]
    pub fn across(&self, opposite: &Self) -> Self {
        let pairs = self.pieces.iter().zip(opposite.pieces.iter().rev());
        Self { pieces: pairs.map(|(a, b)| Some((*a)? + (*b)?)).collect() }
    }

    /// Mean deviation of the ten degrees on both sides of an angle, in degrees.
    #[must_use]
    pub fn about(&self, degrees: usize) -> f64 {
        let near = (PIECES - 10..=PIECES + 10).map(|piece| (piece + degrees) % PIECES);
        mean(near.filter_map(|piece| self.pieces.get(piece).copied().flatten()))
    }

    /// Mean deviation all around.
    #[must_use]
    pub fn all_around(&self) -> f64 {
        mean(self.pieces.iter().flatten().copied())
    }

    /// Greatest minus least deviation all around.
    #[must_use]
    pub fn out_of_round(&self) -> f64 {
        let [least, most] = range(self.pieces.iter().flatten().copied());
        most - least
    }

    /// Displacement of the centre: the first harmonic.
    #[must_use]
    pub fn centre(&self) -> [f64; 2] {
        let part = |of: fn(f64) -> f64| {
            let pieces = self.pieces.iter().enumerate();
            let angle = |piece: usize| piece as f64 / PIECES as f64 * TAU;
            2.0 * mean(pieces.filter_map(|(piece, off)| Some((*off)? * of(angle(piece)))))
        };
        [part(cos), part(sin)]
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    if count == 0 { 0.0 } else { sum / f64::from(count) }
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let all = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    if all[0] <= all[1] { all } else { [0.0; 2] }
}

/// How far outside of a corner, to the right of both ways, the tool gets near it, in mm; negative is inside, where this
/// is more. `before` and `after` are the corners next to it.
#[must_use]
pub fn corner(before: [f64; 2], at: [f64; 2], after: [f64; 2], tool: &[[f64; 2]]) -> f64 {
    /// The tool is near a corner within this distance, in mm.
    const NEAR_MM: f64 = 1.0;
    let right = |a: [f64; 2], b: [f64; 2]| {
        let length = hypot(b[0] - a[0], b[1] - a[1]);
        [(b[1] - a[1]) / length, (a[0] - b[0]) / length]
    };
    let sides = [right(before, at), right(at, after)];
    let off = |place: &[f64; 2]| {
        let to = [place[0] - at[0], place[1] - at[1]];
        let [a, b] = sides.map(|right| to[0] * right[0] + to[1] * right[1]);
        (hypot(to[0], to[1]) < NEAR_MM).then_some(a.max(b))
    };
    let [inside, outside] = range(tool.iter().filter_map(off));
    if outside.abs() >= inside.abs() { outside } else { inside }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    /// A circle of 10.01 mm about (0.02, 0): its centre and radius are found.
    #[test]
    fn a_circle_is_found_by_its_deviations() {
        let at = |i: u32| (f64::from(i) / 3600.0 * TAU).sin_cos();
        let tool: Vec<[f64; 2]> = (0..3600).map(at).map(|(sin, cos)| [0.02 + 10.01 * cos, 10.01 * sin]).collect();
        let profile = Profile::of_circle([0.0; 2], 10.0, &tool);
        let [x, y] = profile.centre();
        assert!((x - 0.02).abs() < 1e-4 && y.abs() < 1e-6, "{x} {y}");
        assert!((profile.all_around() - 0.01).abs() < 1e-4 && (profile.out_of_round() - 0.04).abs() < 1e-4);
        assert!((profile.about(0) - 0.03).abs() < 2e-4 && (profile.about(180) + 0.01).abs() < 2e-4);
        assert!((profile.about(90) - 0.01).abs() < 1e-3);
    }

    /// Along y outwards is to the right: x is too large.
    #[test]
    fn a_side_is_outside_to_the_right_of_its_way() {
        let tool: Vec<[f64; 2]> = (0..2000).map(|i| [10.05, f64::from(i) / 100.0]).collect();
        let side = Profile::of_side([10.0, 0.0], [10.0, 20.0], &tool);
        assert!(near(side.middle(), 0.05) && near(side.range()[0], 0.05));
        let back: Vec<[f64; 2]> = (0..2000).map(|i| [9.63, 20.0 - f64::from(i) / 100.0]).collect();
        let opposite = Profile::of_side([9.6, 20.0], [9.6, 0.0], &back);
        assert!(near(opposite.middle(), -0.03) && near(side.across(&opposite).middle(), 0.02));
    }

    /// The tool goes from (9.9, 0) to (10, 0.1), past the corner (10, 0) on its inside; then it passes it by.
    #[test]
    fn a_cut_corner_is_inside_and_one_that_is_passed_by_is_outside() {
        let off = |tool: &[[f64; 2]]| corner([0.0; 2], [10.0, 0.0], [10.0, 10.0], tool);
        assert!(near(off(&[[9.8, 0.0], [9.9, 0.0], [9.95, 0.05], [10.0, 0.1], [10.0, 0.2]]), -0.05));
        assert!(near(off(&[[9.8, 0.0], [10.0, 0.0], [10.03, 0.0], [10.0, 0.2]]), 0.03));
        assert!(near(off(&[[0.0; 2]]), 0.0));
    }
}
