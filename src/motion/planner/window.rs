//! The look-ahead window: moves with speeds that may still change.
//!
//! The speed at the end of the last move is 0, because the next move is unknown. Let `w_i` be the square of the entry
//! speed of move i. Let `m_k` be the greatest one that move k allows ([`Planned::max_entry_sq`]). Let `G_k` be the sum
//! of the possible gains of the moves before move k, 2 a L each ([`Planned::cumulative_gain_sq`]). The greatest speed
//! from which the following moves can still brake is
//!
//! ```text
//! w_i = min over k >= i of (m_k + G_k) - G_i,    and at most w_(i-1) + gain_(i-1)
//! ```
//!
//! The minima are kept in a queue, as in the sliding-window minimum. When a corner is added, all corners in the queue
//! with an `m_k + G_k` that is no smaller leave it. None of them can be a minimum any more. So the values in the queue
//! rise, and the first corner in it that follows move i is the minimum for move i. Adding a move costs as much whether
//! three or a hundred wait. Work on all moves is done a few at a time (see [`passes`](super::passes)).
//!
//! The end of the window counts as a corner with the speed 0. A move that is added takes the end farther away and
//! brings a corner which allows at least as much as the old end did. So a corner with another minimum than the end has
//! a speed that no later move can change: it is **final**. The move before a final corner may leave, sooner or later,
//! without a difference to the steps. When a move must leave that is not final, the steps would depend on when it left.
//! Therefore that happens in two cases only. The stream of commands itself causes it (the window is full of moves that
//! are not final, or a command waits for the motion), or no commands come any more. Such a move is **forced**: for it
//! the window ends from then on where it ended at that moment. Corners that are added later allow at least as much as
//! that end does, so the move leaves with the speeds of that moment, however late it leaves.

use super::planned::{LOOKAHEAD_MOVES, MINIMA_PLACES, MoveMemory, Planned};
use super::profile::profile;
use crate::motion::moves::Move;
use crate::units::{Seconds, SpeedSq, Steps};

/// Whether `a` is less than `b`; both wrap.
const fn is_less(a: SpeedSq, b: SpeedSq) -> bool {
    (a.wrapping_sub(b).0 as i64) < 0
}

/// Slots of the moves with corners that have a smaller `m + G` than all that follow; in order.
pub(in crate::motion) struct Minima<'m> {
    /// A ring, which caps the capacity of the window.
    slots: &'m mut [u8; MINIMA_PLACES],
    /// Both wrap with the ring.
    begin: u8,
    end: u8,
}

impl Minima<'_> {
    #[inline(always)]
    fn get(&self, index: u8) -> Option<usize> {
        let slot = self.slots.get(usize::from(self.begin.wrapping_add(index)))?;
        (index < self.len()).then_some(usize::from(*slot))
    }

    #[inline(always)]
    const fn len(&self) -> u8 {
        self.end.wrapping_sub(self.begin)
    }

    pub const fn clear(&mut self) {
        self.end = self.begin;
    }
}

/// The window has no place for another move.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::motion) struct Full;

impl core::fmt::Display for Full {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        put!(f, "the look-ahead is full")
    }
}

impl core::error::Error for Full {}

/// The moves known to be final, as far as they have been counted.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct FinalCount {
    /// The index of the next move to look at, and the speed squared at which it is entered.
    pub next: usize,
    pub entry_sq: SpeedSq,
    /// The nominal time of those before it, in ticks.
    pub ticks: u64,
    /// It is not final.
    pub is_done: bool,
}

impl FinalCount {
    /// None; motion continues with that speed squared.
    pub const fn new(front_sq: SpeedSq) -> Self {
        Self { next: 0, entry_sq: front_sq, ticks: 0, is_done: false }
    }
}

pub(in crate::motion) struct Window<'m> {
    pub(in crate::motion) moves: &'m mut [Planned; LOOKAHEAD_MOVES],
    pub(in crate::motion) minima: Minima<'m>,
    /// The slot of the first move.
    first: usize,
    pub(in crate::motion) len: usize,
    /// G at the end of the last move.
    total_gain_sq: SpeedSq,
    /// The number of moves that leave though they may not be final.
    pub(in crate::motion) forced: usize,
    /// The first move may not leave, until it is made to or something else changes.
    pub(in crate::motion) is_stuck: bool,
    /// Speed squared at the end of the last move that left.
    pub(in crate::motion) front_sq: SpeedSq,
    /// That speed, in mm/s.
    front_speed: f32,
    /// The index of the next move to plan again, and the limit of the exit speed squared of the move before it.
    pub(in crate::motion) replan: Option<(usize, SpeedSq)>,
    pub(in crate::motion) counted: FinalCount,
}

