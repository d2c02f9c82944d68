//! Dispatch of every command to its family.
//!
//! ```text
//!   Command ──▶ table, or motion, jobs, settings, motors, probing, bed, resonance, reports, refused ──▶ Answer
//! ```
//!
//! A command with all of it in one file is in the table. Its answer may be a next step, which is awaited here. Each
//! family of the others has one match without a wildcard. So a new command does not compile before it has an arm. The
//! arm gives the answer at once, or awaits it: motion, power, storage, drivers, questions to the user.
//!
//! Each family is polled by a function of its own (`apart`). In one function they took 7.3 KB more of an image.

use super::detour::{begin_line, end_line};
use super::job::{end_job, refuse, starts_print};
use super::pause::{end_keeping, hold};
use super::states::{States, tell_clamps};
use super::waits::take_step;
use super::{bed, jobs, motion, motors, probing, refused, reports, resonance, settings, table};
use crate::gcode::{Command, Flaw};
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::kept_line::{Answered, Kept};
use crate::port::Wake;
use core::pin::pin;

/// Resumes the print of a kept line, if possible. True: carry out the line now; false: it needs its `ok` alone; `None`:
/// keep it for longer.
pub(in crate::machine) async fn go_on_with<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    kept: Kept,
    answered: Answered,
) -> Result<Option<bool>, Interrupt> {
    apart(pin!(end_keeping(main_loop, states, kept, answered))).await
}

/// Carries out a command, reports values out of range, and returns the answer to send before its `ok`.
pub(in crate::machine) async fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &Command<'a>,
) -> Result<Answer<'a>, Interrupt> {
    states.clamps.clear();
    if let Some(answer) = refuse(main_loop, command) {
        return Ok(answer);
    }
    if main_loop.job.is_paused() {
        begin_line(main_loop, &mut states.modal, command);
    }
    let done = match *command {
        Command::Motion(ref command) => apart(pin!(motion::carry_out(main_loop, states, command))).await,
        Command::Job(ref command) => apart(pin!(jobs::carry_out(main_loop, states, command))).await,
        Command::Setting(ref command) => apart(pin!(settings::carry_out(main_loop, states, command))).await,
        Command::Motor(ref command) => apart(pin!(motors::carry_out(main_loop, states, command))).await,
        Command::Probe(ref command) => apart(pin!(probing::carry_out(main_loop, states, command))).await,
        Command::Bed(ref command) => apart(pin!(bed::carry_out(main_loop, states, command))).await,
        Command::Resonance(ref command) => apart(pin!(resonance::carry_out(main_loop, states, command))).await,
        Command::Report(ref command) => apart(pin!(reports::carry_out(main_loop, command))).await,
        Command::Own(ref command) => match table::carry_out(main_loop, states, command) {
            Answer::Then(step) => apart(pin!(take_step(main_loop, states, step))).await,
            answer => Ok(answer),
        },
        Command::Refused(command) => Err(refused::end(main_loop, command)),
        Command::Silent => Ok(Answer::Nothing),
        Command::Malformed(Flaw::Absent(absent)) if !states.notices.give_absent(absent.key()) => Ok(Answer::Nothing),
        Command::Malformed(flaw) => Ok(Answer::Malformed(flaw)),
        Command::Unknown(text) => {
            note_unknown(main_loop, text);
            Ok(Answer::Unknown(text))
        }
    };
    match done {
        // `power` has reported the reason.
        Err(Interrupt::NoPower) => Ok(Answer::Nothing),
        Err(Interrupt::EndJob) => {
            let why = main_loop.job.why_it_ends();
            apart(pin!(end_job(main_loop, &mut states.modal, why))).await
        }
        // A print that goes on without it would print on an unknown bed.
        Ok(Answer::NotHomed) if main_loop.job.is_printing() && is_about_bed(command) => {
            hold(main_loop, &states.modal, Kept::Lost([true; 3])).await?;
            Ok(Answer::Kept)
        }
        Ok(answer) => {
            if matches!(answer, Answer::Nothing) && main_loop.job.is_paused() {
                end_line(main_loop, &mut states.modal, command);
            }
            tell_clamps(main_loop, &mut states.clamps);
            Ok(answer)
        }
        Err(interrupt) => Err(interrupt),
    }
}

/// Whether a command finds out about the bed.
const fn is_about_bed(command: &Command<'_>) -> bool {
    matches!(command, Command::Probe(_) | Command::Bed(_) | Command::Motor(_))
}

/// A name that is unknown may begin or end a print in other firmware.
fn note_unknown<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, text: &[u8]) {
    let host = main_loop.hosts.serving();
    match starts_print(text) {
        Some(true) => main_loop.job.begin_by_unknown_name(host),
        Some(false) if main_loop.job.is_printing() => main_loop.job.end(),
        Some(false) | None => {}
    }
}
