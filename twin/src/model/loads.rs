//! Loads: the effect of tensions on frame, bar and head (the paper's equations 26, 27 and 33 to 38).
//!
//! A segment pulls the stop that it leaves forward and the one that it reaches back, both along itself. A pulley passes
//! this on to its block. On an idler the two pulls have no moment about the axis.

use crate::geometry::Layout;
use crate::routing::{Block, Machine, Place};

/// A force in N and a couple in N mm about a place, counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// To the right.
    pub x_n: f64,
    /// Away from the front.
    pub y_n: f64,
    /// About the given place.
    pub couple_n_mm: f64,
}

/// Load of the belt on a block, about a place, for a tension of every segment.
#[must_use]
pub fn load(machine: Machine, layout: &Layout, tensions_n: &[f64], block: Block, about: Place) -> Load {
    let stops = machine.stops();
    let mut load = Load::default();
    for (segment, tension) in layout.segments.iter().zip(tensions_n) {
        for (stop, pull) in [(segment.from, *tension), (segment.to, -tension)] {
            if stops.get(stop).is_none_or(|stop| stop.block() != block) {
                continue;
            }
            let [x, y] = segment.heading.map(|along| along * pull);
            load.x_n += x;
            load.y_n += y;
            // Any point of the segment's line will do.
            load.couple_n_mm += (segment.begin[0] - about.x) * y - (segment.begin[1] - about.y) * x;
        }
    }
    load
}
