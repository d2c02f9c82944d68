//! Error: distances of the tool from its line.
//!
//! Only the part of the line is looked at where the tool may be at the time, so that a line beside it is not taken for its
//! own. Near a corner an error towards the inside is rounding, one towards the outside overshoot.

use super::path::{Vertex, nearest};
use crate::steps::TICKS_PER_SECOND;

/// The tool is nowhere where it was sent longer ago than this, in ticks: three periods of 60 Hz.
const LATE: u64 = 500_000;

/// Nor where it will be sent later than this, in ticks.
const EARLY: u64 = 20_000;

/// A bend of less is none, in rad: chords of curves turn by less.
const LEAST_TURN: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// Lines shorter than this have the direction of their steps, not their own, in mm.
const LEAST_LINE_MM: f64 = 0.1;

/// An error this far along the line is not the corner's any more, in mm.
const REACH_MM: f64 = 5.0;

/// A corner of the line and the greatest errors about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where it is, in mm.
    pub at: [f64; 2],
    /// When the tool was sent there, in ticks.
    pub tick: u64,
    /// By how much the line turns, in rad, to the left positive.
    pub turn_rad: f64,
    /// Greatest error towards the inside.
    pub rounding_mm: f64,
    /// Greatest error towards the outside.
    pub overshoot_mm: f64,
    /// Where it is along the line.
    along_mm: f64,
}

impl Corner {
    /// The greater of its errors.
    #[must_use]
    pub fn worst_mm(&self) -> f64 {
        self.rounding_mm.max(self.overshoot_mm)
    }

    /// When the tool was sent there.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.tick as f64 / TICKS_PER_SECOND
    }
}

/// Errors of a tool that follows a line.
#[derive(Clone, Debug)]
pub struct ContourError {
    /// The line.
    pub vertices: Vec<Vertex>,
    /// Greatest distance while each vertex was the end of the nearest part of the line, in mm.
    pub errors_mm: Vec<f32>,
    /// Length of the line before each vertex.
    along_mm: Vec<f64>,
    /// Corners in the order of the line.
    pub corners: Vec<Corner>,
    /// First line that is looked at.
    first: usize,
    /// Greatest distance.
    pub greatest_mm: f64,
    squares: f64,
    samples: u64,
}

impl ContourError {
    /// A tool that is to follow a line.
    #[must_use]
    pub fn new(vertices: Vec<Vertex>) -> Self {
        let length = |pair: &[Vertex]| match pair {
            [a, b] => (b.at[0] - a.at[0]).hypot(b.at[1] - a.at[1]),
            _ => 0.0,
        };
        let ends = vertices.windows(2).scan(0.0, |sum, pair| {
            *sum += length(pair);
            Some(*sum)
        });
        let along_mm: Vec<f64> = std::iter::once(0.0).chain(ends).collect();
        let corners = corners(&vertices, &along_mm);
        let errors_mm = vec![0.0; vertices.len()];
        Self { vertices, errors_mm, along_mm, corners, first: 0, greatest_mm: 0.0, squares: 0.0, samples: 0 }
    }

    /// Root of the mean square of all distances, in mm.
    #[must_use]
    pub fn rms_mm(&self) -> f64 {
        if self.samples == 0 { 0.0 } else { (self.squares / self.samples as f64).sqrt() }
    }

    /// The tool is here at a time; says how far from the line, in mm.
    pub fn sample(&mut self, tick: u64, tool: [f64; 2]) -> f64 {
        while self.vertices.get(self.first + 1).is_some_and(|end| end.tick + LATE < tick)
            && self.first + 2 < self.vertices.len()
        {
            self.first += 1;
        }
        let Some((line, way, distance)) = self.nearest_line(tick, tool) else { return 0.0 };
        self.greatest_mm = self.greatest_mm.max(distance);
        self.squares += distance * distance;
        self.samples += 1;
        if let Some(error) = self.errors_mm.get_mut(line + 1) {
            *error = error.max(distance as f32);
        }
        self.put_down(line, way, distance, tool);
        distance
    }

