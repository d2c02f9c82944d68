//! Pauses: what a command waits for beside the motion, and whether the print is paused.
//!
//! A stream belongs to its host, so M25 and M24 only tell the hosts (`//action:paused`, `//action:resumed`) and
//! hold nothing up: what a host sends in between, to jog or to heat, is carried out. M0, M1, M600 and M601 stand in
//! the stream itself and keep their `ok` back until the user is ready. The tool stays where it is, and so does the
//! power of the motors. G4 waits too, for time alone.

use crate::machine::state::waiting::Waiting;

/// What the present command waits for, and what has come of it; and whether the print is paused.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Pauses {
    waiting: Waiting,
    is_over: bool,
    is_answered: bool,
    is_print_paused: bool,
}

impl Pauses {
    pub const fn new() -> Self {
        Self { waiting: Waiting::Nothing, is_over: false, is_answered: false, is_print_paused: false }
    }

    /// The command is over, and with it whatever it waited for.
    pub const fn end_command(&mut self) {
        *self = Self { is_print_paused: self.is_print_paused, ..Self::new() };
    }

    /// What has arrived: `go_on` is M108, which ends any wait; `resume` is M24, M602 or M876, which end that for the user.
    pub const fn note(&mut self, go_on: bool, resume: bool) {
        self.is_over |= go_on || (resume && self.is_for_user());
        self.is_answered |= resume;
    }

    /// The command waits for the user. An answer that came in one packet with the command counts.
    pub const fn begin_for_user(&mut self) {
        self.is_over |= self.is_answered;
        self.waiting = Waiting::User;
    }

    /// The command waits for something else.
    pub const fn begin(&mut self, waiting: Waiting) {
        self.waiting = waiting;
    }

    /// The command waits no more.
    pub const fn end(&mut self) {
        self.waiting = Waiting::Nothing;
    }

    /// What the command waits for.
    pub const fn waiting(&self) -> Waiting {
        self.waiting
    }

    /// Whether the command waits for the user.
    pub const fn is_for_user(&self) -> bool {
        matches!(self.waiting, Waiting::User)
    }

    /// Whether the command need not wait any more.
    pub const fn is_over(&self) -> bool {
        self.is_over
    }

    /// Whether G4 lets time pass.
    pub const fn is_dwelling(&self) -> bool {
        matches!(self.waiting, Waiting::Time)
    }

    /// M25.
    pub const fn pause_print(&mut self) {
        self.is_print_paused = true;
    }

    /// M24, M602; true if the print was paused.
    pub const fn resume_print(&mut self) -> bool {
        core::mem::replace(&mut self.is_print_paused, false)
    }

    /// M25 has paused the print, and no M24 has resumed it.
    pub const fn is_print_paused(&self) -> bool {
        self.is_print_paused
    }
}
