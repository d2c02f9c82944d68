//! Passes: work that has to look at many moves of the window, done a few at a time.
//!
//! A window of 144 moves takes many times as long as a move. So a caller that needs such a pass has a part of it done
//! in each turn of the Console. Nothing that depends on its outcome happens before its end:
//!
//! | pass | begins when | until its end |
//! |---|---|---|
//! | [`replan`](Window::replan) | the feed changes for moves that wait | nothing leaves and nothing is added |
//! | [`count_final`](Window::count_final) | motion has not begun, and a move was added | motion does not begin |

use super::planned::Planned;
use super::window::{FinalCount, Window};
use crate::units::SpeedSq;

/// Moves of one part of a pass; a turn of the Console may do two parts.
const PART: usize = 5;

impl Window<'_> {
    /// Starts to plan all moves again. No move is forced to leave any more.
    pub fn begin_replan(&mut self) {
        (self.forced, self.is_stuck) = (0, false);
        self.replan = (self.len > 0).then_some((0, SpeedSq::MAX));
        self.counted = FinalCount::new(self.front_sq);
        self.minima.clear();
    }

    /// Whether no move is left to be planned again.
    #[inline(always)]
    pub const fn is_planned(&self) -> bool {
        self.replan.is_none()
    }

    /// Has `change` change the next few moves, and plans them again. A speed that is too great now is braked away as
    /// fast as the accelerations allow. Until then it counts as the greatest entry speed, because it was possible when
    /// it was planned.
    pub fn replan(&mut self, mut change: impl FnMut(&mut Planned)) {
        let Some((begin, mut exit_limit_sq)) = self.replan else { return };
        let Some(origin) = self.get(0).map(|first| first.cumulative_gain_sq) else { return };
        let end = self.len.min(begin + PART);
        for index in begin..end {
            let slot = self.slot(index);
            let Some(planned) = self.moves.get_mut(slot) else { break };
            change(planned);
            planned.limit_entry(exit_limit_sq);
            let left = self.front_sq.saturating_sub(planned.cumulative_gain_sq.wrapping_sub(origin));
            planned.max_entry_sq = planned.max_entry_sq.max(left);
            exit_limit_sq = planned.exit_limit_sq();
            let bound_sq = planned.bound_sq();
            self.add_minimum(slot, bound_sq);
        }
        self.replan = (end < self.len).then_some((end, exit_limit_sq));
    }

    /// Looks whether the next few moves are final; only the first moves of a window are. Gives the nominal time of
    /// those that are known to be, in ticks, and whether that is all.
    pub fn count_final(&mut self) -> (u64, bool) {
        let FinalCount { mut next, mut entry_sq, mut ticks, mut is_done } = self.counted;
        let end = next + PART;
        let mut least = 0;
        while next < end && !is_done {
            least = self.first_minimum_after(next, least);
            match (self.exit_sq(next, entry_sq, least), self.get(next)) {
                (Some((exit_sq, true)), Some(planned)) => {
                    ticks += u64::from(planned.nominal_ticks);
                    (next, entry_sq) = (next + 1, exit_sq);
                }
                _ => is_done = true,
            }
        }
        self.counted = FinalCount { next, entry_sq, ticks, is_done };
        (ticks, is_done)
    }
}
