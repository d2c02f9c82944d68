//! M108, M112, M524, CANCEL_PRINT, M876, M999: the receive path acts on them at once, whatever stands behind them.

use super::named_texts::{Called, call};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Mark, Nature};

const FAMILY: &str = "Jobs, pauses and waits";

pub(in crate::machine) const CANCEL: Entry = Entry::m(FAMILY, &[524])
    .nature(Nature::Report)
    .does("", "cancels the job; acts at once")
    .examples(&[("M524", &["echo:cancelled, heaters are off"])]);

pub(in crate::machine) const CANCEL_BY_NAME: Entry = Entry::name(FAMILY, &["CANCEL_PRINT"])
    .nature(Nature::Report)
    .does("", "M524 in Klipper's words, then the owner's text; acts at once")
    .examples(&[("CANCEL_PRINT", &["echo:cancelled, heaters are off"])]);

/// It also ends the refusal of lines of a print that the firmware has ended (`job::refuse`).
pub(in crate::machine) const CONTINUE: Entry = Entry::m(FAMILY, &[108])
    .nature(Nature::Report)
    .mark(Mark::ActsInUpload)
    .does("", "ends the present wait; acts at once")
    .examples(&[("M108", &[])]);

pub(in crate::machine) const ANSWER: Entry = Entry::m(FAMILY, &[876])
    .mark(Mark::ActsInUpload)
    .does("S P", "answer to a question; acts at once")
    .examples(&[("M876 S0", &[]), ("M876 P1", &[])]);

pub(in crate::machine) const STOP: Entry =
    Entry::m(FAMILY, &[112]).nature(Nature::Report).mark(Mark::ActsInUpload).does("", "stops everything; acts at once");

/// It has no effect unless the machine is halted.
pub(in crate::machine) const RESTART: Entry = Entry::m(FAMILY, &[999])
    .nature(Nature::Report)
    .mark(Mark::ActsInUpload)
    .does("", "starts again after a stop")
    .examples(&[("M999", &[])]);

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if command.is_named("CANCEL_PRINT") {
        // The print has ended, as this line came; now the owner's text is carried out.
        let is_ended = main_loop.job.is_ended();
        if call(main_loop, states, b"CANCEL_PRINT", command.text()) == Called::Taken {
            states.texts.is_of_cancel = is_ended && states.texts.is_running();
        }
    }
    if command.code() == 112 { Err(Interrupt::Halt) } else { Ok(Answer::Nothing) }
}
