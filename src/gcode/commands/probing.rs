//! The Z probe.

use super::Command;
use super::grammar::{Grammar, WORDS};
use super::row::Described;
use crate::gcode::lexer::{has, number, numbers, switch};
use crate::gcode::number::Number;

/// The Z probe.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ProbeCommand {
    /// G30: the height of the bed at a place, where the probe is if none is named.
    Touch {
        /// X and Y of the probe.
        at: [Option<Number>; 2],
        /// E0: the probe stays out.
        stays_out: bool,
    },
    /// M48: how much touches at a place differ.
    Repeatability {
        /// X and Y of the probe.
        at: [Option<Number>; 2],
        /// P: how many touches.
        touches: Option<Number>,
        /// V: 0 tells the deviation alone, 2 each touch.
        verbosity: Option<Number>,
        /// L or S: the tool is to move in between, which it does not.
        other: Option<u8>,
    },
    /// M280: an order to a servo, or report.
    Servo {
        /// P: which one.
        servo: Option<Number>,
        /// S: an angle, from 544 on a length of pulses in us, or -1 for none.
        order: Option<Number>,
    },
    /// M401: puts the probe out.
    Deploy,
    /// M401 S, H: whether a BLTouch stays out between touches, or report.
    Quick(Option<bool>),
    /// M402: takes the probe in.
    Stow,
}

pub(super) const ROWS: &[Described] = &[
    Described::g(&[30], |_, text| {
        let stays_out = number(text, b'E') == Some(Number::ZERO);
        probe(ProbeCommand::Touch { at: place(text), stays_out })
    })
    .grammar(&Grammar::numbers(b"XYE"))
    .does("X Y E", "height of the bed below the probe, or at that place of the probe; E0 leaves it out"),
    Described::m(&[48], |_, text| {
        let [touches, verbosity] = numbers(text, b"PV");
        let other = [b'L', b'S'].into_iter().find(|letter| has(text, *letter));
        probe(ProbeCommand::Repeatability { at: place(text), touches, verbosity, other })
    })
    .grammar(&Grammar::numbers(b"PXYV"))
    .does("P X Y V", "touches the bed P times at a place and reports how much they differ; V2 reports each"),
    Described::m(&[280], |_, text| {
        let [servo, order] = numbers(text, b"PS");
        probe(ProbeCommand::Servo { servo, order })
    })
    .grammar(&Grammar::numbers(b"PS"))
    .does("P S", "order to the servo of a BLTouch: an angle, or us from 544 on; S-1 ends it; or reports"),
    Described::m(&[401], |_, text| {
        let is_quick = switch(text);
        let is_about_quick = is_quick.is_some() || has(text, b'H');
        probe(if is_about_quick { ProbeCommand::Quick(is_quick) } else { ProbeCommand::Deploy })
    })
    .grammar(WORDS)
    .does("S H", "puts the probe out; S1 leaves a BLTouch without orders to go in between touches, H reports that"),
    Described::m(&[402], |_, _| probe(ProbeCommand::Stow)).grammar(WORDS).does("", "takes the probe in"),
];

/// X and Y of a line.
fn place(text: &[u8]) -> [Option<Number>; 2] {
    numbers(text, b"XY")
}

const fn probe(command: ProbeCommand) -> Option<Command<'static>> {
    Some(Command::Probe(command))
}