impl<'m> Window<'m> {
    pub const fn new(memory: &'m mut MoveMemory) -> Self {
        let MoveMemory { moves, minima } = memory;
        let minima = Minima { slots: minima, begin: 0, end: 0 };
        Self {
            moves,
            minima,
            first: 0,
            len: 0,
            total_gain_sq: SpeedSq::ZERO,
            forced: 0,
            is_stuck: false,
            front_sq: SpeedSq::ZERO,
            front_speed: 0.0,
            replan: None,
            counted: FinalCount::new(SpeedSq::ZERO),
        }
    }

    #[inline(always)]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether no further move fits.
    #[inline(always)]
    pub const fn is_full(&self) -> bool {
        self.len == LOOKAHEAD_MOVES
    }

    /// The slot of the move of that index.
    #[inline(always)]
    pub const fn slot(&self, index: usize) -> usize {
        let slot = self.first + index;
        if slot >= LOOKAHEAD_MOVES { slot - LOOKAHEAD_MOVES } else { slot }
    }

    /// The index of the move in that slot.
    const fn index(&self, slot: usize) -> usize {
        if slot >= self.first { slot - self.first } else { slot + LOOKAHEAD_MOVES - self.first }
    }

    pub fn get(&self, index: usize) -> Option<&Planned> {
        if index < self.len { self.moves.get(self.slot(index)) } else { None }
    }

    /// G at the end of the last move.
    #[inline(always)]
    pub const fn total_gain_sq(&self) -> SpeedSq {
        self.total_gain_sq
    }

    /// Adds the move that `make` writes into its place, because a copy of it is no small part of planning. It starts
    /// from the G [at the end of the last one](Self::total_gain_sq).
    #[inline(always)]
    pub fn push(&mut self, make: impl FnOnce(&mut Planned)) -> Result<(), Full> {
        if self.is_full() {
            return Err(Full);
        }
        let slot = self.slot(self.len);
        let planned = self.moves.get_mut(slot).ok_or(Full)?;
        make(planned);
        self.total_gain_sq = self.total_gain_sq.wrapping_add(planned.gain_sq());
        let bound_sq = planned.bound_sq();
        self.add_minimum(slot, bound_sq);
        self.len += 1;
        (self.counted.is_done, self.is_stuck) = (false, false);
        Ok(())
    }

    /// Adds the corner before a move to the queue of minima; no corner follows it yet.
    pub(in crate::motion) fn add_minimum(&mut self, slot: usize, bound_sq: SpeedSq) {
        while self.minima.len() > 0 {
            let last = self.minima.get(self.minima.len() - 1);
            if last.is_some_and(|other| is_less(self.bound_sq(other), bound_sq)) {
                break;
            }
            self.minima.end = self.minima.end.wrapping_sub(1);
        }
        if let Some(entry) = self.minima.slots.get_mut(usize::from(self.minima.end)) {
            *entry = slot as u8;
        }
        self.minima.end = self.minima.end.wrapping_add(1);
    }

    /// `m + G` of the move in that slot.
    fn bound_sq(&self, slot: usize) -> SpeedSq {
        self.moves.get(slot).map_or(SpeedSq::ZERO, Planned::bound_sq)
    }

    /// Forgets every move; the machine stands.
    pub fn clear(&mut self) {
        self.minima.clear();
        (self.len, self.total_gain_sq, self.forced, self.is_stuck) = (0, SpeedSq::ZERO, 0, false);
        (self.replan, self.counted) = (None, FinalCount::new(SpeedSq::ZERO));
        (self.front_sq, self.front_speed) = (SpeedSq::ZERO, 0.0);
    }

    /// The index, in the queue of minima, of the least corner that follows the move of that index. The search begins at
    /// `minimum`, which must not be beyond it. The queue is in order, so the next move's search begins where this one
    /// ended.
    #[inline(always)]
    pub(in crate::motion) fn first_minimum_after(&self, index: usize, mut minimum: u8) -> u8 {
        while self.minima.get(minimum).is_some_and(|slot| self.index(slot) <= index) {
            minimum += 1;
        }
        minimum
    }

