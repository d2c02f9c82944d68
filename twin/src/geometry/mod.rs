//! Geometry: the exact run of the belt for a place of the tool, from the routing alone.
//!
//! Between two stops the belt is the straight line tangent to both circles on the sides where it passes. On a pulley it
//! wraps from one such line to the next. Nothing here assumes lines along x or y; tests find that these machines have
//! them. A belt in space runs along the axes, from corner to corner of its line (`upright`). [`workspace()`] is the
//! resulting reach, over which [`greatest()`] finds the worst places.

mod greatest;
mod segment;
mod upright;
mod workspace;

pub use greatest::greatest;
pub use segment::{Segment, Wrap};
pub use workspace::{Workspace, points, workspace};

use crate::params::Params;
use crate::routing::{Belt, Machine, Place, Runs, Stop};
use segment::{between, wrap};

/// The belts of a machine with the tool at a place.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Straight segments, belt after belt in the direction of travel.
    pub segments: Vec<Segment>,
    /// Wraps on pulleys, in the same order.
    pub wraps: Vec<Wrap>,
    /// Length of each belt in mm, segments and wraps, and the belt outside.
    pub belt_lengths_mm: Vec<f64>,
}

/// Lays the belts of `machine` with the tool at `tool`.
#[must_use]
pub fn layout(machine: Machine, params: &Params, tool: Place) -> Layout {
    layout_of(&machine.belts(), params, tool)
}

/// Lays these belts with the tool at `tool`.
#[must_use]
pub fn layout_of(belts: &[Belt], params: &Params, tool: Place) -> Layout {
    let mut layout = Layout { segments: Vec::new(), wraps: Vec::new(), belt_lengths_mm: Vec::new() };
    let (mut first, mut span) = (0, 0);
    for belt in belts {
        let (segments, wraps) = match belt.runs {
            Runs::Flat => {
                let segments = lay(belt, first, params, tool);
                let wraps = wraps(belt, &segments);
                (segments, wraps)
            }
            Runs::Upright => upright::lay(belt, first, params, tool),
        };
        let outside: f64 = (span..span + belt.spans.len()).map(|span| params.outside_mm.of(span)).sum();
        span += belt.spans.len();
        let straight: f64 = segments.iter().map(|segment| segment.length_mm).sum();
        let wrapped: f64 = wraps.iter().map(|wrap| wrap.angle_rad * params.pulley_radius_mm).sum();
        layout.belt_lengths_mm.push(straight + wrapped + outside);
        layout.segments.extend(segments);
        layout.wraps.extend(wraps);
        first += belt.stops.len();
    }
    layout
}

/// The segments of one belt. Its first stop has the index `first` in the machine.
fn lay(belt: &Belt, first: usize, params: &Params, tool: Place) -> Vec<Segment> {
    let pairs = belt.stops.iter().zip(belt.stops.iter().skip(1)).enumerate();
    let mut segments: Vec<Segment> =
        pairs.map(|(i, (a, b))| between((first + i, a), (first + i + 1, b), params, tool)).collect();
    if let (true, [head, .., last]) = (belt.is_closed(), &*belt.stops) {
        segments.push(between((first + belt.stops.len() - 1, last), (first, head), params, tool));
    }
    segments
}

/// The wraps of one belt on the pulleys between its segments.
fn wraps(belt: &Belt, segments: &[Segment]) -> Vec<Wrap> {
    let stop_of = |segment: &Segment| -> Option<&Stop> {
        let first = segments.first()?.from;
        belt.stops.get(segment.to - first)
    };
    let next = segments.iter().cycle().skip(1);
    let pairs = segments.iter().zip(next).filter(|(a, b)| a.to == b.from);
    pairs.filter_map(|(a, b)| Some(wrap(a, b, stop_of(a)?.sign()))).collect()
}
