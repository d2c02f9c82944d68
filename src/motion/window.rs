//! The look-ahead window: moves whose speeds may still change.
//!
//! The speed at the end of the last move is 0, for nobody knows what follows. With `w` for squared speeds, `cap_k` for
//! the greatest at the corner before move k, and `G_k` for the sum of what the moves before it could gain (2 a L each),
//! the greatest speed from which the rest can still brake is
//!
//! ```text
//! w_i = min over k >= i of (cap_k + G_k) - G_i,    and at most w_(i-1) + gain_(i-1)
//! ```
//!
//! The minimum over all that follow is kept up to date as moves come and go, by a queue of those corners alone behind
//! which there is none with a smaller `cap_k + G_k`: a move that is added costs as much whether three or a hundred wait.
//!
//! A corner whose speed is not limited by the end of the window is **final**: what is added counts with at least as much
//! as that end. The move before it may leave, sooner or later, without a difference to the steps. When a move must
//! leave that is not final, the outcome would depend on when; so that happens only where the stream of commands itself
//! says so (the window is full of unfinished moves, or a command waits for the motion), or when the stream is dry.

use crate::motion::geometry::{Belts, Geometry, speed};
use crate::motion::moves::Move;
use crate::motion::number::from_bits;
use crate::motion::profile::{Speeds, gain, profile};
use crate::port::EndstopSet;
use crate::settings::Settings;
use crate::units::{MmPerSec, MmPerSec2, Seconds, Steps, TICKS_PER_SECOND};
use heapless::Deque;

/// Moves that leave when the window is full and the first is not final: some at a time, so that the queue behind has
/// enough while the window fills again.
pub const FORCED_BATCH: usize = 16;

/// Capacity of the window; the look-ahead sees no fewer than 128 moves when the stream is fast enough.
pub const WINDOW: usize = 128 + FORCED_BATCH;

/// The most that a move counts to gain: as much as 3,400 mm/s from rest. The sum over a full window then fits 63 bits.
const MOST_GAIN: u64 = 50_000_000_000_000_000;

/// A move in the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planned {
    pub end: [Steps; 4],
    pub vector: Geometry,
    /// The part of its length in which it may accelerate and brake, unless its ends ask for more.
    pub ramps: u64,
    /// Commanded speed before the feed override; 0 if overrides have no say.
    pub feed: MmPerSec,
    pub nominal: MmPerSec,
    pub acceleration: MmPerSec2,
    /// Greatest speed squared that the corner before it allows.
    pub corner: u64,
    /// Greatest speed squared at that corner, by the nominal speeds of the two moves too.
    pub cap: u64,
    /// G of the window's formula, wrapping.
    pub before: u64,
    /// Speed squared at its end, if that was settled when it was made to leave.
    pub exit: Option<u64>,
    /// Time at nominal speed, in ticks.
    pub nominal_ticks: u32,
    pub watch: EndstopSet,
    /// The advance that its filament needs.
    pub advance: Seconds,
}

const _: () = assert!(core::mem::size_of::<Planned>() <= 128);

impl Planned {
    fn gain(&self) -> u64 {
        gain(self.acceleration, self.vector.length).min(MOST_GAIN)
    }

    /// `cap + G` of the window's formula.
    fn bound(&self) -> u64 {
        self.cap.wrapping_add(self.before)
    }

    /// The nominal speed squared.
    pub fn nominal_sq(&self) -> u64 {
        u64::from(self.nominal.to_bits()) * u64::from(self.nominal.to_bits())
    }

    /// The speed squared above which the corner behind it must not be; none at all behind a move that an endstop may
    /// end.
    pub fn passed_on(&self) -> u64 {
        if self.watch.is_empty() { self.nominal_sq() } else { 0 }
    }

    /// Takes `wanted` as its nominal speed, as far as the axes and the motors allow.
    #[inline(never)]
    pub fn set_nominal(&mut self, wanted: MmPerSec, belts: &Belts, settings: &Settings) {
        self.nominal = self.vector.speed_limit(wanted, belts, settings);
        let seconds = from_bits(self.vector.length) / speed(self.nominal);
        self.nominal_ticks = (seconds * const { TICKS_PER_SECOND as f32 }) as u32;
    }

