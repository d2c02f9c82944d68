//! Parsing: the code chooses the command, the words fill it in.
//!
//! Rules that hold for every command: unknown letters are ignored, the last of two equal letters wins,
//! a T is a parameter where it is not the first word (`M204 P500 T500`), a line that is not in order is
//! [`Command::Malformed`], and what cannot be carried out at all is [`Command::Unknown`] with the whole line.

use super::code::Code;
use super::command::{ArcShape, AxisFlags, AxisWords, Command, Plane};
use super::grammar::in_order;
use super::lexer::{Word, Words, is_outside, skip_blanks, skip_past};
use super::m_codes::parse_m;
use super::named::parse_named;
use super::number::Number;
use crate::text::{trim_end, trim_start};

/// The first character of texts that some editors write (U+FEFF, the byte order mark).
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// What `line` asks for: a line without line number, checksum and line end; a comment may still be in it.
///
/// Never fails: what is not understood is [`Command::Unknown`].
#[must_use]
pub fn parse(line: &[u8]) -> Command<'_> {
    let text = skip_comments(line);
    let known = match Code::read(text) {
        // Most lines are moves: they are put where the answer goes, for a command is large.
        Some((code @ Code { letter: b'G', subcode: 0, number: 0 | 1 }, words)) => return self::line(code, words),
        Some((code, words)) => parse_code(code, words).map(|command| in_order(command, code, words)),
        None => parse_named(text),
    };
    known.unwrap_or_else(|| Command::Unknown(trim(line)))
}

/// The command of a code, or `None` for one that is not understood.
#[inline(never)]
fn parse_code(code: Code, text: &[u8]) -> Option<Command<'_>> {
    match (code.letter, code.subcode) {
        (b'G', 0) => parse_g(code, text),
        (b'T', 0) => u8::try_from(code.number).ok().map(Command::Tool),
        _ => parse_m(code, text),
    }
}

/// G-codes without a subcode, but for G0 and G1.
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
        29 | 30 => Command::Probing,
        90 => Command::Absolute,
        91 => Command::Relative,
        92 => Command::SetPosition(position(text)),
        _ if super::quiet::is_silent(code) => Command::Silent,
        _ => return None,
    })
}

/// G0 and G1. Only a line with anything unusual is looked at again.
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
    if is_usual && !words.has_skipped() { command } else { in_order(command, code, text) }
}

