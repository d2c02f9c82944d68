//! Motion: from targets to step events, on time.
//!
//! ```text
//!  Console (thread)                  | generator (interrupt, low)          | Stepper (interrupt, high)
//!  Target -> planner -> Move, Work ==|= MoveQueue => stepgen -> trajectory |
//!                                    |               stepgen -> step event ==|= StepQueue => stepper -> pins
//!                Link <==============|==================== Status <========|
//! ```
//!
//! The [`Planner`] looks ahead and releases moves with final speeds. The [`StepGenerator`] turns released moves into
//! step events, and the [`Stepper`] plays these on the pins. Two queues connect the three. Each end of a queue has one
//! owner, so there are no locks.
//!
//! # Contexts
//!
//! | folder or file | job | context |
//! |---|---|---|
//! | `planner/` | targets to moves with speeds | Console |
//! | `link` | puts work into the MoveQueue, brakes, aborts | Console |
//! | `trajectory/` | shaped position of each axis over time | generator; `shaper` makes taps in the Console |
//! | `stepgen/` | moves to step events | generator |
//! | `queue/` | the StepQueue | generator writes, Stepper reads |
//! | `stepper` | step events to pins | Stepper |
//! | `step_counts` | steps that each group has made | Console |
//! | `moves`, `work` | entries of the MoveQueue | Console writes, generator reads |
//! | `surface` | the shape of the bed, in steps | any |
//! | `sweep` | the motion of a resonance test | any |
//! | `ramps`, `ticks`, `number`, `z_limits` | formulas, comparisons, numbers, half of z's limits | any |
//!
//! # Words
//!
//! - **move**: a straight piece of path with a trapezoid of speed. **phase**: a part of a move in which the speed
//!   rises, holds or falls. **span**: a piece of the trajectory, which is a phase or a part of a long one (M122 calls
//!   it so).
//! - **group**: motors that always step together; it has one count of steps. **piece**: a time in which a group's
//!   position is a quadratic.
//! - **step event**: all groups that step in one tick. **epoch**: the work queued between two aborts.
//! - **work**: an order of the Console to the generator: a move, a dwell, other taps. **entry**: work in the MoveQueue,
//!   with its epoch. An entry speed, in contrast, is the speed at which a move begins.
//! - **to lay**: to add a move's phases to the trajectory. **to release**: to let a move leave the look-ahead for good.
//! - **covered**: the distance travelled along a path so far. **following**: later on the path, or in time.
//!
//! # Suffixes
//!
//! Where numbers are handed on, types in [`units`](crate::units) give their meaning. Elsewhere names do: `_sq` is a
//! square of a speed, `_tick` a whole tick of 0.1 us that wraps, `_time` a time in ticks times 2^16. A `fraction`,
//! `part` or `share` of type `u32` is scaled by [`WHOLE`]. A `length` of type `f32` is in mm. Formulas use v and u for
//! speeds, a for accelerations, t and T for times, L and d for lengths, and w for the square of a speed.

mod link;
mod moves;
mod number;
mod planner;
mod queue;
mod ramps;
mod step_counts;
mod stepgen;
mod stepper;
mod surface;
mod sweep;
mod ticks;
mod trajectory;
mod work;
mod z_limits;

// The atomics of the queue under a name that a test can replace by its own memory.
use core::sync::atomic;

pub use link::{Link, QueueObserver};
pub use moves::{Move, WHOLE};
pub(crate) use number::{from_f32, root, to_f32};
pub use planner::{LOOKAHEAD_MOVES, MoveMemory, Planner, Target, WHOLE_SHARE};
pub use queue::{LONGEST_INTERVAL, StepEvent, StepQueue, StepsIn, StepsOut};
pub use step_counts::StepCounts;
pub use stepgen::StepGenerator;
pub use stepper::Stepper;
pub use surface::SurfaceFrame;
pub use sweep::{Motion as SweepMotion, Piece, Pieces, Sweep};
pub use ticks::MIN_STEP_INTERVAL;
pub(crate) use trajectory::AXES;
#[cfg(test)]
pub(crate) use trajectory::impulses;
pub use trajectory::{SpanMemory, Stiffening, TAPS, Tap, Taps, advance_window, stiffenings, taps};
pub use work::{Entry, Work, surface_work};
pub use z_limits::ZLimits;

/// Released moves between Console and StepGenerator. Full: the Console waits. Empty: the generator waits, and motion
/// comes to rest.
pub type MoveQueue = heapless::spsc::Queue<Entry, 33>;
