//! M25, M125, M24, M602 and Klipper's names: pause the print, continue it, or end it in the pause.

use super::job::end_by_line;
use super::named_texts::{Called, call};
use super::park_words::ParkWords;
use super::pause::{pause, resume};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;

const FAMILY: &str = "Jobs, pauses and waits";

pub(in crate::machine) const PAUSE: Entry = Entry::m(FAMILY, &[25])
    .nature(Nature::Work)
    .does("", "pauses")
    .examples(&[("M25", &["//action:paused action:pause"])]);

/// It parks the tool even if nothing is printed.
pub(in crate::machine) const PARK: Entry = Entry::m(FAMILY, &[125])
    .nature(Nature::Work)
    .does("X Y Z L", "pauses and parks, also without a print")
    .examples(&[("M125", &["//action:paused action:pause"]), ("M125 L1 X20 Z2 P1", &["//action:paused action:pause"])]);

/// M25 in Klipper's words. Hosts hear of it before the tool parks, and stop sending.
pub(in crate::machine) const PAUSE_BY_NAME: Entry = Entry::name(FAMILY, &["PAUSE"])
    .nature(Nature::Work)
    .does("", "M25 in Klipper's words, or the owner's text")
    .examples(&[("PAUSE", &["//action:paused action:pause"])]);

/// M24 in Klipper's words.
pub(in crate::machine) const RESUME_BY_NAME: Entry = Entry::name(FAMILY, &["RESUME"])
    .does("", "M24 in Klipper's words, or the owner's text")
    .examples(&[("RESUME", &[])]);

/// The print was cancelled in its pause, and its host says so.
pub(in crate::machine) const CLEAR: Entry = Entry::name(FAMILY, &["CLEAR_PAUSE"])
    .does("", "ends a paused print, which does not go on; heaters stay as they are")
    .examples(&[("CLEAR_PAUSE", &[])]);

/// A wait for the user is ended on the receive path.
pub(in crate::machine) const RESUME: Entry =
    Entry::m(FAMILY, &[24, 602]).does("", "resumes").examples(&[("M24", &[]), ("M602", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let paused = main_loop.job.is_paused();
    // The owner's text; in itself the name means what is built in.
    let own: &[u8] = match command.code() {
        0 if command.is_named("PAUSE") && !paused => b"PAUSE",
        0 if command.is_named("RESUME") && paused => b"RESUME",
        _ => b"",
    };
    if call(main_loop, states, own, command.text()) == Called::Taken {
        return Ok(Answer::Nothing);
    }
    let (parks, words) = match command.code() {
        25 => (false, ParkWords::default()),
        125 => (true, ParkWords::of_pause(command)),
        _ if command.is_named("PAUSE") => (false, ParkWords::default()),
        _ if command.is_named("CLEAR_PAUSE") => {
            if paused {
                end_by_line(main_loop, &mut states.modal).await?;
            }
            return Ok(Answer::Nothing);
        }
        _ => return resume(main_loop, states).await,
    };
    pause(main_loop, states, parks, &words).await
}