/// G2 and G3. With a radius, I, J and K do not count (Marlin).
fn arc(clockwise: bool, text: &[u8]) -> Command<'static> {
    let mut to = AxisWords::default();
    let (mut feed, mut i, mut j, mut k, mut radius, mut turns) = (None, None, None, None, None, None);
    for word in Words::new(text) {
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
    Command::Arc { clockwise, to, feed, shape, turns }
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

/// The axes of a text with their values.
pub(super) fn axis_words(text: &[u8]) -> AxisWords {
    let mut words = AxisWords::default();
    Words::new(text).for_each(|word| take_axis(&mut words, word));
    words
}

/// Puts `word` where it belongs if it names an axis.
pub(super) fn take_axis(words: &mut AxisWords, word: Word<'_>) {
    match word.letter {
        b'X' => words.x = word.number,
        b'Y' => words.y = word.number,
        b'Z' => words.z = word.number,
        b'E' => words.e = word.number,
        _ => {}
    }
}

/// The axes that a text names, with or without a value.
pub(super) fn axis_flags(text: &[u8]) -> AxisFlags {
    let mut flags = AxisFlags::default();
    for word in Words::new(text) {
        match word.letter {
            b'X' => flags.x = true,
            b'Y' => flags.y = true,
            b'Z' => flags.z = true,
            b'E' => flags.e = true,
            _ => {}
        }
    }
    flags
}

/// The line from its code on, if nothing but a byte order mark and `( )` comments stand before it.
fn skip_comments(mut line: &[u8]) -> &[u8] {
    line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    while let [b'(', inside @ ..] = skip_blanks(line) {
        line = skip_past(inside, b')');
    }
    line
}

/// The line without blanks and line ends round it.
fn trim(line: &[u8]) -> &[u8] {
    trim_end(trim_start(line, is_outside), is_outside)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;

    fn number(text: &str) -> Option<Number> {
        Number::read(text.as_bytes()).map(|(number, _)| number)
    }

    #[test]
    fn a_slicers_move() {
        let Command::Line { rapid: false, to, feed } = parse(b"G1 X.5 Y-12.345 E-.04 F1800") else { panic!() };
        assert_eq!((to.x, to.y, to.z, to.e), (number("0.5"), number("-12.345"), None, number("-0.04")));
        assert_eq!(feed, number("1800"));
    }

    #[test]
    fn the_last_of_two_equal_letters_wins() {
        assert_eq!(parse(b"G1 X10 X20"), parse(b"G1 X20"));
    }

    #[test]
    fn a_spiral_hop_is_one_turn_without_x_and_y() {
        let command = parse(b"G3 Z.76 I.194 J1.201 P1  F30000");
        let Command::Arc { clockwise: false, to, shape, turns: 1, .. } = command else { panic!() };
        assert_eq!((to.x, to.y, to.z), (None, None, number("0.76")));
        let [i, j] = ["0.194", "1.201"].map(|text| number(text).unwrap());
        assert_eq!(shape, ArcShape::Centre { i, j, k: Number::ZERO });
    }

    #[test]
    fn an_arc_turns_at_least_once() {
        for (text, expected) in [("", 1), ("P0", 1), ("P1", 1), ("P3", 3), ("P1e9", 1), ("P99999", u16::MAX)] {
            let line = std::format!("G2 X1 R5 {text}");
            let Command::Arc { turns, .. } = parse(line.as_bytes()) else { panic!() };
            assert_eq!(turns, expected, "{text}");
        }
    }

    #[test]
    fn an_arc_without_a_centre_says_so() {
        let Command::Arc { shape, .. } = parse(b"G2 X1 Y1") else { panic!() };
        assert_eq!(shape, ArcShape::Missing);
        let Command::Arc { shape, .. } = parse(b"G2 X1 Y1 I3 R-2") else { panic!() };
        assert_eq!(shape, ArcShape::Radius(Number::from(-2)));
        let Command::Arc { shape, .. } = parse(b"G2 X1 Y1 J3") else { panic!() };
        let zero = Number::ZERO;
        assert_eq!(shape, ArcShape::Centre { i: zero, j: Number::from(3), k: zero });
        let Command::Arc { shape, .. } = parse(b"G2 X1 Z1 K3") else { panic!() };
        assert_eq!(shape, ArcShape::Centre { i: zero, j: zero, k: Number::from(3) });
    }

    #[test]
    fn dwelling_adds_seconds_and_milliseconds() {
        assert_eq!(parse(b"G4"), Command::Dwell { ms: 0 });
        assert_eq!(parse(b"G4 P250"), Command::Dwell { ms: 250 });
        assert_eq!(parse(b"G4 S1.5 P1"), Command::Dwell { ms: 1501 });
        assert_eq!(parse(b"G4 S999999999 P999999999"), Command::Dwell { ms: 1_000_000_000 });
    }

    #[test]
    fn homing_knows_flags_and_ignores_the_rest() {
        let home = |x, y, z| Command::Home(AxisFlags { x, y, z, e: false });
        assert_eq!(parse(b"G28"), home(false, false, false));
        assert_eq!(parse(b"G28 X Y"), home(true, true, false));
        assert_eq!(parse(b"G28 X0 Y0"), home(true, true, false));
        assert_eq!(parse(b"G28 W"), home(false, false, false));
        assert_eq!(parse(b"G28 X R5"), home(true, false, false));
        assert_eq!(parse(b"G28 E"), home(false, false, false));
        assert_eq!(parse(b"g28z"), home(false, false, true));
    }

    #[test]
    fn naming_the_position() {
        let zero = Some(Number::ZERO);
        let e = Command::SetPosition(AxisWords { e: zero, ..AxisWords::default() });
        assert_eq!(parse(b"G92 E0; G1 E-10 F1200"), e);
        assert_eq!(parse(b"G92 E"), e);
        let all = Command::SetPosition(AxisWords { x: zero, y: zero, z: zero, e: zero });
        assert_eq!(parse(b"G92"), all);
    }

    #[test]
    fn what_is_not_a_command_comes_back_as_it_came() {
        for line in [
            "print_end",
            "P0 S1",
            "Q603 X",
            "%",
            "(comment)",
            "/G1 X5",
            "T",
            "T256",
            "G80",
            "G10 P0 S200",
            "G10 L2 P1 X0",
            "G5 X1",
            "M999999",
            "G92.1",
            "T0.5",
            "M",
            "(never ends",
        ] {
            assert_eq!(parse(std::format!(" \t{line} \r").as_bytes()), Command::Unknown(line.as_bytes()));
        }
    }

    #[test]
    fn a_comment_may_stand_before_the_code() {
        assert_eq!(parse(b"(home) ( all ) G28"), parse(b"G28"));
        assert_eq!(parse("\u{feff}G28".as_bytes()), parse(b"G28"));
        assert_eq!(parse("\u{a0}G28\u{a0}".as_bytes()), parse(b"G28"));
    }
}
