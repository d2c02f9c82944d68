//! Status of the command stream: moves planned and waiting, underruns, and the print's progress.

use super::Status;
use super::print_progress::PrintProgress;
use core::sync::atomic::Ordering::Relaxed;

impl Status {
    /// Whether the Console only waits for the host.
    #[must_use]
    pub fn is_awaiting_input(&self) -> bool {
        self.awaiting_input.load(Relaxed)
    }

    /// Whether a command waits for the user.
    #[must_use]
    pub fn is_awaiting_user(&self) -> bool {
        self.awaiting_user.load(Relaxed)
    }

    pub(crate) fn set_awaiting_user(&self, waiting: bool) {
        self.awaiting_user.store(waiting, Relaxed);
    }

    pub(crate) fn set_awaiting_input(&self, waiting: bool) {
        self.awaiting_input.store(waiting, Relaxed);
    }

    /// Moves planned, and the length of their path in um (wrapping at 4295 m).
    #[must_use]
    pub fn planned(&self) -> (u32, u32) {
        (self.moves.load(Relaxed), self.path_um.load(Relaxed))
    }

    pub(crate) fn set_planned(&self, moves: u32, path_um: u32) {
        self.moves.store(moves, Relaxed);
        self.path_um.store(path_um, Relaxed);
    }

    /// Moves planned with a lower speed than on a flat bed, because of z's limits.
    #[must_use]
    pub fn slowed_moves(&self) -> u32 {
        self.slowed_moves.load(Relaxed)
    }

    pub(crate) fn set_slowed_moves(&self, moves: u32) {
        self.slowed_moves.store(moves, Relaxed);
    }

    pub(crate) fn count_underrun(&self) {
        self.underruns.store(self.underruns.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Moves planned and not begun.
    #[must_use]
    pub fn level(&self) -> u32 {
        self.level.load(Relaxed)
    }

    pub(crate) fn set_level(&self, moves: u32) {
        self.level.store(moves, Relaxed);
    }

    /// Fewest moves in the look-ahead while the stream ran.
    #[must_use]
    pub fn low_water(&self) -> Option<u32> {
        self.low_water.load(Relaxed).checked_sub(1)
    }

    pub(crate) fn note_level(&self, moves: u32) {
        if self.low_water().is_none_or(|least| moves < least) {
            self.low_water.store(moves.saturating_add(1), Relaxed);
        }
    }

    /// The progress that the print's own lines report.
    #[must_use]
    pub const fn print_progress(&self) -> &PrintProgress {
        &self.print_progress
    }
}
