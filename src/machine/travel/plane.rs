//! G17, G18, G19: the plane of arcs.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Nature, Plane};

pub(in crate::machine) const ENTRY: Entry = Entry::g("Motion", &[17, 18, 19])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "plane of arcs: XY, ZX, YZ")
    .examples(&[("G17", &[]), ("G18", &[]), ("G19", &[])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    modal.plane = match command.code() {
        17 => Plane::Xy,
        18 => Plane::Zx,
        _ => Plane::Yz,
    };
    Answer::Nothing
}
