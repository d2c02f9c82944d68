//! Waits: the present command's wait other than for motion, and the events that end it. The wait of a whole print is in
//! [`job`](super::job).

use crate::machine::state::waiting::Waiting;

/// The present command's wait, and its result.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Pauses {
    waiting: Waiting,
    is_over: bool,
    is_answered: bool,
}

impl Pauses {
    pub const fn new() -> Self {
        Self { waiting: Waiting::Nothing, is_over: false, is_answered: false }
    }

    /// The command is over, and with it its wait.
    pub const fn end_command(&mut self) {
        *self = Self::new();
    }

    /// Notes the received answers: `go_on` is M108, which ends any wait; `resume` is M24, M602 or M876, which answer a
    /// question.
    pub const fn note(&mut self, go_on: bool, resume: bool) {
        self.is_over |= go_on;
        self.is_answered |= resume;
    }

    /// The command waits for something.
    pub const fn begin(&mut self, waiting: Waiting) {
        self.waiting = waiting;
    }

    /// The command waits no more.
    pub const fn end(&mut self) {
        self.waiting = Waiting::Nothing;
    }

    /// The wait of the command.
    pub const fn waiting(&self) -> Waiting {
        self.waiting
    }

    /// Whether the command need not wait any more.
    pub const fn is_over(&self) -> bool {
        self.is_over
    }

    /// Whether the user has answered since the command began.
    pub const fn is_answered(&self) -> bool {
        self.is_answered
    }

    /// Whether G4 lets time pass.
    pub const fn is_dwelling(&self) -> bool {
        matches!(self.waiting, Waiting::Time)
    }
}
