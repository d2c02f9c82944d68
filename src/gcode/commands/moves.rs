//! Moves: straight ones and arcs. Most lines are moves, so this room reads their words.

use super::Command;
use super::grammar::{Grammar, Letters, NO_AXES, in_order};
use crate::gcode::axes::take_axis;
use crate::gcode::code::Code;
use crate::gcode::lexer::{Words, number};
use crate::gcode::number::Number;
use crate::gcode::parts::{ArcShape, ArcWords, AxisWords};

/// Moves.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MoveCommand {
    /// G0, G1: straight move.
    Line {
        /// Whether it was G0 (a travel move by intent).
        rapid: bool,
        /// The target.
        to: AxisWords,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// G0, G1 with C: straight move in which a closed belt circulates.
    Circulate {
        /// The target.
        to: AxisWords,
        /// C: the target of the belt, in mm of belt.
        belt: Number,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// G2, G3: arc or helix.
    Arc(ArcWords),
}

/// G0, G1. C is the belt's circulation, which not every machine has.
const LINE: &Grammar = &Grammar::numbers(b"XYZECF").no_axes(b"ABUVW");

/// G2, G3.
const ARC: &Grammar = &Grammar::numbers(b"XYZEFIJKRP").no_axes(NO_AXES).not_negative(b"P");

/// G0 and G1. Only a line with unusual parts is parsed again.
pub(in crate::gcode) fn line(code: Code, text: &[u8]) -> Command<'_> {
    let (mut x, mut y, mut z, mut e, mut feed) = (None, None, None, None, None);
    let mut is_usual = true;
    let mut words = Words::new(text);
    for word in words.by_ref() {
        is_usual &= word.number.is_some();
        match word.letter {
            b'X' => x = word.number,
            b'Y' => y = word.number,
            b'Z' => z = word.number,
            b'E' => e = word.number,
            b'F' => feed = word.number,
            _ => is_usual = false,
        }
    }
    let to = AxisWords { x, y, z, e };
    if !is_usual || words.has_skipped() {
        return unusual_line(code, text, to, feed);
    }
    Command::Move(MoveCommand::Line { rapid: code.number == 0, to, feed })
}

/// The same for a line with unusual parts. It makes its command itself, so that [`line`] writes one to one place.
#[cold]
#[inline(never)]
fn unusual_line(code: Code, text: &[u8], to: AxisWords, feed: Option<Number>) -> Command<'_> {
    let command = Command::Move(MoveCommand::Line { rapid: code.number == 0, to, feed });
    in_order(with_belt(command, text), LINE, Letters::NONE, code, text)
}

/// A move in which the belt circulates too, if the line has a C.
fn with_belt<'a>(command: Command<'a>, text: &[u8]) -> Command<'a> {
    match (command, number(text, b'C')) {
        (Command::Move(MoveCommand::Line { to, feed, .. }), Some(belt)) => {
            Command::Move(MoveCommand::Circulate { to, belt, feed })
        }
        (command, _) => command,
    }
}

/// G2 and G3.
pub(in crate::gcode) fn arc(code: Code, text: &[u8]) -> Command<'_> {
    in_order(Command::Move(arc_words(code.number == 2, text)), ARC, Letters::NONE, code, text)
}

/// With a radius, I, J and K do not count (Marlin).
fn arc_words(clockwise: bool, text: &[u8]) -> MoveCommand {
    let mut to = AxisWords::default();
    let (mut feed, mut i, mut j, mut k, mut radius, mut turns) = (None, None, None, None, None, None);
    let mut decimals = 0;
    let mut words = Words::new(text);
    let mut remaining = text;
    while let Some(word) = words.next() {
        let written = remaining.get(..remaining.len() - words.remaining().len()).unwrap_or_default();
        remaining = words.remaining();
        if matches!(word.letter, b'X' | b'Y' | b'Z' | b'I' | b'J' | b'K' | b'R') {
            decimals = decimals.max(decimals_of(written));
        }
        match word.letter {
            b'F' => feed = word.number,
            b'I' => i = word.number,
            b'J' => j = word.number,
            b'K' => k = word.number,
            b'R' => radius = word.number,
            b'P' => turns = word.number,
            _ => take_axis(&mut to, word),
        }
    }
    let shape = match radius {
        Some(radius) => ArcShape::Radius(radius),
        None if i.or(j).or(k).is_none() => ArcShape::Missing,
        None => {
            let [i, j, k] = [i, j, k].map(Option::unwrap_or_default);
            ArcShape::Centre { i, j, k }
        }
    };
    let turns = turns.map_or(1, Number::to_u32).clamp(1, u32::from(u16::MAX)) as u16;
    MoveCommand::Arc(ArcWords { clockwise, to, feed, shape, turns, decimals })
}

/// Decimals that count: the fifth of an inch is a quarter of a micrometre.
const MOST_DECIMALS: usize = 5;

/// Decimals of the number that `written` ends with.
fn decimals_of(written: &[u8]) -> u8 {
    let number = written.rsplit(u8::is_ascii_alphabetic).next().unwrap_or_default();
    let decimals = number.split(|byte| *byte == b'.').nth(1).unwrap_or_default();
    decimals.iter().take_while(|byte| byte.is_ascii_digit()).take(MOST_DECIMALS).count() as u8
}
