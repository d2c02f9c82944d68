//! Status of the steps: made, played, late, and at rest.

use super::{Overload, Status};
use crate::motors::{GroupSet, MOST_GROUPS};
use core::sync::atomic::{Ordering::Acquire, Ordering::Relaxed, Ordering::Release};

impl Status {
    /// Steps of all events put into the StepQueue and not taken back.
    pub(crate) fn steps_made(&self) -> [i32; MOST_GROUPS] {
        self.made.read()
    }

    /// Counts more steps of a group in the StepQueue. The StepGenerator is the only writer.
    #[inline(always)]
    pub(crate) fn add_steps_made(&self, group: usize, steps: i32) {
        self.made.add(group, steps);
    }

    /// Stores the due time of a played event, by the step timer. The Stepper is the only writer.
    #[inline(always)]
    pub(crate) fn event_played(&self, due: u32) {
        self.due.store(due, Relaxed);
    }

    /// Due time of the last event; for the Stepper.
    pub(crate) fn played_at(&self) -> u32 {
        self.due.load(Relaxed)
    }

    /// Sets the lag of motion time behind the step timer. Motion time stays as it is: the last event now has the time
    /// `due`.
    pub(crate) fn set_lag(&self, ticks: u32, due: u32) {
        self.lag.store(ticks, Relaxed);
        self.event_played(due);
    }

    /// Motion time executed, low 32 bits, in ticks.
    #[must_use]
    pub fn tick(&self) -> u32 {
        loop {
            let lag = self.lag.load(Acquire);
            let tick = self.due.load(Acquire).wrapping_sub(lag);
            // The Stepper may have come in between. Events move `due` alone, which is right at any time; a new lag
            // moves both.
            if self.lag.load(Acquire) == lag {
                return tick;
            }
        }
    }

    /// Groups with steps that the Stepper checks first.
    pub(crate) fn slow_groups(&self) -> GroupSet {
        GroupSet(self.slow.load(Relaxed))
    }

    pub(crate) fn set_slow_groups(&self, groups: GroupSet) {
        self.slow.store(groups.0, Relaxed);
    }

    pub(crate) fn entry_done(&self) {
        self.entries_done.store(self.entries_done.load(Relaxed).wrapping_add(1), Release);
    }

    /// Entries of the MoveQueue that the StepGenerator has finished, wrapping.
    pub(crate) fn entries_done(&self) -> u32 {
        self.entries_done.load(Acquire)
    }

    pub(crate) fn set_events_made(&self, made: u32) {
        self.events_made.store(made, Release);
    }

    /// Events put into the StepQueue, at the last turn of the StepGenerator.
    pub(crate) fn events_made(&self) -> u32 {
        self.events_made.load(Acquire)
    }

    /// Stores the events taken out of the StepQueue when the Stepper came to rest. No reader can preempt the Stepper.
    pub(crate) fn set_rested(&self, done: u32) {
        self.rested.store(done, Relaxed);
    }

    /// Events that the Stepper had taken when it last came to rest.
    pub(crate) fn rested_at(&self) -> u32 {
        self.rested.load(Acquire)
    }

    /// A number that changes whenever the Stepper has played an event or was pended.
    pub(crate) fn stepper_beat(&self) -> u32 {
        self.due.load(Relaxed).wrapping_add(self.looks.load(Relaxed))
    }

    /// The Stepper was pended and has read the endstops.
    pub fn count_look(&self) {
        self.looks.store(self.looks.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Whether all events made are played.
    pub(super) fn has_rested(&self) -> bool {
        self.events_made.load(Acquire) == self.rested.load(Acquire)
    }

    /// Whether all `entries` that the Console queued are played to their end.
    #[must_use]
    pub fn is_idle(&self, entries: u32) -> bool {
        // The order matters: once every entry is done, no event is added to those already made.
        self.entries_done.load(Acquire) == entries && self.has_rested()
    }

    /// Overload since the start.
    #[must_use]
    pub fn overload(&self) -> Overload {
        Overload {
            events: self.late.read(),
            spans: self.squeezed.read(),
            starved: self.starved.load(Relaxed),
            underruns: self.underruns.load(Relaxed),
        }
    }

    pub(crate) fn count_starved(&self) {
        self.starved.store(self.starved.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Counts an event that came `ticks` late and delayed all later ones.
    pub(crate) fn count_late(&self, ticks: u32) {
        self.late.add(ticks);
    }

    /// Counts a span that was made longer by `ticks`.
    pub(crate) fn count_squeezed(&self, ticks: u32) {
        self.squeezed.add(ticks);
    }
}
