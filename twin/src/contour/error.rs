//! Error: distances of the tool from its line.
//!
//! Only the part of the line near the commanded place counts, from a period ago to shortly ahead. So a neighbouring
//! line is not mistaken for the tool's own. A tool that follows another file's line has a [`Pace`], which gives the
//! intended time of each place. Near a corner an error towards the inside is rounding, one towards the outside
//! overshoot.

use super::corner::{Corner, corners, cross};
use super::line_types::LineTypes;
use super::pace::Pace;
use super::path::{Vertex, nearest};
use super::touches::Touches;
use super::trail::Trail;
use crate::math::hypot;
use crate::steps::TICKS_PER_SECOND;
use std::ops::Range;

/// Time window of the tool's possible places on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The tool is nowhere that it was sent longer ago than this, in ticks.
    pub late: u64,
    /// Nor where it will be sent later than this.
    pub early: u64,
}

impl Window {
    /// For a machine with this lowest frequency, w in rad/s. A tool that sets off with `a` is at most `2 a / w^2`
    /// behind, where it was sent `2 / w` ago, a third of a period. A ringing tool is ahead by `1 / w` at most.
    #[must_use]
    pub fn of_hz(slowest: f64) -> Self {
        let period = (TICKS_PER_SECOND / slowest.max(LEAST_HZ)) as u64;
        Self { late: period / 2, early: period / 4 }
    }
}

/// Lowest frequency of a machine that still holds its tool, in Hz.
const LEAST_HZ: f64 = 5.0;

/// Errors further than this along the line do not belong to the corner, in mm.
const REACH_MM: f64 = 5.0;

/// Errors of a tool that follows a line.
#[derive(Clone, Debug)]
pub struct ContourError {
    /// The line.
    pub vertices: Vec<Vertex>,
    /// Largest distance while each vertex ended the nearest part of the line, in mm.
    pub errors_mm: Vec<f32>,
    /// Length of the line before each vertex.
    along_mm: Vec<f64>,
    /// Corners in the order of the line.
    pub corners: Vec<Corner>,
    /// Turns without a line on both sides to measure them by.
    pub without_lines: usize,
    window: Window,
    /// Times of the distances along the line, in order.
    times: Vec<(u64, f64)>,
    /// The last place before the window, and the first after it.
    window_at: [usize; 2],
    /// Intended times of the tool's places, if the line is from another file.
    pace: Option<Pace>,
    /// Errors in them are not the print's.
    touches: Touches,
    /// Largest distance in touches, in mm.
    pub touch_mm: f64,
    /// First line to search.
    first: usize,
    /// Errors on each type of line.
    pub line_types: LineTypes,
    /// Displacements of the tool from the line, for pictures.
    pub trail: Trail,
    /// Largest distance.
    pub greatest_mm: f64,
    squares: f64,
    samples: u64,
}

impl ContourError {
    /// A tool that should follow a line, and places of it with their times. More places give the tool's window more
    /// exactly.
    #[must_use]
    pub fn new(vertices: Vec<Vertex>, places: &[Vertex], window: Window) -> Self {
        let length = |pair: &[Vertex]| match pair {
            [a, b] => hypot(b.at[0] - a.at[0], b.at[1] - a.at[1]),
            _ => 0.0,
        };
        let ends = vertices.windows(2).scan(0.0, |sum, pair| {
            *sum += length(pair);
            Some(*sum)
        });
        let along_mm: Vec<f64> = std::iter::once(0.0).chain(ends).collect();
        let (corners, without_lines) = corners(&vertices, &along_mm);
        let errors_mm = vec![0.0; vertices.len()];
        let times = times(&vertices, &along_mm, places);
        Self {
            vertices,
            errors_mm,
            along_mm,
            corners,
            without_lines,
            window,
            times,
            window_at: [0; 2],
            pace: None,
            touches: Touches::default(),
            touch_mm: 0.0,
            first: 0,
            line_types: LineTypes::default(),
            trail: Trail::default(),
            greatest_mm: 0.0,
            squares: 0.0,
            samples: 0,
        }
    }

