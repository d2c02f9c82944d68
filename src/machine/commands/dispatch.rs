//! Dispatch of every command: immediate, or one that takes time.
//!
//! ```text
//!   Command ──▶ immediate: one arm each ──┬──▶ Answer
//!                                         └──▶ Blocking ──▶ blocking: one arm each, awaited ──▶ Answer
//! ```
//!
//! Neither match has a wildcard, so a new command does not compile before it has an arm in `immediate`. That arm
//! carries it out or names it as a [`Blocking`](super::blocking::Blocking), which in turn needs an arm in `blocking`.

use super::blocking::carry_out_blocking;
use super::immediate::{Outcome, carry_out_immediate};
use super::job::{end_job, refuse};
use super::pause::end_keeping;
use super::states::States;
use crate::gcode::Command;
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::job::{Answered, Kept};
use crate::port::Pend;

/// Resumes the print of a kept line, if possible. True: carry out the line now; false: it needs its `ok` alone; `None`:
/// keep it for longer.
pub(in crate::machine) async fn go_on_with<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    kept: Kept,
    answered: Answered,
) -> Result<Option<bool>, Interrupt> {
    end_keeping(main_loop, &mut states.modal, &states.cold, kept, answered).await
}

/// Carries out a command, reports values out of range, and returns the answer to send before its `ok`.
pub(in crate::machine) async fn carry_out<'a, P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &Command<'a>,
) -> Result<Answer<'a>, Interrupt> {
    states.clamps.clear();
    if let Some(answer) = refuse(main_loop, command) {
        return Ok(answer);
    }
    let done = match carry_out_immediate(main_loop, states, command) {
        Outcome::Done(answer) => Ok(answer),
        Outcome::TakesTime(command) => carry_out_blocking(main_loop, states, command).await,
    };
    match done {
        // `power` has reported the reason.
        Err(Interrupt::NoPower) => Ok(Answer::Nothing),
        Err(Interrupt::EndJob) => {
            let why = main_loop.job.why_it_ends();
            end_job(main_loop, &mut states.modal, why).await
        }
        Ok(answer) => main_loop.reply_clamps(&mut states.clamps).await.map(|()| answer),
        Err(interrupt) => Err(interrupt),
    }
}
