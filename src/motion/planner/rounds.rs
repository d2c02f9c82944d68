//! Rounds: work that has to look at many moves of the window, done a few at a time.
//!
//! A window of 144 moves takes many times as long as a move. So whoever asks for such a round has a part of it done in each
//! turn of the Console, and nothing that depends on its outcome happens before its end:
//!
//! | round | begins when | until its end |
//! |---|---|---|
//! | planning anew | the feed changes for moves that wait | nothing leaves and nothing is added |
//! | settling | moves are made to leave that are not final | nothing is added |
//! | judging | motion has not begun, and a move was added | motion does not begin |

use super::planned::{OPEN, Planned};
use super::window::Window;

/// Moves of one part of a round; a turn of the Console may do two parts.
const PART: usize = 5;

/// How far the rounds have come.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct Rounds {
    /// The index of the next move to plan anew, and the speed squared that the one before it passes on.
    anew: Option<(usize, u64)>,
    pub settled: Cursor,
    pub judged: Judged,
}

/// A move, by its index, and the speed squared at which it is entered.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct Cursor {
    index: usize,
    entry: u64,
}

/// The moves that are final, as far as is known.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct Judged {
    next: Cursor,
    /// Their nominal time, in ticks.
    ticks: u64,
    /// The next one is not final.
    pub is_done: bool,
}

impl Cursor {
    /// The first move leaves, with that speed squared at its end.
    #[inline(always)]
    pub const fn pop(&mut self, speed: u64) {
        match self.index {
            0 => self.entry = speed,
            _ => self.index -= 1,
        }
    }
}

impl Judged {
    /// None; motion goes on with that speed squared.
    pub const fn new(front: u64) -> Self {
        Self { next: Cursor { index: 0, entry: front }, ticks: 0, is_done: false }
    }
}

impl Rounds {
    /// Nothing to do.
    pub const NONE: Self = Self { anew: None, settled: Cursor { index: 0, entry: 0 }, judged: Judged::new(0) };

    /// Moves were made to leave, the first of which is entered with that speed squared.
    pub const fn begin_to_settle(&mut self, front: u64) {
        self.settled = Cursor { index: 0, entry: front };
    }
}

impl Window<'_> {
    /// All moves are to be planned anew. None is settled any more, and none is made to leave.
    pub fn begin_anew(&mut self) {
        (self.forced, self.is_stuck, self.rounds) = (0, false, Rounds::NONE);
        self.rounds.anew = (self.len > 0).then_some((0, u64::MAX));
        self.rounds.judged = Judged::new(self.front);
        self.minima.clear();
    }

    /// Whether moves are still to be planned anew.
    #[inline(always)]
    pub const fn is_planned(&self) -> bool {
        self.rounds.anew.is_none()
    }

    /// Has `change` change the next few moves, and plans them anew. A speed that is too great now is braked away as fast as
    /// the accelerations allow, so it counts as a cap until then; it was below all caps when it was planned.
    pub fn plan_anew(&mut self, mut change: impl FnMut(&mut Planned)) {
        let Some((begin, mut passed_on)) = self.rounds.anew else { return };
        let Some(origin) = self.get(0).map(|first| first.before) else { return };
        let end = self.len.min(begin + PART);
        for index in begin..end {
            let place = self.place(index);
            let Some(planned) = self.moves.get_mut(place) else { break };
            change(planned);
            planned.limit_entry(passed_on);
            let left = self.front.saturating_sub(planned.before.wrapping_sub(origin));
            planned.cap = planned.cap.max(left);
            planned.exit = OPEN;
            passed_on = planned.passed_on();
            let bound = planned.bound();
            self.note(place, bound);
        }
        self.rounds.anew = (end < self.len).then_some((end, passed_on));
    }

    /// Whether the speeds of all moves that were made to leave are settled.
    #[inline(always)]
    pub const fn is_settled(&self) -> bool {
        self.rounds.settled.index >= self.forced
    }

    /// Settles the speeds of a few moves that were made to leave, or they would depend on what is added until they do.
    pub fn settle(&mut self) {
        let Cursor { index: begin, mut entry } = self.rounds.settled;
        let end = self.forced.min(begin + PART);
        let mut least = 0;
        for index in begin..end {
            least = self.least_behind(index, least);
            let planned = self.exit(index, entry, least).map_or(0, |(exit, _)| exit);
            let place = self.place(index);
            let Some(this) = self.moves.get_mut(place) else { break };
            if this.exit == OPEN {
                this.exit = planned;
            }
            entry = this.exit;
        }
        self.rounds.settled = Cursor { index: end, entry };
    }

    /// Looks whether the next few moves are final; only the first moves of a window are. Gives the nominal time of those that
    /// are known to be, in ticks, and whether that is all.
    pub fn judge(&mut self) -> (u64, bool) {
        let Judged { mut next, mut ticks, mut is_done } = self.rounds.judged;
        let end = next.index + PART;
        let mut least = 0;
        while next.index < end && !is_done {
            least = self.least_behind(next.index, least);
            match (self.exit(next.index, next.entry, least), self.get(next.index)) {
                (Some((exit, true)), Some(planned)) => {
                    ticks += u64::from(planned.nominal_ticks);
                    next = Cursor { index: next.index + 1, entry: exit };
                }
                _ => is_done = true,
            }
        }
        self.rounds.judged = Judged { next, ticks, is_done };
        (ticks, is_done)
    }
}