    /// Takes a new cap behind a move that passes on `before`.
    pub fn limit_entry(&mut self, before: u64) {
        self.cap = if self.watch.is_empty() { self.corner.min(before).min(self.nominal_sq()) } else { 0 };
    }
}

/// Whether `a` is less than `b`, both of which wrap.
const fn is_less(a: u64, b: u64) -> bool {
    (a.wrapping_sub(b) as i64) < 0
}

/// Memory for the moves of a window.
pub struct MoveMemory(Deque<Planned, WINDOW>);

impl MoveMemory {
    /// Without moves.
    #[must_use]
    pub const fn new() -> Self {
        Self(Deque::new())
    }
}

impl Default for MoveMemory {
    fn default() -> Self {
        Self::new()
    }
}

pub(super) struct Window<'m> {
    moves: &'m mut Deque<Planned, WINDOW>,
    /// Numbers of the moves whose corners are less than all behind them, in `cap + G`.
    minima: Deque<u16, WINDOW>,
    /// The number of the first move; wraps.
    first: u16,
    /// G behind the last move.
    sum: u64,
    /// So many moves leave though they may not be final.
    forced: usize,
    /// What speeds they leave with is not settled yet.
    is_unsettled: bool,
    /// Speed squared at the end of the last move that left.
    front: u64,
}

impl<'m> Window<'m> {
    pub const fn new(memory: &'m mut MoveMemory) -> Self {
        Self { moves: &mut memory.0, minima: Deque::new(), first: 0, sum: 0, forced: 0, is_unsettled: false, front: 0 }
    }

    pub fn len(&self) -> usize {
        self.moves.len()
    }

    pub fn is_empty(&self) -> bool {
        self.moves.is_empty()
    }

    /// Whether no further move fits.
    pub fn is_full(&self) -> bool {
        self.moves.is_full()
    }

    /// Adds a move; the caller has made room.
    pub fn push(&mut self, mut planned: Planned) {
        self.settle();
        let number = self.first.wrapping_add(self.moves.len() as u16);
        planned.before = self.sum;
        self.note(number, planned.bound());
        self.sum = self.sum.wrapping_add(planned.gain());
        let pushed = self.moves.push_back(planned);
        debug_assert!(pushed.is_ok(), "the caller has made room");
    }

    /// Notes the corner before a move, behind which there is none yet.
    fn note(&mut self, number: u16, bound: u64) {
        while self.minima.back().is_some_and(|other| !is_less(self.bound(*other), bound)) {
            self.minima.pop_back();
        }
        let noted = self.minima.push_back(number);
        debug_assert!(noted.is_ok(), "there are as many places as for moves");
    }

    /// `cap + G` of the move of that number.
    fn bound(&self, number: u16) -> u64 {
        self.moves.get(usize::from(number.wrapping_sub(self.first))).map_or(0, Planned::bound)
    }

    /// Forgets every move; the machine stands.
    pub fn clear(&mut self) {
        self.moves.clear();
        self.minima.clear();
        (self.sum, self.forced, self.is_unsettled, self.front) = (0, 0, false, 0);
    }

