//! The progress of the passes over the look-ahead; see [`passes`](super::passes).

use crate::units::SpeedSq;

/// The progress of the passes.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct Passes {
    /// The index of the next move to plan again, and the limit of the exit speed squared of the move before it.
    pub replan: Option<(usize, SpeedSq)>,
    pub frozen: Cursor,
    pub counted: FinalCount,
}

/// A move, by its index, and the speed squared at which it is entered.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct Cursor {
    pub index: usize,
    pub entry_sq: SpeedSq,
}

/// The moves known to be final.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct FinalCount {
    pub next: Cursor,
    /// Their nominal time, in ticks.
    pub ticks: u64,
    /// The next one is not final.
    pub is_done: bool,
}

impl Cursor {
    /// The first move leaves, with that exit speed squared.
    #[inline(always)]
    pub const fn pop(&mut self, exit_sq: SpeedSq) {
        match self.index {
            0 => self.entry_sq = exit_sq,
            _ => self.index -= 1,
        }
    }
}

impl FinalCount {
    /// None; motion continues with that speed squared.
    pub const fn new(front_sq: SpeedSq) -> Self {
        Self { next: Cursor { index: 0, entry_sq: front_sq }, ticks: 0, is_done: false }
    }
}

impl Passes {
    /// Nothing to do.
    pub const NONE: Self = Self {
        replan: None,
        frozen: Cursor { index: 0, entry_sq: SpeedSq::ZERO },
        counted: FinalCount::new(SpeedSq::ZERO),
    };

    /// Moves were made to leave; the first of them has this entry speed squared.
    pub const fn begin_freeze(&mut self, front_sq: SpeedSq) {
        self.frozen = Cursor { index: 0, entry_sq: front_sq };
    }
}