    /// Puts an error at a part of the line (0 at its begin, 1 at its end) down to a corner, if one is near.
    fn put_down(&mut self, line: usize, way: f64, distance: f64, tool: [f64; 2]) {
        let (Some(a), Some(b)) = (self.vertices.get(line), self.vertices.get(line + 1)) else { return };
        let (Some(begin), Some(end)) = (self.along_mm.get(line), self.along_mm.get(line + 1)) else { return };
        let along = begin + way * (end - begin);
        // At a vertex nothing inside of the bend is nearest.
        let is_at_end = way <= 0.0 || way >= 1.0;
        let left = cross([b.at[0] - a.at[0], b.at[1] - a.at[1]], [tool[0] - a.at[0], tool[1] - a.at[1]]);
        self.note(along, distance, if is_at_end { None } else { Some(left) });
    }

    /// The line that is nearest to the tool, where on it, and how far.
    fn nearest_line(&self, tick: u64, tool: [f64; 2]) -> Option<(usize, f64, f64)> {
        let lines = self.vertices.windows(2).enumerate().skip(self.first);
        let mut best: Option<(usize, f64, f64)> = None;
        for (line, pair) in lines {
            let [a, b] = pair else { continue };
            if a.tick > tick + EARLY && best.is_some() {
                break;
            }
            let (way, distance) = nearest(a.at, b.at, tool);
            if best.is_none_or(|(_, _, least)| distance < least) {
                best = Some((line, way, distance));
            }
        }
        best
    }

    /// Puts an error so far along the line down to the nearest corner, if one is near.
    fn note(&mut self, along: f64, distance: f64, left: Option<f64>) {
        let next = self.corners.partition_point(|corner| corner.along_mm < along);
        let near = [next.checked_sub(1), Some(next)].into_iter().flatten();
        let far = |index: &usize| self.corners.get(*index).map_or(f64::INFINITY, |c| (c.along_mm - along).abs());
        let Some(index) = near.min_by(|a, b| far(a).total_cmp(&far(b))) else { return };
        if far(&index) > REACH_MM {
            return;
        }
        let Some(corner) = self.corners.get_mut(index) else { return };
        let is_inside = left.is_some_and(|left| left * corner.turn_rad > 0.0);
        let worst = if is_inside { &mut corner.rounding_mm } else { &mut corner.overshoot_mm };
        *worst = worst.max(distance);
    }
}

/// The vertices at which the line turns.
fn corners(vertices: &[Vertex], along_mm: &[f64]) -> Vec<Corner> {
    let mut corners = Vec::new();
    for (three, along) in vertices.windows(3).zip(along_mm.iter().skip(1)) {
        let [a, b, c] = three else { continue };
        let (into, out) = ([b.at[0] - a.at[0], b.at[1] - a.at[1]], [c.at[0] - b.at[0], c.at[1] - b.at[1]]);
        if into[0].hypot(into[1]) < LEAST_LINE_MM || out[0].hypot(out[1]) < LEAST_LINE_MM {
            continue;
        }
        let turn_rad = cross(into, out).atan2(into[0] * out[0] + into[1] * out[1]);
        if turn_rad.abs() >= LEAST_TURN {
            let Vertex { at, tick } = *b;
            corners.push(Corner { at, tick, turn_rad, rounding_mm: 0.0, overshoot_mm: 0.0, along_mm: *along });
        }
    }
    corners
}

/// Above 0 if `b` points to the left of `a`.
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> ContourError {
        let at = |x: f64, y: f64, tick| Vertex { at: [x, y], tick };
        ContourError::new(vec![at(0.0, 0.0, 0), at(10.0, 0.0, 1000), at(10.0, 10.0, 2000)])
    }

    #[test]
    fn rounding_is_inside_and_overshoot_outside() {
        let mut error = corner();
        error.sample(900, [9.0, 0.2]);
        error.sample(1000, [10.1, 0.5]);
        assert_eq!(error.corners.len(), 1);
        let found = error.corners[0];
        assert!((found.rounding_mm - 0.2).abs() < 1e-12 && (found.overshoot_mm - 0.1).abs() < 1e-12, "{found:?}");
        assert!((error.greatest_mm - 0.2).abs() < 1e-12);
        assert!((error.rms_mm() - (0.025_f64).sqrt()).abs() < 1e-12);
        error.sample(1100, [10.3, -0.4]);
        assert!((error.corners[0].overshoot_mm - 0.5).abs() < 1e-12);
    }

    #[test]
    fn an_error_far_from_the_corner_is_not_the_corners() {
        let mut error = corner();
        error.sample(200, [2.0, -1.0]);
        assert!(error.corners[0].worst_mm() == 0.0 && error.greatest_mm == 1.0);
    }
}
