//! Packed event: all of a step event but its time, in a word of 32 bits.

use crate::motors::MOST_GROUPS;
use crate::port::{EndstopSet, GroupSet};

/// A bit for each group.
const GROUPS: u32 = (1 << MOST_GROUPS) - 1;

/// First bit of the groups that step, above four endstops, and first bit of the directions. A port with four words per
/// set of groups then needs one instruction less.
const STEPS_AT: usize = 4;
const FORWARD_AT: usize = STEPS_AT + MOST_GROUPS;
const _: () = assert!(FORWARD_AT + MOST_GROUPS <= 16 && EndstopSet::ALL.0 < 1 << STEPS_AT);

/// All of an event except its time: watched endstops in bits 0 to 3, then the groups, directions above steps, epoch
/// from bit 16 on, and flags.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::motion) struct PackedEvent(pub u32);

impl PackedEvent {
    /// No event, and not a plain one either.
    pub const NONE: Self = Self(1 << 27);
    /// Held by a Stepper without an event.
    pub const RESTING: Self = Self(1 << 26);
    /// It has more than steps in directions that are already set.
    pub const SPECIAL: u32 = 1 << 24;
    /// The generator must make more events.
    pub const REFILL: u32 = 1 << 25;

    /// Common bits of two consecutive plain events: directions, epoch, and that they are events.
    pub const SETTING: u32 = 0xFFFF_0000 | Self::FORWARD;

    pub const STEPS: u32 = GROUPS << STEPS_AT;
    const FORWARD: u32 = GROUPS << FORWARD_AT;
    const WATCH: u32 = (1 << STEPS_AT) - 1;

    /// An event of `epoch` that watches endstops, without steps.
    pub const fn waiting(epoch: u8, watch: EndstopSet) -> Self {
        Self(watch.0 as u32 & Self::WATCH | (epoch as u32) << 16)
    }

    /// An event made by [`waiting`](Self::waiting), with these steps and directions.
    pub const fn stepping(self, steps: GroupSet, forward: GroupSet) -> Self {
        let (steps, forward) = ((steps.0 as u32) << STEPS_AT, (forward.0 as u32) << FORWARD_AT);
        Self(self.0 | steps & Self::STEPS | forward & Self::FORWARD)
    }

    /// Bits that a step of a group adds to an event.
    #[inline(always)]
    pub const fn steps_of(group: usize) -> u32 {
        1 << (STEPS_AT + group)
    }

    /// Whether this is an event of `epoch` with nothing special about it.
    #[inline(always)]
    pub const fn is_plain(self, epoch: u8) -> bool {
        self.0 >> 16 == epoch as u32
    }

    /// Whether there are steps, none of them of `slow` groups, and no watched endstops.
    #[inline(always)]
    pub const fn has_only_steps(self, slow: GroupSet) -> bool {
        self.0 & Self::STEPS != 0 && self.0 & (slow.0 as u32) << STEPS_AT == 0 && !self.has_watch()
    }

    /// Whether endstops are to be watched.
    pub const fn has_watch(self) -> bool {
        self.0 & Self::WATCH != 0
    }

    /// Whether this is an event of `epoch` with steps in these directions and without endstops to be watched.
    #[inline(always)]
    pub const fn is_step_of(self, epoch: u8, forward: GroupSet) -> bool {
        let setting = (epoch as u32) << 16 | (forward.0 as u32) << FORWARD_AT;
        (self.0 ^ setting) & !(Self::STEPS | Self::SPECIAL | Self::REFILL) == 0 && self.0 & Self::STEPS != 0
    }

    /// The same, marked as special.
    pub const fn special(self) -> Self {
        Self(self.0 | Self::SPECIAL)
    }

    #[inline(always)]
    pub const fn steps(self) -> GroupSet {
        GroupSet((self.0 >> STEPS_AT & GROUPS) as u8)
    }

    pub const fn forward(self) -> GroupSet {
        GroupSet((self.0 >> FORWARD_AT & GROUPS) as u8)
    }

    /// Whether it has the directions of another event.
    pub const fn goes_as(self, other: Self) -> bool {
        (self.0 ^ other.0) & Self::FORWARD == 0
    }

    pub const fn watch(self) -> EndstopSet {
        EndstopSet((self.0 & Self::WATCH) as u8)
    }

    pub const fn epoch(self) -> u8 {
        (self.0 >> 16) as u8
    }

    /// Whether this is an event of `epoch`.
    pub const fn is_of(self, epoch: u16) -> bool {
        (self.0 & !(Self::SPECIAL | Self::REFILL)) >> 16 == epoch as u32
    }

    pub const fn wants_refill(self) -> bool {
        self.0 & Self::REFILL != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_one_of_its_epoch_in_its_directions_without_endstops() {
        let (steps, forward) = (GroupSet(0b101), GroupSet(0b1001));
        let event = PackedEvent::waiting(7, EndstopSet::NONE).stepping(steps, forward);
        assert_eq!((event.epoch(), event.steps(), event.forward()), (7, steps, forward));
        assert!(event.special().special() == event.special());
        assert!(event.is_step_of(7, forward) && event.special().is_step_of(7, forward));
        assert!(!event.is_step_of(6, forward) && !event.is_step_of(7, steps));
        assert!(!PackedEvent::waiting(7, EndstopSet(1)).stepping(steps, forward).is_step_of(7, forward));
        assert!(!PackedEvent::waiting(7, EndstopSet::NONE).stepping(GroupSet::NONE, forward).is_step_of(7, forward));
    }
}
