//! Passes: work that has to look at many moves of the window, done a few at a time.
//!
//! A window of 144 moves takes many times as long as a move. So a caller that needs such a pass has a part of it done
//! in each turn of the Console. Nothing that depends on its outcome happens before its end:
//!
//! | pass | begins when | until its end |
//! |---|---|---|
//! | [`replan`](Window::replan) | the feed changes for moves that wait | nothing leaves and nothing is added |
//! | [`freeze_exits`](Window::freeze_exits) | moves are made to leave that are not final | nothing is added |
//! | [`count_final`](Window::count_final) | motion has not begun, and a move was added | motion does not begin |

use super::pass_progress::{Cursor, FinalCount, Passes};
use super::planned::{NOT_FROZEN, Planned};
use super::window::Window;
use crate::units::SpeedSq;

/// Moves of one part of a pass; a turn of the Console may do two parts.
const PART: usize = 5;

impl Window<'_> {
    /// Starts to plan all moves again. No exit speed is frozen any more, and no move is made to leave.
    pub fn begin_replan(&mut self) {
        (self.forced, self.is_stuck, self.passes) = (0, false, Passes::NONE);
        self.passes.replan = (self.len > 0).then_some((0, SpeedSq::MAX));
        self.passes.counted = FinalCount::new(self.front_sq);
        self.minima.clear();
    }

    /// Whether no move is left to be planned again.
    #[inline(always)]
    pub const fn is_planned(&self) -> bool {
        self.passes.replan.is_none()
    }

    /// Has `change` change the next few moves, and plans them again. A speed that is too great now is braked away as
    /// fast as the accelerations allow. Until then it counts as the greatest entry speed, because it was possible when
    /// it was planned.
    pub fn replan(&mut self, mut change: impl FnMut(&mut Planned)) {
        let Some((begin, mut exit_limit_sq)) = self.passes.replan else { return };
        let Some(origin) = self.get(0).map(|first| first.cumulative_gain_sq) else { return };
        let end = self.len.min(begin + PART);
        for index in begin..end {
            let slot = self.slot(index);
            let Some(planned) = self.moves.get_mut(slot) else { break };
            change(planned);
            planned.limit_entry(exit_limit_sq);
            let left = self.front_sq.saturating_sub(planned.cumulative_gain_sq.wrapping_sub(origin));
            planned.max_entry_sq = planned.max_entry_sq.max(left);
            planned.frozen_exit_sq = NOT_FROZEN;
            exit_limit_sq = planned.exit_limit_sq();
            let bound_sq = planned.bound_sq();
            self.add_minimum(slot, bound_sq);
        }
        self.passes.replan = (end < self.len).then_some((end, exit_limit_sq));
    }

    /// Whether the exit speeds of all moves that were made to leave are frozen.
    #[inline(always)]
    pub const fn are_exits_frozen(&self) -> bool {
        self.passes.frozen.index >= self.forced
    }

    /// Freezes the exit speeds of a few moves that were made to leave. Otherwise these speeds would depend on the moves
    /// added before these moves leave.
    pub fn freeze_exits(&mut self) {
        let Cursor { index: begin, mut entry_sq } = self.passes.frozen;
        let end = self.forced.min(begin + PART);
        let mut least = 0;
        for index in begin..end {
            least = self.first_minimum_after(index, least);
            let planned = self.exit_sq(index, entry_sq, least).map_or(SpeedSq::ZERO, |(exit_sq, _)| exit_sq);
            let slot = self.slot(index);
            let Some(this) = self.moves.get_mut(slot) else { break };
            if this.frozen_exit_sq == NOT_FROZEN {
                this.frozen_exit_sq = planned;
            }
            entry_sq = this.frozen_exit_sq;
        }
        self.passes.frozen = Cursor { index: end, entry_sq };
    }

    /// Looks whether the next few moves are final; only the first moves of a window are. Gives the nominal time of
    /// those that are known to be, in ticks, and whether that is all.
    pub fn count_final(&mut self) -> (u64, bool) {
        let FinalCount { mut next, mut ticks, mut is_done } = self.passes.counted;
        let end = next.index + PART;
        let mut least = 0;
        while next.index < end && !is_done {
            least = self.first_minimum_after(next.index, least);
            match (self.exit_sq(next.index, next.entry_sq, least), self.get(next.index)) {
                (Some((exit_sq, true)), Some(planned)) => {
                    ticks += u64::from(planned.nominal_ticks);
                    next = Cursor { index: next.index + 1, entry_sq: exit_sq };
                }
                _ => is_done = true,
            }
        }
        self.passes.counted = FinalCount { next, ticks, is_done };
        (ticks, is_done)
    }
}
