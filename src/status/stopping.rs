//! The ends of motion: epochs, endstops, braking and the halt.

use super::Status;
use crate::motors::EndstopSet;
use core::sync::atomic::{Ordering::Acquire, Ordering::Relaxed, Ordering::Release};

impl Status {
    /// The current epoch.
    #[must_use]
    pub fn epoch(&self) -> u8 {
        self.epoch.load(Acquire)
    }

    /// As [`epoch`](Self::epoch), for the Stepper: while it runs, no other context can write.
    #[inline(always)]
    pub(crate) fn epoch_in_interrupt(&self) -> u8 {
        self.epoch.load(Relaxed)
    }

    /// Begins a new epoch: everything queued is discarded.
    pub(crate) fn next_epoch(&self) -> u8 {
        let epoch = self.epoch().wrapping_add(1);
        self.epoch.store(epoch, Release);
        epoch
    }

    /// Endstops that ended the motion of this epoch.
    #[must_use]
    pub fn triggered(&self) -> EndstopSet {
        EndstopSet(self.triggered.load(Acquire))
    }

    pub(crate) fn clear_triggered(&self) {
        self.triggered.store(0, Release);
    }

    /// For the Stepper. No reader can preempt it, so Relaxed suffices.
    pub(crate) fn set_triggered(&self, set: EndstopSet) {
        self.triggered.store(set.0, Relaxed);
    }

    /// Endstop inputs as last read.
    #[must_use]
    pub fn endstops(&self) -> EndstopSet {
        EndstopSet(self.endstops.load(Relaxed))
    }

    pub(crate) fn set_endstops(&self, set: EndstopSet) {
        self.endstops.store(set.0, Relaxed);
    }

    /// The existing endstops.
    #[must_use]
    pub fn inputs(&self) -> EndstopSet {
        EndstopSet(self.inputs.load(Relaxed))
    }

    pub(crate) fn set_inputs(&self, set: EndstopSet) {
        self.inputs.store(set.0, Relaxed);
    }

    /// Whether an emergency stop is active.
    #[must_use]
    pub fn is_halted(&self) -> bool {
        self.halted.load(Relaxed)
    }

    pub(crate) fn set_halted(&self) {
        self.halted.store(true, Relaxed);
    }

    /// Lets the motion of an epoch brake along its path; `None` withdraws it.
    pub(crate) fn set_brake(&self, epoch: Option<u8>) {
        self.brake.store(epoch.map_or(0, |epoch| u32::from(epoch) + 1), Release);
    }

    /// Whether the motion of this epoch shall brake.
    pub(crate) fn is_braking(&self, epoch: u8) -> bool {
        self.brake.load(Acquire) == u32::from(epoch) + 1
    }

    pub(crate) fn set_stopped(&self, epoch: Option<u8>) {
        self.stopped.store(epoch.map_or(0, |epoch| u32::from(epoch) + 1), Release);
    }

    /// Whether the motion of this epoch has stopped, and all its steps are played.
    pub(crate) fn has_stopped(&self, epoch: u8) -> bool {
        self.stopped.load(Acquire) == u32::from(epoch) + 1 && self.has_rested()
    }
}