    /// The same for a tool with its own timing along the line.
    #[must_use]
    pub fn at_pace(self, pace: Pace) -> Self {
        Self { pace: Some(pace), ..self }
    }

    /// The same with the errors on each type of line apart, too.
    #[must_use]
    pub fn of_types(self, line_types: LineTypes) -> Self {
        Self { line_types, ..self }
    }

    /// The same with the errors in touches apart, and without their corners.
    #[must_use]
    pub fn apart_from(mut self, touches: Touches) -> Self {
        self.corners.retain(|corner| !touches.has(corner.tick));
        Self { touches, ..self }
    }

    /// Root of the mean square of all distances, in mm.
    #[must_use]
    pub fn rms_mm(&self) -> f64 {
        if self.samples == 0 { 0.0 } else { (self.squares / self.samples as f64).sqrt() }
    }

    /// Takes the tool's place at a time and returns its distance from the line, in mm.
    pub fn sample(&mut self, tick: u64, tool: [f64; 2]) -> f64 {
        let meant = self.pace.as_mut().map_or(tick, |pace| pace.meant(tick));
        let part = self.part(meant);
        let is_over = |end: usize| self.along_mm.get(end).is_some_and(|end| *end < part.start);
        while is_over(self.first + 1) && self.first + 2 < self.vertices.len() {
            self.first += 1;
        }
        let Some((line, way, distance)) = self.nearest_line(part, tool) else { return 0.0 };
        let is_touch = self.touches.has(tick);
        if is_touch {
            self.touch_mm = self.touch_mm.max(distance);
        } else {
            self.greatest_mm = self.greatest_mm.max(distance);
            self.squares += distance * distance;
            self.samples += 1;
            self.line_types.add(line + 1, distance, tick, tool);
        }
        if let Some(error) = self.errors_mm.get_mut(line + 1) {
            *error = error.max(distance as f32);
        }
        if let (Some(a), Some(b)) = (self.vertices.get(line), self.vertices.get(line + 1)) {
            let near = [0, 1].map(|i| a.at[i] + way * (b.at[i] - a.at[i]));
            self.trail.add(tick, near, [0, 1].map(|i| tool[i] - near[i]));
        }
        if !is_touch {
            self.put_down(line, way, distance, tool);
        }
        distance
    }

    /// Assigns an error at a part of the line (0 at its begin, 1 at its end) to a corner, if one is near.
    fn put_down(&mut self, line: usize, way: f64, distance: f64, tool: [f64; 2]) {
        let (Some(a), Some(b)) = (self.vertices.get(line), self.vertices.get(line + 1)) else { return };
        let (Some(begin), Some(end)) = (self.along_mm.get(line), self.along_mm.get(line + 1)) else { return };
        let along = begin + way * (end - begin);
        // At a vertex no place inside of the bend is nearest.
        let is_at_end = way <= 0.0 || way >= 1.0;
        let left = cross([b.at[0] - a.at[0], b.at[1] - a.at[1]], [tool[0] - a.at[0], tool[1] - a.at[1]]);
        self.note(along, distance, if is_at_end { None } else { Some(left) }, tool);
    }

    /// Range of distances along the line within the window about a time. Times must not decrease.
    fn part(&mut self, tick: u64) -> Range<f64> {
        let [from, to] = &mut self.window_at;
        let is_over = |next: usize, tick: u64| self.times.get(next).is_some_and(|(next, _)| *next <= tick);
        while is_over(*from + 1, tick.saturating_sub(self.window.late)) {
            *from += 1;
        }
        while is_over(*to, tick + self.window.early) {
            *to += 1;
        }
        let along = |at: usize| self.times.get(at).or(self.times.last()).map_or(0.0, |(_, along)| *along);
        along(*from)..along(*to)
    }

