//! Motion: from targets to step events, on time.
//!
//! The [`Planner`] looks ahead and releases moves whose speeds can no longer change; the [`StepGenerator`]
//! turns released moves into step events; the [`Stepper`] plays these on the pins. Two queues stand
//! between the three, and each end of a queue has one owner, so nothing is locked.

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
mod planner;
mod profile;
mod queue;
mod shaper;
mod stepgen;
mod stepper;
mod track;
mod trajectory;
mod trend;
mod turn;
mod window;

pub use event::{LONGEST_INTERVAL, StepEvent};
pub use link::Link;
pub use moves::{Entry, Move, WHOLE, Work};
pub use overrides::WHOLE_SHARE;
pub use planner::{Planner, Target};
pub use profile::{Speeds, profile};
pub use queue::{StepQueue, StepsIn, StepsOut};
pub use shaper::{stiffenings, taps};
pub use stepgen::StepGenerator;
pub use stepper::Stepper;
pub use track::MIN_STEP_INTERVAL;
pub use trajectory::{SpanMemory, Stiffening, TAPS, Tap, Taps};
pub use window::{MoveMemory, WINDOW};

/// Released moves between Console and StepGenerator. Full: the Console waits. Empty: motion rests.
pub type MoveQueue = heapless::spsc::Queue<Entry, 33>;
