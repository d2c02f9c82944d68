//! Memory: the data shared by the handles.

use crate::kinematics::Groupings;
use crate::machine::HostMemory;
use crate::motion::{MoveMemory, MoveQueue, SpanMemory, StepQueue};
use crate::status::Status;
use crate::thermal::OrderQueue;

/// All memory that the handles share, 40 KiB; the Console and the StepGenerator themselves come on top.
pub struct Memory {
    /// Console to StepGenerator: moves that left the look-ahead, 3.4 KiB.
    pub(super) moves: MoveQueue,
    /// StepGenerator to Stepper: step events, 4 KiB.
    pub(super) events: StepQueue,
    /// The StepGenerator's: the trajectory as far back as shapers reach, 8 KiB.
    pub(super) spans: SpanMemory,
    /// The Console's: the look-ahead, 15 KiB.
    pub(super) planned: MoveMemory,
    /// The Console's: received bytes and pending replies of its hosts, 8.4 KiB.
    pub(super) hosts: HostMemory,
    /// Console to ThermalControl, 0.7 KiB.
    pub(super) orders: OrderQueue,
    pub(super) groupings: Groupings,
    pub(super) status: Status,
}

// As much as the fields' comments say, on a computer of 64 bits; on a board some are smaller.
const _: () = assert!(size_of::<MoveQueue>() <= 3448);
// This one is of as many bytes everywhere. Another length changes the comments of its field and of `Memory`, and the
// budget of RAM in xtask/src/build/contents.rs.
const _: () = assert!(size_of::<StepQueue>() == 4100);
const _: () = assert!(size_of::<SpanMemory>() <= 8 * 1024 && size_of::<MoveMemory>() <= 15 * 1024);

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

impl Memory {
    /// Empty queues.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            moves: MoveQueue::new(),
            events: StepQueue::new(),
            spans: SpanMemory::new(),
            planned: MoveMemory::new(),
            hosts: HostMemory::new(),
            orders: OrderQueue::new(),
            groupings: Groupings::NONE,
            status: Status::new(),
        }
    }
}
