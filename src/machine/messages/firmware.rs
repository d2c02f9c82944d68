//! M115: name, version and capabilities.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Mark, Nature};
use crate::machine::reports::firmware::report_firmware;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Reports and messages", &[115])
    .nature(Nature::Report)
    .mark(Mark::AnsweredWhenStopped)
    .does("", "name, version, capabilities");

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    Answer::words(&report_firmware)
}
