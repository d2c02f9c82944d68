//! Segment: the common tangent of two circles, each on the side where the belt passes, and the arc between two of them.

use crate::math::{atan2, hypot};
use crate::params::Params;
use crate::routing::{Place, Stop};
use std::f64::consts::TAU;

/// A straight part of the belt between two stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Index of the stop that it leaves, among all stops of the machine.
    pub from: usize,
    /// Index of the stop that it reaches.
    pub to: usize,
    /// Place where it leaves the first stop, in mm.
    pub begin: [f64; 2],
    /// The direction of travel in x and y; with the rise it has length 1.
    pub heading: [f64; 2],
    /// The direction of travel in z.
    pub rise: f64,
    /// Free length in mm; NaN where the stops overlap so far that there is no such line.
    pub length_mm: f64,
}

impl Segment {
    /// The direction of travel along x, y and z.
    #[must_use]
    pub const fn along(&self) -> [f64; 3] {
        [self.heading[0], self.heading[1], self.rise]
    }
}

/// The part of the belt that lies on a pulley.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrap {
    /// Index of the pulley among all stops of the machine.
    pub stop: usize,
    /// Angle by which the belt turns on it, in rad.
    pub angle_rad: f64,
}

/// A smaller arc is only rounding between two lines in one direction.
const NO_ARC: f64 = 1e-9;

/// Stops nearer to each other than this are at one place.
const SAME_PLACE_MM: f64 = 1e-6;

/// Rounding error of a square, relative.
const ROUNDING: f64 = 1e-12;

/// The line from one stop to the next.
///
/// On a stop with sign s the belt touches at s r n, where n is the heading turned right. With d from centre to centre
/// as a complex number, d = (L + i (s2 - s1) r) heading, since n = -i heading.
pub(super) fn between(from: (usize, &Stop), to: (usize, &Stop), params: &Params, tool: Place) -> Segment {
    let radius = params.pulley_radius_mm;
    let across = (to.1.sign() - from.1.sign()) * radius;
    let apart = |tool| {
        let (a, b) = (from.1.centre(params, tool), to.1.centre(params, tool));
        [b[0] - a[0], b[1] - a[1]]
    };
    let (a, [dx, dy]) = (from.1.centre(params, tool), apart(tool));
    if hypot(dx, dy) < SAME_PLACE_MM && across == 0.0 {
        // At the end of the reach one pulley lies above the other; the belt keeps its direction.
        let [dx, dy] = apart(Place::flat(params.width_mm / 2.0, params.depth_mm / 2.0));
        let heading = [dx / hypot(dx, dy), dy / hypot(dx, dy)];
        let offset = from.1.sign() * radius;
        let begin = [a[0] + offset * heading[1], a[1] - offset * heading[0]];
        return Segment { from: from.0, to: to.0, begin, heading, rise: 0.0, length_mm: 0.0 };
    }
    let square = dx * dx + dy * dy;
    // Rounding must not make the square of a segment at its very end negative.
    let left = square - across * across;
    let length_mm = if left.abs() < ROUNDING * square { 0.0 } else { left.sqrt() };
    let heading = [(dx * length_mm + dy * across) / square, (dy * length_mm - dx * across) / square];
    let offset = from.1.sign() * radius;
    let begin = [a[0] + offset * heading[1], a[1] - offset * heading[0]];
    Segment { from: from.0, to: to.0, begin, heading, rise: 0.0, length_mm }
}

/// The arc between two segments on a pulley of this sign.
pub(super) fn wrap(into: &Segment, out: &Segment, sign: f64) -> Wrap {
    let turned = atan2(out.heading[1], out.heading[0]) - atan2(into.heading[1], into.heading[0]);
    let angle = (sign * turned).rem_euclid(TAU);
    Wrap { stop: into.to, angle_rad: if TAU - angle < NO_ARC { 0.0 } else { angle } }
}
