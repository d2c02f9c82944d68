//! M108, M112, M524, M876, M999: the receive path acts on them at once, whatever stands behind them.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Mark, Nature};

const FAMILY: &str = "Jobs, pauses and waits";

pub(in crate::machine) const CANCEL: Entry = Entry::m(FAMILY, &[524])
    .nature(Nature::Report)
    .does("", "cancels the job; acts at once")
    .examples(&[("M524", &["echo:cancelled, heaters are off"])]);

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
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    if command.code() == 112 { Err(Interrupt::Halt) } else { Ok(Answer::Nothing) }
}
