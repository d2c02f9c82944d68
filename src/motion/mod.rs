//! Motion: from targets to step events, on time.
//!
//! The [`Planner`] looks ahead and releases moves whose speeds can no longer change; the [`StepGenerator`]
//! turns released moves into step events; the [`Stepper`] plays these on the pins. Two queues stand
//! between the three, and each end of a queue has one owner, so nothing is locked.

mod ahead;
mod course;
mod crossing;
mod event;
mod geometry;
mod junction;
mod link;
mod moves;
mod number;
mod overrides;
mod phase;
mod pitch;
mod planned;
mod planner;
mod profile;
mod queue;
mod rounds;
mod shaper;
mod step_counts;
mod stepgen;
mod stepper;
mod track;
mod trajectory;
mod trend;
mod window;

// The queue's, by a name that a test can give to a memory of its own.
use core::sync::atomic;

pub use event::{LONGEST_INTERVAL, StepEvent};
pub use link::Link;
pub use moves::{Entry, Move, WHOLE, Work};
pub use overrides::WHOLE_SHARE;
pub use planned::{MoveMemory, WINDOW};
pub use planner::{Planner, Target};
pub use queue::{StepQueue, StepsIn, StepsOut};
pub use shaper::{stiffenings, taps};
pub use step_counts::StepCounts;
pub use stepgen::StepGenerator;
pub use stepper::Stepper;
pub use track::MIN_STEP_INTERVAL;
pub use trajectory::{SpanMemory, Stiffening, TAPS, Tap, Taps};

/// Released moves between Console and StepGenerator. Full: the Console waits. Empty: motion rests.
pub type MoveQueue = heapless::spsc::Queue<Entry, 33>;
