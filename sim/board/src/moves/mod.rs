//! Moves: every move as it was made, with the line of the file that it comes from.
//!
//! ```text
//! host: a line ──▶ Console: plans moves ──▶ MoveQueue ──▶ generator ──▶ Stepper
//!   program             expected              queued        running     sink
//! ```
//!
//! The simulator sees four things of the firmware: the count of planned moves, what is queued for the generator, which
//! of it is under way since when, and the motion time. The line that was sent last has caused what is planned until the
//! next one is sent, because a line is answered when its moves are planned. Moves leave the look-ahead in the order in
//! which they were planned, unless they are dropped; a new position in the queue tells this.

mod limit;
mod observer;
mod program;
mod rules;
mod tap;
mod trapezoid;

pub use limit::Limit;
pub(crate) use tap::Tap;

use corehbot::motion::Taps;
use corehbot_twin::math::hypot;

/// Why a move was planned.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Source {
    /// The line of the file, from 1; 0 if no line caused it.
    pub line: u32,
    /// Its type for the slicer, an index into [`types`](crate::slicer::Notes::types).
    pub kind: u16,
    /// The commanded speed with the feed override in mm/s, if the line commands one.
    pub feed: Option<f64>,
    /// Which rules were in force, in the order in which they came up.
    pub rules: u16,
}

/// A move as it was made.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MadeMove {
    /// Why it was planned.
    pub source: Source,
    /// When it begins, in ticks of motion time.
    pub begin: u64,
    /// How long it accelerates, cruises and decelerates, in ticks.
    pub phases: [u64; 3],
    /// Speed at its begin, in its cruise and at its end, in mm/s: of the tool, or of the filament if the tool stands.
    pub speeds: [f64; 3],
    /// Where it begins: x, y, z in mm.
    pub from: [f64; 3],
    /// Its way in x, y, z and filament, in mm.
    pub way: [f64; 4],
    /// Whether the firmware gave the place another name before it, or it does not begin where the one before ended.
    pub is_apart: bool,
    /// Whether an endstop or the probe may end it.
    pub is_watched: bool,
    /// Length of its path in mm, of the filament if the tool stands.
    pub length: f64,
    /// Acceleration of its ramps in mm/s2.
    pub acceleration: f64,
    /// The part of its length that it cruises.
    pub cruise: f64,
    /// Moves in the look-ahead when it left.
    pub ahead: u32,
    /// Whether z follows a mesh.
    pub is_on_mesh: bool,
    /// Whether the stream of commands was dry after it.
    pub is_dry: bool,
    /// What keeps it from being faster.
    pub limit: Limit,
}

/// From now on an axis follows its moves through another shaper. It rests, and no copy of an earlier move is still to
/// come.
#[derive(Clone, PartialEq, Debug)]
pub struct ShaperChange {
    /// When, in ticks of motion time.
    pub tick: u64,
    /// 0 is x, 1 is y.
    pub axis: usize,
    /// The copies of the motion of which the axis makes the sum.
    pub taps: Taps,
}

impl MadeMove {
    /// When it ends, in ticks.
    #[must_use]
    pub const fn end(&self) -> u64 {
        let [a, b, c] = self.phases;
        self.begin + a + b + c
    }

    /// Its length in the bed plane, in mm.
    #[must_use]
    pub fn plane_length(&self) -> f64 {
        hypot(self.way[0], self.way[1])
    }

    /// Whether it gets faster all along.
    const fn only_accelerates(&self) -> bool {
        self.phases[1] == 0 && self.phases[2] == 0
    }

    /// Whether it gets slower all along.
    const fn only_decelerates(&self) -> bool {
        self.phases[0] == 0 && self.phases[1] == 0
    }

    /// Whether it lays filament.
    #[must_use]
    pub fn is_printing(&self) -> bool {
        self.way[3] > 0.0 && self.plane_length() > 0.0
    }
}
