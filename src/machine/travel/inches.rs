//! G20, G21: lengths are inches or millimetres.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature};

pub(in crate::machine) const ENTRY: Entry = Entry::g("Motion", &[20, 21])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "inches, millimetres")
    .examples(&[("G20", &[]), ("G21", &[])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    modal.inches = command.code() == 20;
    Answer::Nothing
}
