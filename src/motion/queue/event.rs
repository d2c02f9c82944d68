//! A step event: all the motors that step in one instant. Tests and benchmarks put such events in and take them out; the
//! generator and the Stepper know them as a [`PackedEvent`](super::PackedEvent) and an interval.

use crate::motion::ticks::NEAR;
use crate::port::{EndstopSet, GroupSet};

/// One entry of the StepQueue.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StepEvent {
    /// Ticks since the event before, in motion time; at most [`LONGEST_INTERVAL`].
    pub interval: u32,
    /// The groups of motors that step; none in an event that only lets time pass.
    pub steps: GroupSet,
    /// The groups whose coordinate grows with a step, from here on.
    pub forward: GroupSet,
    /// The epoch in which the event was made; an event of another epoch is discarded.
    pub epoch: u8,
    /// Endstops that end the motion if any of them is pressed.
    pub watch: EndstopSet,
}

/// Longest time between two events: a third of what [`Tick::is_before`](crate::units::Tick::is_before)
/// can tell apart. Longer pauses are cut by events without steps.
pub const LONGEST_INTERVAL: u32 = 1 << 30;
// The generator lets time pass in events of this length.
const _: () = assert!(NEAR <= LONGEST_INTERVAL);

const _: () = assert!(core::mem::size_of::<StepEvent>() == 8);
