//! Status: the data that contexts share, apart from the moves and step events in the queues.
//!
//! Each field is an atomic with one writer, named in its comment; without a name it is the Console. Only `triggered`
//! has two writers: the Stepper sets it, and the Console clears it after it has begun another epoch and when Stepper
//! and generator are idle.
//!
//! Two counts that only grow show whether there is motion. One context counts the work that it began, the other the
//! work that it finished, and without motion the two are equal. This holds for any order of events.
//!
//! A reader gets copies of single fields. Two fields may come from different times; where that matters, the method
//! documents the order of its reads.

mod counted;
mod heat;
mod heat_figures;
mod known;
mod overload;
mod print_progress;
mod steps;
mod stopping;
mod stream;
mod z_offset_orders;

use crate::fault::Latch;
use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, AtomicU32};
use counted::Counted;
pub use heat::{Heat, SelfTest, Tuned, Tuning, TuningFailure};
pub use heat_figures::{HeatFigures, WITH_FIGURES};
pub use known::Known;
use overload::Lateness;
pub use overload::{Late, Overload};
use print_progress::PrintProgress;
use z_offset_orders::ZOffsetOrders;

/// The data that contexts share.
#[repr(C)]
pub struct Status {
    /// Work of another epoch is discarded; written by the Console.
    epoch: AtomicU8,
    /// Endstops that ended the motion of the current epoch; written by the Stepper, cleared with the epoch.
    triggered: AtomicU8,
    /// All endstop inputs as the Stepper last read them.
    endstops: AtomicU8,
    /// The existing endstops; written when the Stepper is made.
    inputs: AtomicU8,
    /// Groups with slow step lines; written when the Stepper is made.
    slow: AtomicU8,
    /// Due time of the last event, by the step timer; written by the Stepper.
    due: AtomicU32,
    /// Lag of motion time behind the step timer, in ticks; written by the Stepper.
    lag: AtomicU32,
    /// Entries of the MoveQueue finished; written by the StepGenerator.
    entries_done: AtomicU32,
    /// Events put into the StepQueue; written by the StepGenerator.
    events_made: AtomicU32,
    /// Events taken out of the StepQueue when motion last ended; written by the Stepper.
    rested: AtomicU32,
    /// How often the StepQueue ran dry in mid-motion; written by the StepGenerator.
    starved: AtomicU32,
    /// Late events that stretched time; written by the Stepper.
    late: Lateness,
    /// Stretched spans; written by the StepGenerator.
    squeezed: Lateness,
    /// Whether the Console only waits for the host.
    awaiting_input: AtomicBool,
    /// Whether a command waits for the user.
    awaiting_user: AtomicBool,
    /// Moves planned.
    moves: AtomicU32,
    /// Length of the path planned, in um, wrapping.
    path_um: AtomicU32,
    /// Moves planned that are slower than they would be on a flat bed.
    slowed_moves: AtomicU32,
    /// How often a slow host made the look-ahead release unfinished moves.
    underruns: AtomicU32,
    /// Moves planned and not begun, at the Console's last turn.
    level: AtomicU32,
    /// One more than the fewest moves in the look-ahead while the stream ran; 0 if it never ran. A status of
    /// zeros costs no flash.
    low_water: AtomicU32,
    /// Whether an emergency stop holds until M999 or a reset.
    halted: AtomicBool,
    /// The progress that the print's own lines report.
    pub(crate) print_progress: PrintProgress,
    /// One more than the epoch that shall brake along its path; 0 for none; written by the Console.
    brake: AtomicU32,
    /// One more than the epoch that has stopped; 0 for none; written by the StepGenerator.
    stopped: AtomicU32,
    /// Steps of the events put into the StepQueue; written by the StepGenerator.
    made: Counted,
    /// Endstop reads of the Stepper because it was pended; written by the Stepper.
    looks: AtomicU32,
    z_offset: ZOffsetOrders,
    /// What the Console knows of the place of the tool, in bits; whether the ends of axes do not hold; and an offset of
    /// z.
    known: AtomicU8,
    is_free: AtomicBool,
    below_um: AtomicI32,
    heat: Heat,
    fault: Latch,
}

impl Default for Status {
    fn default() -> Self {
        Self::new()
    }
}

impl Status {
    /// Everything at rest.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            epoch: AtomicU8::new(0),
            triggered: AtomicU8::new(0),
            endstops: AtomicU8::new(0),
            inputs: AtomicU8::new(0),
            slow: AtomicU8::new(0),
            due: AtomicU32::new(0),
            lag: AtomicU32::new(0),
            entries_done: AtomicU32::new(0),
            events_made: AtomicU32::new(0),
            rested: AtomicU32::new(0),
            starved: AtomicU32::new(0),
            late: Lateness::new(),
            squeezed: Lateness::new(),
            awaiting_input: AtomicBool::new(false),
            awaiting_user: AtomicBool::new(false),
            moves: AtomicU32::new(0),
            path_um: AtomicU32::new(0),
            slowed_moves: AtomicU32::new(0),
            underruns: AtomicU32::new(0),
            level: AtomicU32::new(0),
            low_water: AtomicU32::new(0),
            halted: AtomicBool::new(false),
            print_progress: PrintProgress::new(),
            brake: AtomicU32::new(0),
            stopped: AtomicU32::new(0),
            made: Counted::new(),
            looks: AtomicU32::new(0),
            z_offset: ZOffsetOrders::new(),
            known: AtomicU8::new(0),
            is_free: AtomicBool::new(false),
            below_um: AtomicI32::new(0),
            heat: Heat::new(),
            fault: Latch::new(),
        }
    }

    /// Heaters and fans.
    #[must_use]
    pub const fn heat(&self) -> &Heat {
        &self.heat
    }

    /// The live offset of z.
    #[must_use]
    pub const fn z_offset(&self) -> &ZOffsetOrders {
        &self.z_offset
    }

    /// The first fault since start; any context may set it.
    #[must_use]
    pub const fn fault(&self) -> &Latch {
        &self.fault
    }
}
