//! The look-ahead window: moves whose speeds may still change.
//!
//! The speed at the end of the last move is 0, for nobody knows what follows. A backward pass finds for
//! every corner the greatest speed from which the rest can still brake to that 0, a forward pass what can
//! be reached from the front. A corner whose speed is capped by the corner itself, or reached only by
//! accelerating all the way from the front, cannot become faster by moves that are still to come: all moves
//! before the last such corner are **final**, whatever follows.
//!
//! Final moves may leave the window sooner or later without a difference to the steps. When a move must
//! leave that is not final, the outcome would depend on when; so that happens only where the stream of
//! commands itself says so (the window is full of unfinished moves, or a command waits for the motion), or
//! when the stream is dry.

use crate::motion::geometry::Geometry;
use crate::motion::moves::Move;
use crate::motion::profile::{Speeds, gain, profile};
use crate::port::EndstopSet;
use crate::settings::Settings;
use crate::units::{MmPerSec, MmPerSec2, Steps, TICKS_PER_SECOND, mul_div};
use heapless::Deque;

/// Moves that the look-ahead sees at least, at all times when the stream is fast enough.
pub const LOOK_AHEAD: usize = WINDOW - FORCED_BATCH;

/// Moves that leave when the window is full and none is final: a few at a time, so that the passes over the
/// window are paid once for several moves.
pub const FORCED_BATCH: usize = 16;

/// Capacity of the window.
pub const WINDOW: usize = 144;

const _: () = assert!(LOOK_AHEAD >= 128);

/// A move in the window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planned {
    pub end: [Steps; 4],
    pub vector: Geometry,
    /// Commanded speed before the feed override; 0 if overrides have no say.
    pub feed: MmPerSec,
    pub nominal: MmPerSec,
    pub acceleration: MmPerSec2,
    /// Greatest speed squared that the corner before it allows.
    pub corner: u64,
    /// Greatest speed squared at that corner, by the nominal speeds of the two moves too.
    pub cap: u64,
    /// Speed squared at the corner before it, as planned so far.
    pub entry: u64,
    /// Time at nominal speed, in ticks.
    pub nominal_ticks: u32,
    pub watch: EndstopSet,
}

const _: () = assert!(core::mem::size_of::<Planned>() <= 112);

impl Planned {
    fn gain(&self) -> u64 {
        gain(self.acceleration, self.vector.length)
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

    /// Takes `speed` as its nominal speed, as far as the axes and the motors allow.
    pub fn set_nominal(&mut self, speed: MmPerSec, settings: &Settings) {
        self.nominal = self.vector.speed_limit(speed, settings);
        let time = mul_div(self.vector.length, u64::from(TICKS_PER_SECOND), u64::from(self.nominal.to_bits()) << 16);
        self.nominal_ticks = time.min(u64::from(u32::MAX)) as u32;
    }

    /// Takes a new cap behind a move that passes on `before`.
    pub fn limit_entry(&mut self, before: u64) {
        self.cap = if self.watch.is_empty() { self.corner.min(before).min(self.nominal_sq()) } else { 0 };
    }
}

pub(super) struct Window {
    moves: Deque<Planned, WINDOW>,
    /// The first so many may leave; their speeds are planned.
    ready: usize,
    /// Speed squared at the end of the last move that left.
    front: u64,
}

impl Window {
    pub const fn new() -> Self {
        Self { moves: Deque::new(), ready: 0, front: 0 }
    }

    pub fn len(&self) -> usize {
        self.moves.len()
    }

    pub fn is_empty(&self) -> bool {
        self.moves.is_empty()
    }

    pub fn has_ready(&self) -> bool {
        self.ready > 0
    }

    /// Whether no further move fits.
    pub fn is_full(&self) -> bool {
        self.moves.is_full()
    }

    /// Adds a move; the caller has made room.
    pub fn push(&mut self, planned: Planned) {
        let pushed = self.moves.push_back(planned);
        debug_assert!(pushed.is_ok(), "the caller has made room");
    }

    /// Forgets every move; the machine stands.
    pub fn clear(&mut self) {
        self.moves.clear();
        self.ready = 0;
        self.front = 0;
    }

    /// Plans the speeds of all moves and finds how many are final. Two passes over the window.
    pub fn plan(&mut self) {
        let mut exit = 0u64;
        for planned in self.moves.iter_mut().rev() {
            planned.entry = planned.cap.min(exit.saturating_add(planned.gain()));
            exit = planned.entry;
        }
        let mut reached = self.front;
        let mut accelerating = true;
        self.ready = 0;
        for (i, planned) in self.moves.iter_mut().enumerate() {
            if i > 0 {
                let limited = reached < planned.entry;
                accelerating = accelerating && limited;
                if accelerating || reached.min(planned.entry) == planned.cap {
                    self.ready = i;
                }
            }
            planned.entry = planned.entry.min(reached);
            reached = planned.entry.saturating_add(planned.gain());
        }
    }

    /// Has `change` change every move, and plans anew. A speed that is too great now is braked away as fast as the
    /// accelerations allow, so it counts as a cap until then; it was below all caps when it was planned.
    pub fn change(&mut self, mut change: impl FnMut(&mut Planned)) {
        let mut before = u64::MAX;
        let mut least = self.front;
        for planned in &mut self.moves {
            change(planned);
            planned.limit_entry(before);
            planned.cap = planned.cap.max(least);
            least = least.saturating_sub(planned.gain());
            before = planned.passed_on();
        }
        self.ready = 0;
    }

    /// The last move.
    pub fn last(&self) -> Option<&Planned> {
        self.moves.back()
    }

    /// Nominal time of all moves, in ticks.
    pub fn time(&self) -> u64 {
        self.moves.iter().map(|m| u64::from(m.nominal_ticks)).sum()
    }

    /// Nominal time of the moves that may leave, in ticks.
    pub fn ready_time(&self) -> u64 {
        self.moves.iter().take(self.ready).map(|m| u64::from(m.nominal_ticks)).sum()
    }

    /// Lets the first `count` moves leave though they are not final; call after [`plan`](Self::plan).
    pub fn force(&mut self, count: usize) {
        self.ready = self.ready.max(count.min(self.moves.len()));
    }

    /// Takes the first move if it may leave, and says its nominal time.
    pub fn pop(&mut self) -> Option<(Move, u32)> {
        self.ready = self.ready.checked_sub(1)?;
        let first = self.moves.pop_front()?;
        let exit = self.moves.front().map_or(0, |next| next.entry);
        // Planned as `min`, so the ramps fit but for what squares and roots round away.
        let speeds = Speeds { entry: first.entry, nominal: first.nominal_sq(), exit };
        self.front = exit;
        Some((profile(first.vector.length, first.acceleration, speeds, first.end, first.watch), first.nominal_ticks))
    }
}
