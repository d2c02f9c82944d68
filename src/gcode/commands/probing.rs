//! The Z probe.

use super::Command;
use super::grammar::Grammar;
use super::row::Described;
use crate::gcode::lexer::number;
use crate::gcode::number::Number;

/// The Z probe.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ProbeCommand {
    /// G30: the height of the bed at a place, where the probe is if none is named.
    Touch {
        /// X of the probe.
        x: Option<Number>,
        /// Y of the probe.
        y: Option<Number>,
        /// E0: the probe stays out.
        stays_out: bool,
    },
}

pub(super) const ROWS: &[Described] = &[Described::g(&[30], |_, text| {
    let [x, y] = [b'X', b'Y'].map(|letter| number(text, letter));
    probe(ProbeCommand::Touch { x, y, stays_out: number(text, b'E') == Some(Number::ZERO) })
})
.grammar(&Grammar::numbers(b"XYE"))
.does("X Y E", "height of the bed below the probe, or at that place of the probe; E0 leaves it out")];

const fn probe(command: ProbeCommand) -> Option<Command<'static>> {
    Some(Command::Probe(command))
}
