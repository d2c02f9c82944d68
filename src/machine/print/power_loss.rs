//! M413: recovery from a loss of power. It is always off.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::Grammar;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Settings", &[413])
    .grammar(&Grammar::numbers(b""))
    .does("S", "power-loss recovery: always off; S1 says so")
    .examples(&[
        ("M413 S0", &[]),
        ("M413 S1", &["echo:Power-loss recovery OFF, this firmware cannot do it"]),
        ("M413", &["echo:Power-loss recovery OFF"]),
    ]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    _: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match command.switch() {
        Some(true) => Answer::Line(packed!("echo:Power-loss recovery OFF, this firmware cannot do it")),
        Some(false) => Answer::Nothing,
        None => Answer::Line(packed!("echo:Power-loss recovery OFF")),
    }
}