    /// The line nearest to the tool, the place on it, and the distance, of this part of all lines.
    fn nearest_line(&self, part: Range<f64>, tool: [f64; 2]) -> Option<(usize, f64, f64)> {
        let lines = self.vertices.windows(2).zip(self.along_mm.windows(2)).enumerate().skip(self.first);
        let mut best: Option<(usize, f64, f64)> = None;
        for (line, (ends, along)) in lines {
            let ([a, b], [begin, end]) = (ends, along) else { continue };
            if *begin > part.end && best.is_some() {
                break;
            }
            let length = end - begin;
            let [low, high] = [part.start, part.end].map(|mm| if length > 0.0 { (mm - begin) / length } else { 0.0 });
            let (way, _) = nearest(a.at, b.at, tool);
            let way = way.max(low.min(1.0)).min(high.max(0.0)).clamp(0.0, 1.0);
            let off = [0, 1].map(|i| a.at[i] + way * (b.at[i] - a.at[i]) - tool[i]);
            let distance = hypot(off[0], off[1]);
            if best.is_none_or(|(_, _, least)| distance < least) {
                best = Some((line, way, distance));
            }
        }
        best
    }

    /// Assigns an error at a distance along the line to the nearest corner, if one is near.
    fn note(&mut self, along: f64, distance: f64, left: Option<f64>, tool: [f64; 2]) {
        let next = self.corners.partition_point(|corner| corner.along_mm < along);
        let near = [next.checked_sub(1), Some(next)].into_iter().flatten();
        let far = |index: &usize| self.corners.get(*index).map_or(f64::INFINITY, |c| (c.along_mm - along).abs());
        let Some(index) = near.min_by(|a, b| far(a).total_cmp(&far(b))) else { return };
        if far(&index) > REACH_MM {
            return;
        }
        let Some(corner) = self.corners.get_mut(index) else { return };
        corner.cross(tool);
        let is_inside = left.is_some_and(|left| left * corner.turn_rad > 0.0);
        let worst = if is_inside { &mut corner.rounding_mm } else { &mut corner.overshoot_mm };
        *worst = worst.max(distance);
    }
}

/// Times of the distances along a line, from places of it in order.
fn times(vertices: &[Vertex], along_mm: &[f64], places: &[Vertex]) -> Vec<(u64, f64)> {
    let mut line = 0;
    let mut before = 0.0_f64;
    let time = |place: &Vertex| {
        while vertices.get(line + 1).is_some_and(|end| end.tick < place.tick) {
            line += 1;
        }
        if let (Some(a), Some(b)) = (vertices.get(line), vertices.get(line + 1)) {
            let begin = along_mm.get(line).copied().unwrap_or(0.0);
            let length = hypot(b.at[0] - a.at[0], b.at[1] - a.at[1]);
            before = before.max(begin + nearest(a.at, b.at, place.at).0 * length);
        }
        (place.tick, before)
    };
    std::iter::once((0, 0.0)).chain(places.iter().map(time)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window { late: 500_000, early: 20_000 };

    fn corner() -> ContourError {
        let at = |x: f64, y: f64, tick| Vertex { at: [x, y], tick };
        let line = vec![at(0.0, 0.0, 0), at(10.0, 0.0, 1000), at(10.0, 10.0, 2000)];
        ContourError::new(line.clone(), &line, WINDOW)
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

    /// From (9.6, 0) to (10, 0.4) the path is on the line x - y = 9.6, which meets the bisector x + y = 10 at (9.8,
    /// 0.2).
    #[test]
    fn a_cut_corner_is_measured_along_its_bisector() {
        let mut error = corner();
        error.sample(900, [9.6, 0.0]);
        error.sample(1000, [10.0, 0.4]);
        error.sample(1100, [10.0, 0.6]);
        let found = error.corners[0].bisector_mm.unwrap();
        assert!((found - 0.2 * std::f64::consts::SQRT_2).abs() < 1e-12, "{found}");
    }

    #[test]
    fn an_error_far_from_the_corner_is_not_the_corners() {
        let mut error = corner();
        error.sample(200, [2.0, -1.0]);
        assert!(error.corners[0].worst_mm() == 0.0 && error.greatest_mm == 1.0);
    }
}