    /// The number of the move with the least corner behind the move of that index. The minima stand in order.
    fn least_behind(&self, index: usize) -> Option<u16> {
        if index == 0 {
            // Asked for every move that leaves; the first may be among them.
            let is_first = self.minima.front() == Some(&self.first);
            return self.minima.get(usize::from(is_first)).copied();
        }
        let is_behind = |number: u16| usize::from(number.wrapping_sub(self.first)) > index;
        let (mut low, mut high) = (0, self.minima.len());
        while low < high {
            let middle = low.midpoint(high);
            if self.minima.get(middle).is_some_and(|number| is_behind(*number)) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        self.minima.get(low).copied()
    }

    /// The greatest speed squared behind the move of that index, which is entered with `entry`, and whether that is final;
    /// `None` if no move is behind it.
    fn exit(&self, index: usize, entry: u64) -> Option<(u64, bool)> {
        let (this, next) = (self.moves.get(index)?, self.moves.get(index + 1)?.before);
        let bound = self.bound(self.least_behind(index)?).wrapping_sub(next);
        let reach = entry.saturating_add(next.wrapping_sub(this.before));
        let (known, end) = (bound.min(reach), self.sum.wrapping_sub(next));
        Some((known.min(end), known <= end))
    }

    /// Whether the first move may leave.
    pub fn has_ready(&self) -> bool {
        self.forced > 0 || self.exit(0, self.front).is_some_and(|(_, is_final)| is_final)
    }

    /// Lets the first `count` moves leave though they may not be final.
    pub fn force(&mut self, count: usize) {
        let count = count.min(self.moves.len());
        if count > self.forced {
            (self.forced, self.is_unsettled) = (count, true);
        }
    }

    /// Settles the speeds of the moves that were made to leave, or they would depend on what is added until they do.
    fn settle(&mut self) {
        if !core::mem::take(&mut self.is_unsettled) {
            return;
        }
        let mut entry = self.front;
        for index in 0..self.forced {
            let planned = self.exit(index, entry).map_or(0, |(exit, _)| exit);
            let Some(this) = self.moves.get_mut(index) else { break };
            entry = *this.exit.get_or_insert(planned);
        }
    }

    /// Nominal time of the moves that are final, in ticks. Looks at all of them.
    pub fn final_time(&self) -> u64 {
        let (mut time, mut total, mut entry) = (0, 0, self.front);
        for (index, planned) in self.moves.iter().enumerate() {
            let Some((exit, is_final)) = self.exit(index, entry) else { break };
            total += u64::from(planned.nominal_ticks);
            if is_final {
                time = total;
            }
            entry = exit;
        }
        time
    }

    /// Takes the first move if it may leave, and says its nominal time; the filament of the last one ended at
    /// `filament`.
    pub fn pop(&mut self, filament: Steps) -> Option<(Move, u32)> {
        let exit = self.exit(0, self.front);
        if self.forced == 0 && !exit.is_some_and(|(_, is_final)| is_final) {
            return None;
        }
        let first = self.moves.pop_front()?;
        self.forced = self.forced.saturating_sub(1);
        if self.minima.front() == Some(&self.first) {
            self.minima.pop_front();
        }
        self.first = self.first.wrapping_add(1);
        let exit = exit.map(|(exit, _)| first.exit.unwrap_or(exit));
        // Planned as `min`, so the ramps fit but for what squares and roots round away.
        let speeds = Speeds { entry: self.front, nominal: first.nominal_sq(), exit: exit.unwrap_or_default() };
        self.front = speeds.exit;
        let released = profile((first.vector.length, first.ramps), first.acceleration, speeds, first.end, first.watch);
        let [_, _, _, end] = first.end;
        let way = i128::from(end.wrapping_sub(filament).to_bits()) * i128::from(first.advance.to_bits());
        let advance = Steps::from_bits((way >> Seconds::FRAC_NBITS) as i64);
        Some((Move { advance, rests: exit.is_none(), ..released }, first.nominal_ticks))
    }

    /// Has `change` change every move, and plans anew. A speed that is too great now is braked away as fast as the
    /// accelerations allow, so it counts as a cap until then; it was below all caps when it was planned.
    pub fn change(&mut self, mut change: impl FnMut(&mut Planned)) {
        let (mut passed_on, mut least, mut sum) = (u64::MAX, self.front, 0u64);
        for planned in self.moves.iter_mut() {
            change(planned);
            planned.limit_entry(passed_on);
            planned.cap = planned.cap.max(least);
            planned.before = sum;
            planned.exit = None;
            sum = sum.wrapping_add(planned.gain());
            least = least.saturating_sub(planned.gain());
            passed_on = planned.passed_on();
        }
        self.sum = sum;
        (self.forced, self.is_unsettled) = (0, false);
        self.minima.clear();
        for i in 0..self.moves.len() as u16 {
            let number = self.first.wrapping_add(i);
            self.note(number, self.bound(number));
        }
    }

    /// The last move.
    pub fn last(&self) -> Option<&Planned> {
        self.moves.back()
    }

    /// Nominal time of all moves, in ticks.
    pub fn time(&self) -> u64 {
        self.moves.iter().map(|m| u64::from(m.nominal_ticks)).sum()
    }
}
