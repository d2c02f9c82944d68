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
mod step_counts;
mod stepgen;
mod stepper;
mod trajectory;

// The queue's, by a name that a test can give to a memory of its own.
use core::sync::atomic;

pub use link::Link;
pub use moves::{Entry, Move, WHOLE, Work};
pub use planner::{MoveMemory, Planner, Target, WHOLE_SHARE, WINDOW};
pub use queue::{LONGEST_INTERVAL, StepEvent, StepQueue, StepsIn, StepsOut};
pub use step_counts::StepCounts;
pub use stepgen::{MIN_STEP_INTERVAL, StepGenerator};
pub use stepper::Stepper;
pub use trajectory::{SpanMemory, Stiffening, TAPS, Tap, Taps, stiffenings, taps};

/// Released moves between Console and StepGenerator. Full: the Console waits. Empty: motion rests.
pub type MoveQueue = heapless::spsc::Queue<Entry, 33>;
