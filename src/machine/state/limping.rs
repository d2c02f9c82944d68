//! Limping: a motor of the belt has failed, and the others still hold the tool for a little while.
//!
//! | now | then | when |
//! |---|---|---|
//! | no | wanted | a driver fails, and the others may go on without it |
//! | wanted | under way | the command of that moment has ended |
//! | wanted, under way | over | the tool is parked; another fault, M112, M410, or it takes too long |
//!
//! It never begins twice: after it all motors are without power until a reset.

use crate::units::{Instant, Mm};

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stage {
    No,
    Wanted,
    UnderWay,
    Over,
}

/// Its stage.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Limping {
    stage: Stage,
    /// When it ends at the latest.
    until: Instant,
    /// Faults that were known when it began.
    faults: u32,
    /// The lift of z before the tool was parked; none if it was not parked.
    parked: Option<Mm>,
}

impl Limping {
    pub const fn new() -> Self {
        Self { stage: Stage::No, until: Instant(0), faults: 0, parked: None }
    }

    /// A driver has failed; limp mode has to be over at `until`, and `faults` other faults are known.
    pub const fn begin(&mut self, until: Instant, faults: u32) {
        *self = Self { stage: Stage::Wanted, until, faults, parked: None };
    }

    /// Whether every command has to end for it.
    pub const fn is_wanted(&self) -> bool {
        matches!(self.stage, Stage::Wanted)
    }

    /// The command has ended.
    pub const fn go(&mut self) {
        self.stage = Stage::UnderWay;
    }

    /// Whether motors have power although there is a fault: no more faults are known than at its begin.
    pub const fn allows(&self, faults: u32) -> bool {
        matches!(self.stage, Stage::Wanted | Stage::UnderWay) && self.faults == faults
    }

    /// Whether it is under way.
    pub const fn is_under_way(&self) -> bool {
        matches!(self.stage, Stage::Wanted | Stage::UnderWay)
    }

    /// Whether it takes too long.
    pub fn is_late(&self, now: Instant) -> bool {
        self.is_under_way() && now >= self.until
    }

    /// The tool is parked, with z raised by so much.
    pub const fn park(&mut self, raised: Mm) {
        self.parked = Some(raised);
    }

    /// Ends it; true if it was under way.
    pub fn end(&mut self) -> bool {
        let was = self.is_under_way();
        if was {
            self.stage = Stage::Over;
        }
        was
    }

    /// The outcome, if it ever began: the lift of z before the tool was parked, or `None` if it was not parked.
    pub const fn outcome(&self) -> Option<Option<Mm>> {
        if matches!(self.stage, Stage::No) { None } else { Some(self.parked) }
    }
}
