//! Upright: a belt in space, which runs along the axes from corner to corner of its line.
//!
//! A pulley rounds a right angle off: each of the two lines ends a radius before the corner, and a quarter of a turn
//! lies on the pulley. Where the belt comes back the way it went, the corner is the pulley's axis, and both lines are
//! as long as they look.

use super::segment::{Segment, Wrap};
use crate::params::Params;
use crate::routing::{Belt, Place, Stop};
use std::f64::consts::{FRAC_PI_2, PI};

/// The cosine of the turn between two lines beyond which the belt comes back.
const BACK: f64 = -0.5;

/// Segments and wraps of an open belt. Its first stop has the index `first` in the machine.
pub(super) fn lay(belt: &Belt, first: usize, params: &Params, tool: Place) -> (Vec<Segment>, Vec<Wrap>) {
    // Where the tool is at the end of its reach, the line has no length; its direction is as in the middle.
    let middle = Place::of_xyz([params.width_mm, params.depth_mm, params.height_mm].map(|length| length / 2.0));
    let pairs = || belt.stops.iter().zip(belt.stops.iter().skip(1)).enumerate();
    let headings: Vec<[f64; 3]> =
        pairs().map(|(_, (a, b))| heading(place(a, params, middle), place(b, params, middle))).collect();
    let mut wraps = Vec::new();
    // What the pulley at each stop takes from the lines on both sides.
    let mut cuts = vec![0.0; belt.stops.len()];
    for ((index, pair), cut) in (1..).zip(headings.windows(2)).zip(cuts.iter_mut().skip(1)) {
        let [into, out] = pair else { continue };
        let comes_back = into.iter().zip(out).map(|(a, b)| a * b).sum::<f64>() < BACK;
        *cut = if comes_back { 0.0 } else { params.pulley_radius_mm };
        wraps.push(Wrap { stop: first + index, angle_rad: if comes_back { PI } else { FRAC_PI_2 } });
    }
    let segment = |((index, (a, b)), along): ((usize, (&Stop, &Stop)), &[f64; 3])| {
        let (a, b) = (place(a, params, tool), place(b, params, tool));
        let apart: f64 = along.iter().zip(a.iter().zip(b)).map(|(along, (a, b))| along * (b - a)).sum();
        let taken: f64 = cuts.iter().skip(index).take(2).sum();
        let [x, y, rise] = *along;
        Segment {
            from: first + index,
            to: first + index + 1,
            begin: [a[0], a[1]],
            heading: [x, y],
            rise,
            length_mm: apart - taken,
        }
    };
    (pairs().zip(&headings).map(segment).collect(), wraps)
}

fn place(stop: &Stop, params: &Params, tool: Place) -> [f64; 3] {
    let [x, y] = stop.centre(params, tool);
    [x, y, stop.height(params, tool)]
}

/// The direction from one place to another, of length 1.
fn heading(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let apart = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let length = apart.iter().map(|v| v * v).sum::<f64>().sqrt();
    apart.map(|v| v / length)
}
