//! Parsing: the code chooses the command, the words fill it in.
//!
//! Rules for every command:
//! - Unknown letters are ignored, and the last of two equal letters wins.
//! - A T that is not the first word is a parameter (`M204 P500 T500`).
//! - An invalid line is [`Command::Malformed`].
//! - A line that cannot be carried out at all is [`Command::Unknown`] with the whole line.

use super::code::Code;
use super::commands::Command;
use super::commands::entry::{Row, of_code, of_name};
use super::commands::moves::{arc, line};
use super::lexer::{is_outside, skip_blanks, skip_past};
use crate::text::{is_word, trim_end, trim_start};

/// The first character of texts that some editors write (U+FEFF, the byte order mark).
const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// The command of `line`, without line number, checksum and line end; a comment may still be in it.
///
/// A command that is no move is looked for in `table`. Never fails: an unknown command is [`Command::Unknown`].
#[must_use]
pub fn parse_with<'a>(table: &'static [Row], line: &'a [u8]) -> Command<'a> {
    let text = skip_comments(line);
    let known = match Code::read(text) {
        // Most lines are moves: they are written directly to the place of the answer, because a command is large.
        Some((code @ Code { letter: b'G', subcode: 0, number: 0 | 1 }, words)) => return self::line(code, words),
        Some((code @ Code { letter: b'G', subcode: 0, number: 2 | 3 }, words)) => return arc(code, words),
        Some((code, words)) => of_code(table, code, words),
        None if is_comment(line, text) => Some(Command::Silent),
        None => parse_named(table, text),
    };
    known.unwrap_or_else(|| Command::Unknown(trim(line)))
}

/// The command of a name, or `None` if it is not known. `text` is the whole line.
fn parse_named<'a>(table: &'static [Row], text: &'a [u8]) -> Option<Command<'a>> {
    let text = skip_blanks(text);
    // The subroutines and loops of LinuxCNC (`O100`) are unknown: a line number with one wrong bit looks like that.
    if is_condition(text) {
        return Some(Command::Condition);
    }
    let end = text.iter().position(|byte| !(byte.is_ascii_alphabetic() || *byte == b'_')).unwrap_or(text.len());
    let (name, after) = text.split_at_checked(end)?;
    // A multi-material unit's loading, cutting and choosing: Tx, Tc and T?.
    if matches!((name, after), (b"Tx" | b"Tc", _) | (b"T", b"?")) {
        return Some(Command::Silent);
    }
    // With a digit behind it is another name.
    if matches!(after, [b'0'..=b'9', ..]) {
        return None;
    }
    of_name(table, name, after)
}

/// Whether a line is a condition or a loop of a template that a slicer (`{if x}`, `[if x]`) or Klipper (`{% if x %}`)
/// should have worked out.
fn is_condition(text: &[u8]) -> bool {
    const WORDS: [&[u8]; 7] = [b"if", b"else", b"elif", b"elsif", b"endif", b"for", b"endfor"];
    let [b'{' | b'[', text @ ..] = text else { return false };
    let text = trim_start(text, |byte| is_outside(byte) || matches!(byte, b'%' | b'-'));
    let end = text.iter().position(|byte| !byte.is_ascii_alphanumeric() && *byte != b'_').unwrap_or(text.len());
    text.get(..end).is_some_and(|name| WORDS.iter().any(|word| is_word(name, word)))
}

/// The line from its code on, if only a byte order mark and `( )` comments precede it.
fn skip_comments(mut line: &[u8]) -> &[u8] {
    line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
    while let [b'(', inside @ ..] = skip_blanks(line) {
        line = skip_past(inside, b')');
    }
    line
}

/// Whether a line is nothing but comments; `text` is what comes after those in front.
fn is_comment(line: &[u8], text: &[u8]) -> bool {
    let is_closed = matches!(trim(line), [.., b')']);
    text.len() < line.len() && matches!((trim(text), is_closed), ([], true) | ([b';', ..], _))
}

/// The line without blanks and line ends around it.
fn trim(line: &[u8]) -> &[u8] {
    trim_end(trim_start(line, is_outside), is_outside)
}