    /// The greatest exit speed squared of the move of that index, which is entered with `entry_sq`, and whether it is
    /// final; `None` if no move follows.
    pub(in crate::motion) fn exit_sq(&self, index: usize, entry_sq: SpeedSq, minimum: u8) -> Option<(SpeedSq, bool)> {
        let (this, next) = (self.get(index)?, self.get(index + 1)?);
        Some(self.exit_sq_between(this, next, (entry_sq, self.total_gain_sq), self.minima.get(minimum)?))
    }

    /// The exit speed of `this` towards `next`, given its entry speed, G at the end of the window, and the slot of the
    /// least corner that follows `this`.
    #[inline(always)]
    fn exit_sq_between(
        &self,
        this: &Planned,
        next: &Planned,
        (entry_sq, end_sq): (SpeedSq, SpeedSq),
        least_slot: usize,
    ) -> (SpeedSq, bool) {
        let bound_sq = self.bound_sq(least_slot).wrapping_sub(next.cumulative_gain_sq);
        let reach = entry_sq.saturating_add(next.cumulative_gain_sq.wrapping_sub(this.cumulative_gain_sq));
        let (known, end) = (bound_sq.min(reach), end_sq.wrapping_sub(next.cumulative_gain_sq));
        (known.min(end), known <= end)
    }

    /// The exit speed squared of the first move, and whether it is final; `None` if no move follows.
    #[inline(always)]
    fn first_exit_sq(&self) -> Option<(SpeedSq, bool)> {
        if self.len < 2 {
            return None;
        }
        let (this, next) = (self.moves.get(self.first)?, self.moves.get(self.slot(1))?);
        // The first of the minima may be its own corner.
        let least_slot = match self.minima.get(0)? {
            own if own == self.first => self.minima.get(1)?,
            least => least,
        };
        let end_sq = if self.forced > 0 { this.forced_end_sq } else { self.total_gain_sq };
        Some(self.exit_sq_between(this, next, (self.front_sq, end_sq), least_slot))
    }

    /// Whether the first move may leave.
    pub fn has_ready(&self) -> bool {
        self.forced > 0 || self.first_exit_sq().is_some_and(|(_, is_final)| is_final)
    }

    /// Lets the first `count` moves leave though they may not be final. Those that were forced before keep their end.
    pub fn force(&mut self, count: usize) {
        let count = count.min(self.len);
        if count > self.forced {
            let (more, slot, end_sq) = (count - self.forced, self.slot(self.forced), self.total_gain_sq);
            // From the first that is new, and on from the begin of the ring.
            if let Some((wrapped, straight)) = self.moves.split_at_mut_checked(slot) {
                straight.iter_mut().chain(wrapped).take(more).for_each(|planned| planned.forced_end_sq = end_sq);
            }
            (self.forced, self.is_stuck) = (count, false);
        }
    }

    /// Takes the first move if it may leave, and says its nominal time; the filament of the last one ended at
    /// `filament`.
    #[inline(always)]
    pub fn pop(&mut self, filament: Steps) -> Option<(Move, u32)> {
        if self.is_stuck || self.len == 0 {
            return None;
        }
        let exit = self.first_exit_sq();
        if self.forced == 0 && !exit.is_some_and(|(_, is_final)| is_final) {
            self.is_stuck = true;
            return None;
        }
        let slot = self.first;
        let planned = self.moves.get(slot)?;
        // Planned as `min`, so the ramps fit except for the rounding of squares and roots.
        let exit_sq = exit.map_or(SpeedSq::ZERO, |(exit_sq, _)| exit_sq);
        let (mut released, exit_speed) = profile(&planned.spec, (self.front_sq, self.front_speed), exit_sq);
        released.rests = exit.is_none();
        let advance = planned.spec.own.advance();
        if advance > Seconds::ZERO {
            let [.., end] = planned.spec.end;
            // By the steps that filament has really come since the last move that left, so that no rounding adds up.
            let way = i128::from(end.wrapping_sub(filament).to_bits()) * i128::from(advance.to_bits());
            released.advance = Steps::from_bits((way >> Seconds::FRAC_NBITS) as i64);
        }
        let ticks = planned.nominal_ticks;
        (self.first, self.front_sq, self.len) = (self.slot(1), exit_sq, self.len - 1);
        self.front_speed = exit_speed;
        self.forced = self.forced.saturating_sub(1);
        // Its own corner has been passed, and bounds no later move.
        if self.minima.get(0) == Some(slot) {
            self.minima.begin = self.minima.begin.wrapping_add(1);
        }
        self.counted = FinalCount::new(exit_sq);
        Some((released, ticks))
    }

    /// The last move.
    pub fn last(&self) -> Option<&Planned> {
        self.get(self.len.checked_sub(1)?)
    }
}
