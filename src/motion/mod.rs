//! Motion: from targets to step events, on time.
//!
//! The [`Planner`] looks ahead and releases moves whose speeds can no longer change; the [`StepGenerator`]
//! turns released moves into step events; the [`Stepper`] plays these on the pins. Two queues stand
//! between the three, and each end of a queue has one owner, so nothing is locked.

mod link;
mod moves;
mod number;
mod planner;
mod queue;
mod ramps;
mod step_counts;
mod stepgen;
mod stepper;
mod ticks;
mod trajectory;
mod work;

// The queue's, by a name that a test can give to a memory of its own.
use core::sync::atomic;

pub use link::Link;
pub use moves::{Move, WHOLE};
pub use planner::{MoveMemory, Planner, Target, WHOLE_SHARE, WINDOW};
pub use queue::{LONGEST_INTERVAL, StepEvent, StepQueue, StepsIn, StepsOut};
pub use step_counts::StepCounts;
pub use stepgen::StepGenerator;
pub use stepper::Stepper;
pub use ticks::MIN_STEP_INTERVAL;
pub use trajectory::{SpanMemory, Stiffening, TAPS, Tap, Taps, stiffenings, taps};
pub use work::{Entry, Work};

/// Released moves between Console and StepGenerator. Full: the Console waits. Empty: motion rests.
pub type MoveQueue = heapless::spsc::Queue<Entry, 33>;
