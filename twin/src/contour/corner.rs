//! Corner: where the line turns, and the errors of the tool there.

use super::path::{Vertex, nearest};
use crate::math::{atan2, hypot};
use crate::steps::TICKS_PER_SECOND;
use std::ops::Range;

/// Smallest bend that counts as a corner, in rad: chords of curves turn by less.
const LEAST_TURN: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A line that turns by more goes back along its bisector rather than across it, in rad.
const MOST_TURN: f64 = 136.0 * std::f64::consts::PI / 180.0;

/// Shorter lines have only the direction of their steps, in mm.
pub const LEAST_LINE_MM: f64 = 0.1;

/// Longest bend of short lines, in mm: a longer one is a curve.
const LONGEST_BEND_MM: f64 = 2.0 * LEAST_LINE_MM;

/// A corner of the line and the largest errors about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Its place, in mm.
    pub at: [f64; 2],
    /// When the tool was sent there, in ticks.
    pub tick: u64,
    /// Turn of the line, in rad, positive to the left.
    pub turn_rad: f64,
    /// Largest error towards the inside.
    pub rounding_mm: f64,
    /// Largest error towards the outside.
    pub overshoot_mm: f64,
    /// Distance from the corner to the tool's first crossing of its bisector (equation 17 of Yin et al.), inside
    /// positive. None without a crossing, or if the line turns right back.
    pub bisector_mm: Option<f64>,
    /// Its distance along the line.
    pub(super) along_mm: f64,
    /// Directions into it and out of it.
    into: [f64; 2],
    out: [f64; 2],
    /// The tool's distance beyond the bisector, and along it towards the inside.
    last: Option<[f64; 2]>,
}

impl Corner {
    /// Whether the tool was ever near it. Otherwise its errors mean nothing.
    #[must_use]
    pub const fn is_seen(&self) -> bool {
        self.last.is_some()
    }

    /// The larger of its errors.
    #[must_use]
    pub fn worst_mm(&self) -> f64 {
        self.rounding_mm.max(self.overshoot_mm)
    }

    /// The tool is near it. The first crossing of the bisector counts; between two samples its path is a chord.
    pub(super) fn cross(&mut self, tool: [f64; 2]) {
        let to = [tool[0] - self.at[0], tool[1] - self.at[1]];
        let inside = [self.out[0] - self.into[0], self.out[1] - self.into[1]];
        let length = hypot(inside[0], inside[1]);
        let now = [dot(to, self.into) + dot(to, self.out), dot(to, inside) / length];
        if let (None, Some(before)) = (self.bisector_mm, self.last)
            && before[0] < 0.0
            && now[0] >= 0.0
            && self.turn_rad.abs() < MOST_TURN
        {
            let part = before[0] / (before[0] - now[0]);
            self.bisector_mm = Some(before[1] + part * (now[1] - before[1]));
        }
        self.last = Some(now);
    }

    /// When the tool was sent there.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.tick as f64 / TICKS_PER_SECOND
    }
}

/// The places at which the line turns, and the number of turns without a line on both sides.
///
/// Steps may leave an extra vertex or two where two lines meet. Vertices joined only by lines as short as steps are one
/// bend. Its turn is the angle between the lines before and after it.
pub(super) fn corners(vertices: &[Vertex], along_mm: &[f64]) -> (Vec<Corner>, usize) {
    let mut corners = Vec::new();
    let mut without_lines = 0;
    let along = |vertex: usize| along_mm.get(vertex).copied().unwrap_or(0.0);
    let is_line = |begin: usize| along(begin + 1) - along(begin) >= LEAST_LINE_MM;
    let inner_end = vertices.len().saturating_sub(1);
    let mut first = 1;
    while first < inner_end {
        let last = (first..inner_end).find(|vertex| is_line(*vertex)).unwrap_or(inner_end - 1);
        let turns = vertices.get(first - 1..last + 2).unwrap_or_default().windows(3).map(turn);
        if is_line(first - 1) && is_line(last) && along(last) - along(first) < LONGEST_BEND_MM {
            corners.extend(corner(vertices, along_mm, first..last + 1, turns.sum()));
        } else {
            without_lines += turns.filter(|turn| turn.abs() >= LEAST_TURN).count();
        }
        first = last + 1;
    }
    (corners, without_lines)
}

/// The corner of a bend between two lines, if it is one. Its place is the vertex furthest from the direct line across.
fn corner(vertices: &[Vertex], along_mm: &[f64], bend: Range<usize>, turns_rad: f64) -> Option<Corner> {
    let direction = |a: &Vertex, b: &Vertex| unit([b.at[0] - a.at[0], b.at[1] - a.at[1]]);
    let (begin, end) = (vertices.get(bend.start)?, vertices.get(bend.end - 1)?);
    let into = direction(vertices.get(bend.start - 1)?, begin);
    let out = direction(end, vertices.get(bend.end)?);
    let turn_rad = atan2(cross(into, out), dot(into, out));
    // The bend tells to which side a line turns right back.
    let turn_rad = if turn_rad.abs() > MOST_TURN { turn_rad.abs().copysign(turns_rad) } else { turn_rad };
    if turn_rad.abs() < LEAST_TURN {
        return None;
    }
    let across = [0, 1].map(|i| [begin.at[i] - LEAST_LINE_MM * into[i], end.at[i] + LEAST_LINE_MM * out[i]]);
    let [from, to] = [0, 1].map(|end| [across[0][end], across[1][end]]);
    let off = |vertex: &usize| vertices.get(*vertex).map_or(0.0, |vertex| nearest(from, to, vertex.at).1);
    let vertex = bend.max_by(|a, b| off(a).total_cmp(&off(b)))?;
    let Vertex { at, tick } = *vertices.get(vertex)?;
    let along_mm = *along_mm.get(vertex)?;
    Some(Corner {
        at,
        tick,
        turn_rad,
        rounding_mm: 0.0,
        overshoot_mm: 0.0,
        bisector_mm: None,
        along_mm,
        into,
        out,
        last: None,
    })
}

/// Turn of three vertices, in rad, positive to the left.
fn turn(three: &[Vertex]) -> f64 {
    let [a, b, c] = three else { return 0.0 };
    let (into, out) = ([b.at[0] - a.at[0], b.at[1] - a.at[1]], [c.at[0] - b.at[0], c.at[1] - b.at[1]]);
    atan2(cross(into, out), dot(into, out))
}

fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = hypot(x, y);
    [x / length, y / length]
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Above 0 if `b` points to the left of `a`.
pub(super) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
