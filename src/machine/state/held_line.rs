//! A line that is held without `ok`: why, and the answer that it waits for.

use super::pauses::Pauses;
use crate::units::Instant;

/// Why a line is held without `ok`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum HoldReason {
    /// It waits for the user, or until then.
    User(Option<Instant>),
    /// Carry it out when the hotend is warm enough.
    Cold,
    /// It has failed. Carry it out again when the user goes on.
    Failed,
    /// Carry it out when these axes are homed again.
    Lost([bool; 3]),
}

/// How a held line continues.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Answered {
    /// M108, or its time has passed: continue in any case.
    GoOn,
    /// M24, M602, M876 S: when it can be.
    Resume,
}

/// The line that is held, if one is, and its answer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct HeldLine {
    reason: Option<HoldReason>,
    answered: Option<Answered>,
}

impl HeldLine {
    pub const fn new() -> Self {
        Self { reason: None, answered: None }
    }

    /// The line that is being carried out is held without `ok`, and others are served. An answer that came in one
    /// packet with it counts.
    pub fn hold(&mut self, reason: HoldReason, pauses: &Pauses) {
        let answered =
            if pauses.is_answered() { Some(Answered::Resume) } else { pauses.is_over().then_some(Answered::GoOn) };
        *self = Self { reason: Some(reason), answered };
    }

    /// It stays held, and waits for another answer.
    pub const fn hold_on(&mut self, reason: HoldReason) {
        *self = Self { reason: Some(reason), answered: None };
    }

    /// Why a line is held, if one is.
    pub const fn reason(&self) -> Option<HoldReason> {
        self.reason
    }

    /// No line is held any more.
    pub const fn take(&mut self) -> Option<HoldReason> {
        self.answered = None;
        self.reason.take()
    }

    /// Notes the answers for a held line: M108, and M24, M602 or M876.
    pub const fn note_answers(&mut self, go_on: bool, resume: bool) {
        if self.reason.is_none() {
            return;
        }
        if resume {
            self.answered = Some(Answered::Resume);
        }
        if go_on {
            self.answered = Some(Answered::GoOn);
        }
    }

    /// How the held line continues, if that is known by now. If nothing is paused, the print has ended in the meantime.
    pub fn take_answer(&mut self, now: Instant, is_paused: bool) -> Option<Answered> {
        match self.reason? {
            HoldReason::User(Some(until)) if now >= until => Some(Answered::GoOn),
            _ if !is_paused => Some(Answered::GoOn),
            _ => self.answered.take(),
        }
    }
}
