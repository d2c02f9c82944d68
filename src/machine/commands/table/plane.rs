//! G17, G18, G19: the plane of arcs.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::gcode::{Grammar, Nature, Plane};

pub(super) const ENTRY: OwnEntry = OwnEntry::g("Motion", &[17, 18, 19])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "plane of arcs: XY, ZX, YZ")
    .examples(&[("G17", &[]), ("G18", &[]), ("G19", &[])]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    States { modal, .. }: &mut States,
    command: &OwnCommand<'a>,
) -> Answer<'a> {
    modal.plane = match command.code() {
        17 => Plane::Xy,
        18 => Plane::Zx,
        _ => Plane::Yz,
    };
    Answer::Nothing
}
