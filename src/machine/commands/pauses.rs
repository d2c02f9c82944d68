//! Pauses: the machine waits for its user, or asks the host to wait.
//!
//! A stream belongs to its host, so M25 and M24 only tell the hosts (`// action:paused`, `// action:resumed`) and
//! hold nothing up: what a host sends in between, to jog or to heat, is carried out. M0, M1, M600 and M601 stand in
//! the stream itself and keep their `ok` back until the user is ready. The tool stays where it is, and so does the
//! power of the motors.

use crate::machine::console::{Console, Interrupt, PortSet};
use crate::machine::reports::answer::Answer;
use crate::port::{Clock, Pend};

/// The print is paused.
const PAUSED: &str = "// action:paused";

/// The print goes on.
const RESUMED: &str = "// action:resumed";

/// A question to the user begins.
const ASK: &str = "// action:prompt_begin Paused";
const ASK_FOR_FILAMENT: &str = "// action:prompt_begin Change the filament";

/// Nobody need answer any more.
const PROMPT_END: &str = "// action:prompt_end";

/// What a command waits for beside the motion, and what has come of it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Wait {
    /// It waits for the user.
    pub is_for_user: bool,
    /// M108 came since the command began, or while it waited for the user one of M24, M602 and M876.
    pub is_over: bool,
    /// M24, M602 or M876 came since the command began.
    pub is_answered: bool,
    /// It lets time pass (G4); nothing moves.
    pub is_dwelling: bool,
}

impl Wait {
    pub const fn new() -> Self {
        Self { is_for_user: false, is_over: false, is_answered: false, is_dwelling: false }
    }
}

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Says the same to all hosts. One that is not being served and has no room for it misses it.
    async fn announce(&mut self, lines: &[&'static str]) -> Result<(), Interrupt> {
        for line in lines {
            self.hosts.tell_others(format_args!("{line}"));
            self.tell(Answer::Line(line)).await?;
        }
        Ok(())
    }

    /// M0, M1, M600, M601: lets the motion end, and waits for M108, M24, M602 or an answer, or for `ms`.
    pub(in crate::machine) async fn await_user(&mut self, ms: u32, filament: bool) -> Result<(), Interrupt> {
        self.finish().await?;
        let question = if filament { ASK_FOR_FILAMENT } else { ASK };
        self.announce(&[PAUSED, question, "// action:prompt_button Continue", "// action:prompt_show"]).await?;
        let end = self.ports.clock.now().after_ms(ms);
        // An answer that came in one packet with the command counts.
        self.wait.is_over |= self.wait.is_answered;
        self.wait.is_for_user = true;
        while !(self.wait.is_over || (ms > 0 && self.ports.clock.now() >= end)) {
            if let Err(interrupt) = self.turn().await {
                self.wait.is_for_user = false;
                self.hosts.tell_all(format_args!("{PROMPT_END}"));
                return Err(interrupt);
            }
        }
        self.wait.is_for_user = false;
        self.announce(&[PROMPT_END, RESUMED]).await
    }

    /// M25. The hosts are told first, so that they stop sending while the motion ends.
    pub(in crate::machine) async fn pause(&mut self) -> Result<(), Interrupt> {
        self.is_paused = true;
        self.announce(&[PAUSED]).await?;
        self.finish().await
    }

    /// M24, M602. Where it has ended another command's wait, that command has told the hosts.
    pub(in crate::machine) async fn resume(&mut self) -> Result<(), Interrupt> {
        if core::mem::take(&mut self.is_paused) {
            self.announce(&[RESUMED]).await?;
        }
        Ok(())
    }
}
