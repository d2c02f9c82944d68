//! Parsing: the code chooses the command, the words fill it in.
//!
//! Rules for every command:
//! - Unknown letters are ignored, and the last of two equal letters wins.
//! - A T that is not the first word is a parameter (`M204 P500 T500`).
//! - An invalid line is [`Command::Malformed`].
//! - A line that cannot be carried out at all is [`Command::Unknown`] with the whole line.

use super::axes::{axis_flags, take_axis};
use super::code::Code;
use super::command::Command;
use super::grammar::in_order;
use super::index::{Absent, Named, Part};
use super::lexer::{Word, Words, is_outside, skip_blanks, skip_past};
use super::m_codes::parse_m;
use super::named::parse_named;
use super::number::Number;
use super::parts::{ArcShape, AxisFlags, AxisWords, Flaw, Plane};
use crate::text::{trim_end, trim_start};

/// The first character of texts that some editors write (U+FEFF, the byte order mark).
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// The command of `line`, without line number, checksum and line end; a comment may still be in it.
///
/// Never fails: an unknown command is [`Command::Unknown`].
#[must_use]
pub fn parse(line: &[u8]) -> Command<'_> {
    let text = skip_comments(line);
    let known = match Code::read(text) {
        // Most lines are moves: they are written directly to the place of the answer, because a command is large.
        Some((code @ Code { letter: b'G', subcode: 0, number: 0 | 1 }, words)) => return self::line(code, words),
        Some((code, words)) => parse_code(code, words).map(|command| in_order(command, code, words)),
        None => parse_named(text),
    };
    known.unwrap_or_else(|| Command::Unknown(trim(line)))
}

/// The highest number of a tool in any firmware; beyond it a T is something else, or damaged.
const MOST_TOOLS: u16 = 255;

/// The command of a code, or `None` for one that is not understood.
#[inline(never)]
fn parse_code(code: Code, text: &[u8]) -> Option<Command<'_>> {
    match (code.letter, code.subcode) {
        (b'G', 0) => parse_g(code, text),
        (b'T', 0) if code.number == 0 => Some(Command::Tool),
        (b'T', 0) if code.number <= MOST_TOOLS => Some(Command::Malformed(Flaw::Absent(Absent {
            command: Named::Code(code.letter, code.number),
            part: Part::Tool,
            which: b"",
        }))),
        (b'T', 0) => None,
        _ => parse_m(code, text),
    }
}

/// G-codes without a subcode, except G0 and G1.
fn parse_g(code: Code, text: &[u8]) -> Option<Command<'static>> {
    Some(match code.number {
        2 => arc(true, text),
        3 => arc(false, text),
        4 => dwell(text),
        // With P or L it sets a tool's temperatures or offsets (RepRapFirmware).
        10 if !Words::new(text).any(|word| matches!(word.letter, b'P' | b'L')) => Command::Retract,
        11 => Command::Recover,
        17 => Command::Plane(Plane::Xy),
        18 => Command::Plane(Plane::Zx),
        19 => Command::Plane(Plane::Yz),
        20 => Command::Inches,
        21 => Command::Millimetres,
        28 => Command::Home(AxisFlags { e: false, ..axis_flags(text) }),
        29 | 30 | 80 => Command::Probing,
        90 => Command::Absolute,
        91 => Command::Relative,
        92 => Command::SetPosition(position(text)),
        _ if super::quiet::is_silent(code) => Command::Silent,
        _ => return None,
    })
}

/// G0 and G1. Only a line with unusual parts is parsed again.
fn line(code: Code, text: &[u8]) -> Command<'_> {
    let mut to = AxisWords::default();
    let mut feed = None;
    let mut is_usual = true;
    let mut words = Words::new(text);
    for word in words.by_ref() {
        is_usual &= word.number.is_some();
        match word.letter {
            b'X' => to.x = word.number,
            b'Y' => to.y = word.number,
            b'Z' => to.z = word.number,
            b'E' => to.e = word.number,
            b'F' => feed = word.number,
            _ => is_usual = false,
        }
    }
    let command = Command::Line { rapid: code.number == 0, to, feed };
    if is_usual && !words.has_skipped() { command } else { in_order(with_belt(command, text), code, text) }
}

/// A move in which the belt circulates too, if the line has a C.
#[cold]
#[inline(never)]
fn with_belt<'a>(command: Command<'a>, text: &[u8]) -> Command<'a> {
    match (command, Words::new(text).filter(|word| word.letter == b'C').last()) {
        (Command::Line { to, feed, .. }, Some(Word { number: Some(belt), .. })) => {
            Command::Circulate { to, belt, feed }
        }
        (command, _) => command,
    }
}

/// G2 and G3. With a radius, I, J and K do not count (Marlin).
fn arc(clockwise: bool, text: &[u8]) -> Command<'static> {
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
    Command::Arc { clockwise, to, feed, shape, turns, decimals }
}

/// Decimals that count: the fifth of an inch is a quarter of a micrometre.
const MOST_DECIMALS: usize = 5;

/// Decimals of the number that `written` ends with.
fn decimals_of(written: &[u8]) -> u8 {
    let number = written.rsplit(u8::is_ascii_alphabetic).next().unwrap_or_default();
    let decimals = number.split(|byte| *byte == b'.').nth(1).unwrap_or_default();
    decimals.iter().take_while(|byte| byte.is_ascii_digit()).take(MOST_DECIMALS).count() as u8
}

/// G4. The sum stays below the largest number, so that it can be printed and read again.
fn dwell(text: &[u8]) -> Command<'static> {
    let (mut milliseconds, mut seconds) = (Number::ZERO, Number::ZERO);
    for word in Words::new(text) {
        match word.letter {
            b'P' => milliseconds = word.number.unwrap_or_default(),
            b'S' => seconds = word.number.unwrap_or_default(),
            _ => {}
        }
    }
    let sum = u64::from(milliseconds.to_u32()) + seconds.to_thousandths().max(0) as u64;
    Command::Dwell { ms: sum.min(Number::LIMIT as u64) as u32 }
}

/// The words of G92: a letter without a number is zero, and so is everything if there is no letter.
fn position(text: &[u8]) -> AxisWords {
    let mut words = AxisWords::default();
    for word in Words::new(text) {
        take_axis(&mut words, Word { number: Some(word.number.unwrap_or_default()), ..word });
    }
    if words == AxisWords::default() {
        let zero = Some(Number::ZERO);
        words = AxisWords { x: zero, y: zero, z: zero, e: zero };
    }
    words
}

/// The line from its code on, if only a byte order mark and `( )` comments precede it.
fn skip_comments(mut line: &[u8]) -> &[u8] {
    line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    while let [b'(', inside @ ..] = skip_blanks(line) {
        line = skip_past(inside, b')');
    }
    line
}

/// The line without blanks and line ends around it.
fn trim(line: &[u8]) -> &[u8] {
    trim_end(trim_start(line, is_outside), is_outside)
}

#[cfg(test)]
mod tests;
