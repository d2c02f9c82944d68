//! M400: waits until the motion has ended.

use super::{Answer, MainLoop, OwnCommand, OwnEntry, PortSet, States, Wake};
use crate::gcode::{Grammar, Nature};
use crate::machine::answers::next_step::NextStep;

pub(super) const ENTRY: OwnEntry = OwnEntry::m("Motion", &[400])
    .nature(Nature::Mode)
    .grammar(&Grammar::numbers(b""))
    .does("", "waits until the motion has ended")
    .examples(&[("M400", &[]), ("M400 U1", &[])]);

pub(super) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    _: &OwnCommand<'a>,
) -> Answer<'a> {
    Answer::Then(NextStep::Rest)
}
