//! A step event: all motors that step in one instant. Tests and benchmarks use this type. The generator and the Stepper
//! use a [`PackedEvent`](super::PackedEvent) and an interval.

use crate::motion::ticks::NEAR;
use crate::port::{EndstopSet, GroupSet};

/// One entry of the StepQueue.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StepEvent {
    /// Ticks since the previous event, in motion time; at most [`LONGEST_INTERVAL`].
    pub interval: u32,
    /// The groups of motors that step; none in an event that only lets time pass.
    pub steps: GroupSet,
    /// The groups with a growing coordinate, from this event on.
    pub forward: GroupSet,
    /// Epoch in which the event was made. The Stepper discards events of other epochs.
    pub epoch: u8,
    /// Endstops that end the motion if any of them is pressed.
    pub watch: EndstopSet,
}

/// Longest time between two events: a third of the range of [`Tick::is_before`](crate::units::Tick::is_before). Events
/// without steps divide longer pauses.
pub const LONGEST_INTERVAL: u32 = 1 << 30;
// The generator lets time pass in events of this length.
const _: () = assert!(NEAR <= LONGEST_INTERVAL);

const _: () = assert!(core::mem::size_of::<StepEvent>() == 8);
