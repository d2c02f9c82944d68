//! Motion: from targets to step events, on time.
//!
//! ```text
//!  Console (thread)                  | generator (interrupt, low)          | Stepper (interrupt, high)
//!  Target -> planner -> Move, Work ==|= MoveQueue => stepgen -> trajectory |
//!                                    |               stepgen -> step event ==|= StepQueue => stepper -> pins
//!                Link <==============|==================== Status <========|
//! ```
//!
//! The [`Planner`] looks ahead and releases moves whose speeds can no longer change; the [`StepGenerator`]
//! turns released moves into step events; the [`Stepper`] plays these on the pins. Two queues stand
//! between the three, and each end of a queue has one owner, so nothing is locked.
//!
//! # Who runs it
//!
//! | folder or file | job | context |
//! |---|---|---|
//! | `planner/` | targets to moves with speeds | Console |
//! | `link` | puts work into the MoveQueue, brakes, aborts | Console |
//! | `trajectory/` | where each axis is at each time, shaped | generator; `shaper` makes taps of settings in the Console |
//! | `stepgen/` | moves to step events | generator |
//! | `queue/` | the StepQueue | generator writes, Stepper reads |
//! | `stepper` | step events to pins | Stepper |
//! | `step_counts` | what each group has really stepped | Console |
//! | `moves`, `work` | what stands in the MoveQueue | Console writes, generator reads |
//! | `ramps`, `ticks`, `number` | formulas, comparisons, numbers | whoever calls |
//!
//! # Words
//!
//! - **move**: a straight piece of path with a trapezoid of speed. **phase**: a part of a move in which the speed rises, holds
//!   or falls. **span**: a piece of the trajectory, which is a phase or a part of a long one (M122 calls it so).
//! - **group**: motors that always step together; it has one count of steps. **piece**: a time in which a group's position is a
//!   quadratic.
//! - **step event**: all groups that step in one tick. **epoch**: what is queued between two aborts.
//! - **work**: what the Console asks of the generator: a move, a dwell, other taps. **entry**: work in the MoveQueue, with its
//!   epoch. (An entry speed is something else: how fast a move begins.)
//! - **to lay**: to add a move's phases to the trajectory. **to release**: to let a move leave the look-ahead for good.
//! - **covered**: how much of a path has been travelled so far. **following**: later on the path, or in time.
//!
//! # Suffixes
//!
//! Types in [`units`](crate::units) say what a number is where it is handed on. Elsewhere names do: `_sq` is a square of a
//! speed, `_tick` a whole tick of 0.1 us that wraps, `_time` a time in ticks times 2^16. A `fraction`, `part` or `share` that is
//! a `u32` is scaled by [`WHOLE`]. A `length` that is a `u64` has the bits of `Mm`; one that is an `f32` is in mm. Formulas
//! call speeds v and u, accelerations a, times t and T, lengths L and d; w is a square of a speed there.

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
pub use planner::{LOOKAHEAD_MOVES, MoveMemory, Planner, Target, WHOLE_SHARE};
pub use queue::{LONGEST_INTERVAL, StepEvent, StepQueue, StepsIn, StepsOut};
pub use step_counts::StepCounts;
pub use stepgen::StepGenerator;
pub use stepper::Stepper;
pub use ticks::MIN_STEP_INTERVAL;
pub use trajectory::{SpanMemory, Stiffening, TAPS, Tap, Taps, advance_window, stiffenings, taps};
pub use work::{Entry, Work};

/// Released moves between Console and StepGenerator. Full: the Console waits. Empty: the generator waits, and motion comes to
/// its end.
pub type MoveQueue = heapless::spsc::Queue<Entry, 33>;
