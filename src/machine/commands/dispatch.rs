//! Every command, on one of two ways: what is done at once, and what takes time.
//!
//! ```text
//!   Command ──▶ immediate: one arm each ──┬──▶ Answer
//!                                         └──▶ Blocking ──▶ blocking: one arm each, awaited ──▶ Answer
//! ```
//!
//! Neither match has a wildcard, so a new command does not compile before it has an arm in `immediate`: it is done
//! there, or it is named as a [`Blocking`](super::blocking::Blocking), which does not compile before it has an arm in `blocking`.

use super::immediate::Outcome;
use crate::gcode::Command;
use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::port::Pend;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// Carries out a command, and returns what there is to say before its `ok`.
    pub(in crate::machine) async fn execute<'a>(&mut self, command: &Command<'a>) -> Result<Answer<'a>, Interrupt> {
        match self.carry_out_immediate(command) {
            Outcome::Done(answer) => Ok(answer),
            Outcome::TakesTime(command) => self.carry_out_blocking(command).await,
        }
    }
}
