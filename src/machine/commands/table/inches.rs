//! G20, G21: lengths are inches or millimetres.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::gcode::{Grammar, Nature};

pub(super) const ENTRY: OwnEntry = OwnEntry::g("Motion", &[20, 21])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "inches, millimetres")
    .examples(&[("G20", &[]), ("G21", &[])]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    modal.inches = command.code() == 20;
    Answer::Nothing
}
