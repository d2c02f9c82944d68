//! M110: sets or reports the line number. The protocol room acts on it, and the receive path passes nothing of it on.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Nature;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Reports and messages", &[110])
    .nature(Nature::Report)
    .does("N", "sets or reports the line number")
    .examples(&[("M110 N5", &[]), ("M110", &["Line: 0"])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    Answer::Nothing
}
