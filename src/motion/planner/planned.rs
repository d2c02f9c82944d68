//! A move in the look-ahead, and the memory for a window of them.

use super::profile::MoveSpec;
use crate::motion::number::{feed_speed, mm};
use crate::units::{Feed, SpeedSq, TICKS_PER_SECOND};

/// Moves that stay in the window when a forced batch has left it: the look-ahead sees at least this many, when the
/// stream is fast enough.
const LEAST_LOOKAHEAD: usize = 128;

/// Moves that leave when the window is full and the first is not final: several at a time, so that the MoveQueue has
/// enough while the window fills again. A part of the window, in addition to [`LEAST_LOOKAHEAD`].
pub const FORCED_BATCH: usize = 16;

/// Capacity of the window, in moves. Its memory is [`MoveMemory`]; docs/explanation/flow.md lists its effects.
pub const LOOKAHEAD_MOVES: usize = LEAST_LOOKAHEAD + FORCED_BATCH;
const _: () =
    assert!(FORCED_BATCH > 0 && FORCED_BATCH < LEAST_LOOKAHEAD, "a forced batch is a small part of the window");

/// Places in the ring of [minima](super::window::Minima), one for each value of the bytes that count them. A slot is
/// kept in a byte too.
pub(in crate::motion) const MINIMA_PLACES: usize = 1 << u8::BITS;
const _: () = assert!(LOOKAHEAD_MOVES < MINIMA_PLACES, "more moves need wider indices than u8 in Minima");

/// The most that a move counts to gain: as much as 3,400 mm/s from rest. The sum over a full window then fits 63 bits.
const MOST_GAIN_SQ: SpeedSq = SpeedSq(50_000_000_000_000_000);
const _: () = assert!(MOST_GAIN_SQ.0 <= i64::MAX as u64 / LOOKAHEAD_MOVES as u64);

/// A move in the window.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct Planned {
    pub spec: MoveSpec,
    /// Commanded speed before the feed override; 0 if overrides have no say.
    pub feed: Feed,
    /// Greatest speed squared that the corner before it allows, by its geometry alone.
    pub junction_sq: SpeedSq,
    /// Greatest entry speed squared: limited by the junction and by the nominal speeds of the two moves.
    pub max_entry_sq: SpeedSq,
    /// The possible gain of all moves before it, G of the [window](super::window)'s formula; wraps.
    pub cumulative_gain_sq: SpeedSq,
    /// G at the end of the window when the move was forced to leave, if it was.
    pub forced_end_sq: SpeedSq,
    /// Time at nominal speed, in ticks.
    pub nominal_ticks: u32,
}

const _: () = assert!(core::mem::size_of::<Planned>() <= 104);

impl Planned {
    const NONE: Self = Self {
        spec: MoveSpec::NONE,
        feed: Feed::ZERO,
        junction_sq: SpeedSq::ZERO,
        max_entry_sq: SpeedSq::ZERO,
        cumulative_gain_sq: SpeedSq::ZERO,
        forced_end_sq: SpeedSq::ZERO,
        nominal_ticks: 0,
    };

    /// Its possible gain of speed squared.
    #[inline(always)]
    pub fn gain_sq(&self) -> SpeedSq {
        SpeedSq::gained(self.spec.acceleration, self.spec.length).min(MOST_GAIN_SQ)
    }

    /// `m + G` of the window's formula; wraps.
    #[inline(always)]
    pub fn bound_sq(&self) -> SpeedSq {
        self.max_entry_sq.wrapping_add(self.cumulative_gain_sq)
    }

    /// The nominal speed squared.
    #[inline(always)]
    fn nominal_sq(&self) -> SpeedSq {
        SpeedSq::of(self.spec.nominal.into())
    }

    /// The greatest exit speed squared that this move allows; 0 for a move that an endstop may end.
    #[inline(always)]
    pub fn exit_limit_sq(&self) -> SpeedSq {
        if self.spec.own.watch().is_empty() { self.nominal_sq() } else { SpeedSq::ZERO }
    }

    /// Takes `wanted` as its nominal speed, within the limits of the axes and the motors.
    #[inline(always)]
    pub fn set_nominal(&mut self, wanted: Feed) {
        // A move that was requested does not stand still.
        self.spec.nominal = wanted.min(self.spec.max_speed).max(Feed::DELTA);
        let seconds = mm(self.spec.length) / feed_speed(self.spec.nominal);
        self.nominal_ticks = (seconds * const { TICKS_PER_SECOND as f32 }) as u32;
    }

    /// Takes a new greatest entry speed, after a move that has this limit for its exit speed.
    #[inline(always)]
    pub fn limit_entry(&mut self, previous_exit_limit_sq: SpeedSq) {
        self.max_entry_sq = if self.spec.own.watch().is_empty() {
            self.junction_sq.min(previous_exit_limit_sq).min(self.nominal_sq())
        } else {
            SpeedSq::ZERO
        };
    }
}

/// Memory for the moves of a window.
pub struct MoveMemory {
    pub(in crate::motion) moves: [Planned; LOOKAHEAD_MOVES],
    /// Slots of moves; see [`Window`](super::window::Window).
    pub(in crate::motion) minima: [u8; MINIMA_PLACES],
}

impl MoveMemory {
    /// Without moves.
    #[must_use]
    pub const fn new() -> Self {
        Self { moves: [Planned::NONE; LOOKAHEAD_MOVES], minima: [0; MINIMA_PLACES] }
    }
}

impl Default for MoveMemory {
    fn default() -> Self {
        Self::new()
    }
}
