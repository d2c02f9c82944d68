//! Dispatch of every command.
//!
//! ```text
//!   Command ──▶ moves, or table: a file each ──▶ Answer
//! ```
//!
//! Each is polled by a function of its own (`apart`). In one function they took 7.3 KB more of an image.

use super::malformed::report_malformed;
use super::table;
use crate::gcode::{Absent, Command, Flaw, Mark, Named, Part};
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::print::detour::{begin_line, end_line};
use crate::machine::print::job::{end_job, refuse, starts_print};
use crate::machine::print::named_texts::{Called, call_line};
use crate::machine::print::pause::{end_holding, hold};
use crate::machine::state::held_line::{Answered, HoldReason};
use crate::machine::state::job::JobEnd;
use crate::machine::state::notices::Notices;
use crate::machine::states::{States, tell_clamps};
use crate::machine::travel::moves::Moves;
use crate::port::Wake;
use core::pin::pin;

/// Resumes the print of a held line, if possible. True: carry out the line now; false: it needs its `ok` alone; `None`:
/// keep it for longer.
pub(in crate::machine) async fn go_on_with<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    held: HoldReason,
    answered: Answered,
) -> Result<Option<bool>, Interrupt> {
    apart(pin!(end_holding(main_loop, states, held, answered))).await
}

/// Carries out a command, reports values out of range, and returns the answer to send before its `ok`.
pub(in crate::machine) async fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &Command<'a>,
) -> Result<Answer<'a>, Interrupt> {
    states.clamps.clear();
    if !states.texts.is_of_cancel
        && let Some(answer) = refuse(main_loop, command)
    {
        return Ok(answer);
    }
    if main_loop.job.is_paused() {
        begin_line(main_loop, &mut states.modal, command);
    }
    let done = match *command {
        Command::Move(ref command) => apart(pin!(Moves { main_loop, states }.make(command))).await,
        Command::Table(ref command) => apart(pin!(table::carry_out(main_loop, states, command))).await,
        Command::Condition => {
            main_loop.job.note_end(JobEnd::Conditional);
            Err(Interrupt::EndJob)
        }
        Command::Silent => Ok(Answer::Nothing),
        Command::Malformed(Flaw::Absent(absent)) if !states.notices.give_absent(absent.key()) => Ok(Answer::Nothing),
        Command::Malformed(flaw) => {
            main_loop.tell(|to, _| report_malformed(to, &flaw));
            Ok(Answer::Said)
        }
        Command::Unknown(text) => Ok(unknown(main_loop, states, text)),
    };
    match done {
        // `power` has reported the reason.
        Err(Interrupt::NoPower) => Ok(Answer::Nothing),
        Err(Interrupt::EndJob) => {
            let why = main_loop.job.why_it_ends();
            let answer = apart(pin!(end_job(main_loop, &mut states.modal, why))).await?;
            states.texts.stop_if(main_loop.job.is_ended());
            Ok(answer)
        }
        // A print that goes on without it would print on an unknown bed.
        Ok(Answer::NotHomed) if main_loop.job.is_printing() && is_about_bed(command) => {
            hold(main_loop, &states.modal, HoldReason::Lost([true; 3])).await?;
            Ok(Answer::Held)
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

/// A line that is no command: the owner's text, or unknown.
fn unknown<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    text: &'a [u8],
) -> Answer<'a> {
    match call_line(main_loop, states, text) {
        Called::Taken => return Answer::Nothing,
        Called::Inside => return Answer::Line(packed!("echo:ignored: a text calls itself")),
        Called::Unknown => {}
    }
    note_unknown(main_loop, text);
    if tells_unknown(&mut states.notices, text) { Answer::Unknown(text) } else { Answer::Nothing }
}

/// Whether an unknown line is told. Klipper's owners give the names of their own macros an underscore, and slicers
/// write one for every layer: each is told once a print.
fn tells_unknown(notices: &mut Notices, text: &[u8]) -> bool {
    let name = text.split(|byte| matches!(byte, b' ' | b'\t' | b';')).next().unwrap_or_default();
    let key = Absent { command: Named::Name("_"), part: Part::Other, which: name }.key();
    !matches!(name, [b'_', ..]) || notices.give_absent(key)
}

/// Whether a command finds out about the bed.
const fn is_about_bed(command: &Command<'_>) -> bool {
    matches!(command, Command::Table(command) if command.has_mark(Mark::FindsBed))
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
