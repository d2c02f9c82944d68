//! Leaving: how many moves wait, and which of them may go to the generator.

use super::planned::{FORCED_BATCH, LOOKAHEAD_MOVES};
use super::{Move, Planner};

impl Planner<'_> {
    /// Whether another move can be planned.
    #[must_use]
    pub fn has_room(&self) -> bool {
        // The open line has a place to come.
        self.len() < LOOKAHEAD_MOVES
    }

    /// Moves that can be pushed.
    #[must_use]
    pub fn room(&self) -> usize {
        LOOKAHEAD_MOVES - self.len()
    }

    /// Whether [`pop`](Self::pop) would give a move.
    #[must_use]
    pub fn has_ready(&self) -> bool {
        self.window.is_planned() && self.window.has_ready()
    }

    /// Whether the first move waits for more moves, or there is none. While moves are [planned again](Self::replan)
    /// this counts as false.
    #[must_use]
    pub fn lacks_moves(&self) -> bool {
        self.window.is_planned() && !self.window.has_ready()
    }

    /// Whether no move waits.
    #[inline(always)]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Moves that wait; the open line, which has its place to come, is one.
    #[inline(always)]
    #[must_use]
    pub fn len(&self) -> usize {
        debug_assert_eq!(self.count, self.window.len() + usize::from(self.line.is_open()));
        self.count
    }

    /// Nominal time of the moves in the window, in ticks: their time without ramps.
    #[must_use]
    pub const fn waiting(&self) -> u64 {
        self.waiting
    }

    /// Moves planned so far, and the path of the tool in um; both wrap.
    #[must_use]
    pub const fn planned(&self) -> (u32, u32) {
        (self.moves, self.path.wrapping_um())
    }

    /// The path of the tool that was planned so far, in mm; it wraps after 4,294 km.
    #[must_use]
    pub const fn path(&self) -> u32 {
        self.path.whole_mm()
    }

    /// Checks a few more moves whether they are final. Gives the nominal time of those that are known to be, in ticks,
    /// and whether that is all of them.
    pub fn final_time(&mut self) -> (u64, bool) {
        if self.replan() { self.window.count_final() } else { (0, false) }
    }

    /// Lets the first move leave, final or not.
    pub fn release_next(&mut self) {
        self.window.force(1);
    }

    /// Lets a few moves leave, unless the first is final or not [planned](Self::is_planned): the window is full.
    pub fn release_some(&mut self) {
        if self.is_planned() && !self.has_ready() {
            self.window.force(FORCED_BATCH);
        }
    }

    /// Lets every move leave.
    pub fn release_all(&mut self) {
        self.window.force(usize::MAX);
    }

    /// Takes the next move that may leave; none does while moves are [planned again](Self::replan).
    pub fn pop(&mut self) -> Option<Move> {
        if !self.window.is_planned() {
            return None;
        }
        let (released, ticks) = self.window.pop(self.released_filament)?;
        self.count = self.count.saturating_sub(1);
        self.waiting = self.waiting.saturating_sub(u64::from(ticks));
        self.released_filament = released.end[3];
        Some(released)
    }
}
