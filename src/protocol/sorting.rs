//! Sorting: which of the lines that wait for their turn need not wait, or need not stay.
//!
//! While a command is carried out, bytes are read on, so that an emergency behind them acts. There is room for few
//! lines, and it is kept for those that no host repeats: lines without a number.
//!
//! | a line | when room is short |
//! |---|---|
//! | M105, M114, M27 | it is answered at once; M27 by `ok` alone, as there is no card |
//! | M108, M410, M524, M999 | it has acted, and gets its `ok` |
//! | with a number | the first ones stay; the others are taken out, and asked for again when the rest is done |
//! | M110 | stays: hosts do not repeat it |
//! | a `;` comment | it is taken out: it gets no answer. With a `*` it may be a numbered line that was damaged |
//! | any other without a number | stays; if there is no room, its host has to wait |
//!
//! A line with damage stays too, and is asked for in its turn.

use super::reply::Replies;
use super::ring::{HEAD, Line};
use super::syntax::{line_number, m_code, skip_blanks, trim_end};
use core::fmt;

/// What a line is, as far as its sorting goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum LineKind {
    /// Its beginning may become anything.
    Unknown,
    /// Nothing; it gets no reply.
    Blank,
    /// M105.
    Temperatures,
    /// M114; with R the real position.
    Position { real: bool },
    /// M27: all it needs is `ok`.
    Answered,
    /// An emergency that has acted, and needs its `ok`. M112 gets none.
    Acted,
    /// It can be asked for again.
    Numbered,
    /// It has to stay.
    Other,
}

/// What hosts are owed for lines that were taken out of their turn.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Owed {
    /// So many times `ok`.
    pub oks: u32,
    /// `ok` with the temperatures.
    pub temperatures: bool,
    /// The position, without its `ok`; true for the real one.
    pub position: Option<bool>,
}

impl Owed {
    /// Nothing.
    pub(super) const fn new() -> Self {
        Self { oks: 0, temperatures: false, position: None }
    }

    /// Whether it is nothing.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.oks == 0 && !self.temperatures && self.position.is_none()
    }

    /// Pays as much as there is room for.
    pub fn pay(&mut self, replies: &mut Replies, temperatures: fmt::Arguments<'_>, position: fmt::Arguments<'_>) {
        self.temperatures = self.temperatures && replies.line(temperatures).is_err();
        self.position = self.position.filter(|_| replies.line(position).is_err());
        while self.oks > 0 && self.position.is_none() && replies.ok().is_ok() {
            self.oks -= 1;
        }
    }

    /// A line of this kind is answered now: each has one `ok`, and one report stands for all of its kind. False if it
    /// cannot be.
    pub(super) const fn takes(&mut self, kind: LineKind) -> bool {
        match kind {
            LineKind::Unknown | LineKind::Numbered | LineKind::Other => return false,
            LineKind::Blank => return true,
            LineKind::Temperatures if !self.temperatures => {
                self.temperatures = true;
                return true;
            }
            LineKind::Temperatures | LineKind::Answered | LineKind::Acted => {}
            LineKind::Position { real } => self.position = Some(real),
        }
        self.oks = self.oks.saturating_add(1);
        true
    }
}

