//! M400: waits until the motion has ended.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature};

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motion", &[400])
    .nature(Nature::Mode)
    .mark(Mark::AfterRest)
    .grammar(&Grammar::numbers(b""))
    .does("", "waits until the motion has ended")
    .examples(&[("M400", &[]), ("M400 U1", &[])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &TableCommand<'a>,
) -> Answer<'a> {
    Answer::Nothing
}
