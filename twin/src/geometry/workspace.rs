//! Workspace: the places of the tool where every segment has a positive length (the condition of the paper's equation
//! 20).
//!
//! On these machines every segment is along x or y and its length is linear in the tool's x or y. So the reach along
//! each axis ends where the first segment has no length left.

use super::layout;
use crate::params::Params;
use crate::routing::{Block, Machine, Place, Stop};

/// A rectangle of tool places, in mm from motor 1's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workspace {
    /// Leftmost and rightmost.
    pub x: [f64; 2],
    /// Foremost and backmost.
    pub y: [f64; 2],
}

impl std::fmt::Display for Workspace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([a, b], [c, d]) = (self.x, self.y);
        write!(f, "x {a:.1} to {b:.1}, y {c:.1} to {d:.1}")
    }
}

impl Workspace {
    /// Whether the tool can be there, up to rounding.
    #[must_use]
    pub fn has(&self, tool: Place) -> bool {
        const ROUNDING: f64 = 1e-9;
        let within = |v: f64, [low, high]: [f64; 2]| v >= low - ROUNDING && v <= high + ROUNDING;
        within(tool.x, self.x) && within(tool.y, self.y)
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

    /// G-code's X0 Y0.
    #[must_use]
    pub const fn origin(&self) -> Place {
        Place { x: self.x[0], y: self.y[0] }
    }

    /// The middle.
    #[must_use]
    pub const fn centre(&self) -> Place {
        Place { x: (self.x[0] + self.x[1]) / 2.0, y: (self.y[0] + self.y[1]) / 2.0 }
    }
}

/// The reach of a machine; empty (first bounds above second ones) if its pulleys have no room.
#[must_use]
pub fn workspace(machine: Machine, params: &Params) -> Workspace {
    let middle = Place { x: params.width_mm / 2.0, y: params.depth_mm / 2.0 };
    let stops: Vec<&Stop> = machine.stops().collect();
    let mut reach = Workspace { x: [f64::NEG_INFINITY, f64::INFINITY], y: [f64::NEG_INFINITY, f64::INFINITY] };
    for segment in layout(machine, params, middle).segments {
        let (Some(from), Some(to)) = (stops.get(segment.from), stops.get(segment.to)) else { continue };
        if segment.length_mm.is_nan() {
            return Workspace { x: [middle.x, 0.0], y: [middle.y, 0.0] };
        }
        let [along_x, along_y] = segment.heading;
        // Growth of the segment per millimetre of the tool.
        let grows_x = along_x * (follows_x(to) - follows_x(from));
        let grows_y = along_y * (follows_y(to) - follows_y(from));
        narrow(&mut reach.x, middle.x, grows_x, segment.length_mm);
        narrow(&mut reach.y, middle.y, grows_y, segment.length_mm);
    }
    reach
}

/// Motion of a stop in x per millimetre of the tool.
pub(crate) fn follows_x(stop: &Stop) -> f64 {
    f64::from(u8::from(stop.block() == Block::Head))
}

/// Motion of a stop in y per millimetre of the tool.
pub(crate) fn follows_y(stop: &Stop) -> f64 {
    f64::from(u8::from(stop.block() != Block::Frame))
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