/// The kind of a line, or of its beginning. Inlined, it would be repeated in each of its three places.
#[inline(never)]
pub(super) fn kind_of(line: &Line) -> LineKind {
    let text = trim_end(skip_blanks(line.head()));
    let is_short = line.head().len() < HEAD;
    // Only a line number or a code may still become one that need not stay.
    if !line.is_whole && is_short {
        return if matches!(text, [] | [b'N' | b'n' | b'M' | b'm', ..]) { LineKind::Unknown } else { LineKind::Other };
    }
    if let Some((_, after)) = line_number(text) {
        let sets_number = matches!(m_code(skip_blanks(after)), Some((110, _)));
        return if sets_number { LineKind::Other } else { LineKind::Numbered };
    }
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b' ';
    match m_code(text) {
        _ if text.is_empty() && is_short => LineKind::Blank,
        _ if matches!(text, [b';', ..]) && line.is_whole && !line.is_doubtful => LineKind::Blank,
        // A comment, a checksum or a quote in it needs the real parser.
        Some((code, words)) if line.is_whole && is_short && words.iter().all(is_plain) => match code {
            105 => LineKind::Temperatures,
            114 => LineKind::Position { real: words.iter().any(|byte| byte.eq_ignore_ascii_case(&b'R')) },
            27 => LineKind::Answered,
            108 | 410 | 524 | 999 => LineKind::Acted,
            _ => LineKind::Other,
        },
        _ => LineKind::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::super::ring::Ring;
    use super::*;
    use crate::port::Received;

    fn kind(text: &str) -> LineKind {
        let mut ring = Ring::new();
        text.bytes().for_each(|byte| ring.push(Received::Byte(byte)));
        kind_of(&ring.line(0))
    }

    #[test]
    fn lines_that_report_or_have_acted_need_not_wait() {
        for text in ["M105\n", " m105 \r", "M105 T0\n", "M 105\n"] {
            assert_eq!(kind(text), LineKind::Temperatures, "{text}");
        }
        assert_eq!(kind("M114\n"), LineKind::Position { real: false });
        assert_eq!(kind("M114 R\n"), LineKind::Position { real: true });
        for text in ["M108\n", "m410\n", "M524\n", "M999\n"] {
            assert_eq!(kind(text), LineKind::Acted, "{text}");
        }
        assert_eq!(kind("M27\n"), LineKind::Answered);
        for text in ["\n", "  \r", ";\n", " ; thumbnail begin 48x48 2104\n"] {
            assert_eq!(kind(text), LineKind::Blank, "{text}");
        }
    }

    #[test]
    fn lines_with_a_number_can_be_asked_for_again_but_m110_cannot() {
        for text in ["N5 G1 X5*33\n", "n -1 M105\n", "N123456 M106 S127 P1 *55", "N5 M108*1\n"] {
            assert_eq!(kind(text), LineKind::Numbered, "{text}");
        }
        for text in ["N-1 M110 N-1*125\n", "N0 M110 N0*125\n", "N-2147483648 M110 N-2147483648*1\n"] {
            assert_eq!(kind(text), LineKind::Other, "{text}");
        }
    }

    #[test]
    fn all_others_stay() {
        // The rest of a numbered line, more than a report, a damaged one.
        for text in [
            "G1 X5\n",
            "M105*35\n",
            "M105 ;x\n",
            ";1 G1 X5*34\n",
            "; half a comment",
            "M27 S2*\n",
            "M1050\n",
            "M105.1\n",
            "M24\n",
            "M112\n",
            "NOZZLE\n",
            "M10\n",
        ] {
            assert_eq!(kind(text), LineKind::Other, "{text}");
        }
        assert_eq!(kind("M105                       S1\n"), LineKind::Other);
        assert_eq!(kind("                            G1 X5\n"), LineKind::Other);
    }

    #[test]
    fn the_beginning_of_a_line_may_become_anything() {
        for text in ["", "  ", "M", "M10", "N", "N12 M1", "M106 S2"] {
            assert_eq!(kind(text), LineKind::Unknown, "{text}");
        }
        for text in ["G", ";", "T0", "M117 a message that is long"] {
            assert_eq!(kind(text), LineKind::Other, "{text}");
        }
    }

    #[test]
    fn each_line_has_one_ok_and_one_report_stands_for_all() {
        let mut owed = Owed::new();
        for kind in [
            LineKind::Blank,
            LineKind::Temperatures,
            LineKind::Temperatures,
            LineKind::Answered,
            LineKind::Position { real: true },
        ] {
            assert!(owed.takes(kind));
        }
        assert_eq!(owed, Owed { oks: 3, temperatures: true, position: Some(true) });
        assert!(![LineKind::Unknown, LineKind::Numbered, LineKind::Other].iter().any(|kind| owed.takes(*kind)));
    }
}
