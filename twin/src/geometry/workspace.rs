//! Workspace: the places of the tool where every segment has a positive length (the condition of the paper's equation
//! 20).
//!
//! On these machines every segment is along x or y and its length is linear in the tool's x or y. So the reach along
//! each axis ends where the first segment has no length left.

use super::layout;
use super::segment::Segment;
use crate::params::Params;
use crate::routing::{Machine, Place};

/// A rectangle (or box) of tool places, in mm from motor 1's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workspace {
    /// Leftmost and rightmost.
    pub x: [f64; 2],
    /// Foremost and backmost.
    pub y: [f64; 2],
    /// Lowest and highest, where belts lift the tool; otherwise 0 and 0.
    pub z: [f64; 2],
}

impl std::fmt::Display for Workspace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([a, b], [c, d]) = (self.x, self.y);
        write!(f, "x {a:.1} to {b:.1}, y {c:.1} to {d:.1}")
    }
}

impl Workspace {
    /// Whether there is any place for the tool.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.x[0] < self.x[1] && self.y[0] < self.y[1]
    }

    /// Whether the tool can be there, up to rounding.
    #[must_use]
    pub fn has(&self, tool: Place) -> bool {
        const ROUNDING: f64 = 1e-9;
        let within = |v: f64, [low, high]: [f64; 2]| v >= low - ROUNDING && v <= high + ROUNDING;
        within(tool.x, self.x) && within(tool.y, self.y) && within(tool.z, self.z)
    }

    /// Whether a path of this extent stays within it, except for the small distance beyond it at which a switch is
    /// pressed.
    #[must_use]
    pub fn bears(&self, path: &Self) -> bool {
        /// Largest distance beyond the reach, in mm, at which a switch is met.
        const BEYOND_MM: f64 = 2.0;
        let within =
            |[low, high]: [f64; 2], [least, most]: [f64; 2]| low >= least - BEYOND_MM && high <= most + BEYOND_MM;
        within(path.x, self.x) && within(path.y, self.y)
    }

    /// A place at half its height.
    #[must_use]
    pub const fn at(&self, x: f64, y: f64) -> Place {
        Place { x, y, z: self.centre().z }
    }

    /// A place of G-code; its z counts where belts lift the tool.
    #[must_use]
    pub fn of_gcode(&self, [x, y, z]: [f64; 3]) -> Place {
        let Place { x: left, y: front, z: bottom } = self.origin();
        let lifts = self.z[1] > self.z[0];
        Place { x: left + x, y: front + y, z: if lifts { bottom + z } else { 0.0 } }
    }

    /// Its lowest, middle and highest place along z; 0 alone where no belts lift the tool.
    #[must_use]
    pub fn heights(&self) -> Vec<f64> {
        if self.z[1] > self.z[0] { points(self.z, 3) } else { vec![0.0] }
    }

    /// Places at this many columns and rows of each height, up to its ends.
    #[must_use]
    pub fn grid(&self, columns: usize, rows: usize) -> Vec<Place> {
        let (xs, ys) = (points(self.x, columns), points(self.y, rows));
        let at = |z: f64| ys.iter().flat_map(|y| xs.iter().map(|x| [*x, *y])).map(move |[x, y]| Place { x, y, z });
        self.heights().into_iter().flat_map(at).collect()
    }

    /// G-code's X0 Y0.
    #[must_use]
    pub const fn origin(&self) -> Place {
        Place { x: self.x[0], y: self.y[0], z: self.z[0] }
    }

    /// The middle.
    #[must_use]
    pub const fn centre(&self) -> Place {
        Place { x: (self.x[0] + self.x[1]) / 2.0, y: (self.y[0] + self.y[1]) / 2.0, z: (self.z[0] + self.z[1]) / 2.0 }
    }
}

/// Evenly from one end to the other.
#[must_use]
pub fn points([low, high]: [f64; 2], count: usize) -> Vec<f64> {
    match count {
        0 | 1 => vec![(low + high) / 2.0],
        _ => (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect(),
    }
}

/// The reach of a machine; empty (first bounds above second ones) if its pulleys have no room.
#[must_use]
pub fn workspace(machine: Machine, params: &Params) -> Workspace {
    let [x, y, z] = [params.width_mm, params.depth_mm, params.height_mm].map(|length| length / 2.0);
    let middle = if machine.lifts() { Place { x, y, z } } else { Place::flat(x, y) };
    let stops = machine.stops();
    let segments = layout(machine, params, middle).segments;
    if !runs_as_drawn(machine, params, &segments) {
        return Workspace { x: [x, 0.0], y: [y, 0.0], z: [0.0; 2] };
    }
    let mut reach = [[f64::NEG_INFINITY, f64::INFINITY]; 3];
    for segment in segments {
        let (Some(from), Some(to)) = (stops.get(segment.from), stops.get(segment.to)) else { continue };
        if segment.length_mm.is_nan() || segment.length_mm <= 0.0 && machine.lifts() {
            return Workspace { x: [x, 0.0], y: [y, 0.0], z: [0.0; 2] };
        }
        for (axis, ((range, at), along)) in reach.iter_mut().zip(middle.xyz()).zip(segment.along()).enumerate() {
            // Growth of the segment per millimetre of the tool.
            narrow(range, at, along * (to.follows(axis) - from.follows(axis)), segment.length_mm);
        }
    }
    let [x, y, z] = reach;
    Workspace { x, y, z: if machine.lifts() { z } else { [0.0; 2] } }
}

/// Whether every segment runs the way that it does in a frame with much room: between pulleys that have passed each
/// other it runs back, and seems to have a length.
fn runs_as_drawn(machine: Machine, params: &Params, segments: &[Segment]) -> bool {
    let room = 2.0 * (params.head_pulleys_mm + params.bar_pulleys_mm + 16.0 * params.pulley_radius_mm);
    let [width_mm, depth_mm, height_mm] = [params.width_mm, params.depth_mm, params.height_mm].map(|side| side + room);
    let [x, y, z] = [width_mm, depth_mm, height_mm].map(|side| side / 2.0);
    let middle = if machine.lifts() { Place { x, y, z } } else { Place::flat(x, y) };
    let wide = layout(machine, &Params { width_mm, depth_mm, height_mm, ..params.clone() }, middle).segments;
    let is_alike = |(segment, drawn): (&Segment, &Segment)| {
        let along: f64 = segment.along().iter().zip(drawn.along()).map(|(a, b)| a * b).sum();
        along > 0.0
    };
    segments.iter().zip(&wide).all(is_alike)
}

/// Ends a range where a segment with this growth per millimetre has no length left.
fn narrow(range: &mut [f64; 2], at: f64, grows: f64, length: f64) {
    if grows.abs() < 0.5 {
        return;
    }
    let end = at - length / grows;
    if grows > 0.0 {
        range[0] = range[0].max(end);
    } else {
        range[1] = range[1].min(end);
    }
}
