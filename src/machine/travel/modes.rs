//! G90, G91, M82, M83: whether lengths and E are absolute.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature};

/// G91 is for E too.
pub(in crate::machine) const OF_ALL: Entry = Entry::g("Motion", &[90, 91])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "absolute, relative (E too)")
    .examples(&[("G90", &[]), ("G90 G1 X10", &["echo:line ignored: G1 is a second command on it"]), ("G91", &[])]);

pub(in crate::machine) const OF_EXTRUSION: Entry = Entry::m("Motion", &[82, 83])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "E absolute, relative")
    .examples(&[("M82", &[]), ("M83", &[])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match command.code() {
        90 | 91 => modal.absolute = command.code() == 90,
        code => modal.absolute_extrusion = code == 82,
    }
    Answer::Nothing
}
