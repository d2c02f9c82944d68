//! Text: commands with a line that becomes a text for people at some place.

use super::command::Command;
use super::lexer::{Words, is_blank, is_outside, skip_blanks};
use super::number::Number;
use super::parts::{Audience, Form, ParkWords};
use crate::text::trim_end;

/// M118: the message after A1, E1 and P, which precede it (Marlin M118.cpp).
pub(super) fn tell(text: &[u8]) -> Command<'_> {
    let (mut form, mut to) = (Form::Plain, Audience::Sender);
    let mut after = skip_blanks(text);
    while let [letter, digit @ b'0'..=b'9', tail @ ..] = after
        && tail.first().is_none_or(|byte| is_blank(*byte))
    {
        match (letter.to_ascii_uppercase(), digit) {
            (b'A', b'0') | (b'E', b'0') => {}
            (b'P', b'0') => to = Audience::All,
            (b'P', line) => to = Audience::Line(line - b'0'),
            (b'A', _) => form = Form::Action,
            (b'E', _) if form == Form::Plain => form = Form::Echo,
            (b'E', _) => {}
            _ => break,
        }
        after = skip_blanks(tail);
    }
    Command::Tell { form, to, text: trim_end(after, is_outside) }
}

/// M600, M601.
pub(super) fn change_filament(text: &[u8], filament: bool) -> Command<'static> {
    Command::AwaitUser { ms: 0, filament, park: park_words(text, b'E') }
}

/// The words of M125, M600, M601; `back` is the letter of the filament that is pulled back.
pub(super) fn park_words(text: &[u8], back: u8) -> ParkWords {
    let mut park = ParkWords::default();
    for word in Words::new(text) {
        match word.letter {
            b'X' => park.x = word.number,
            b'Y' => park.y = word.number,
            b'Z' => park.z = word.number,
            b'R' => park.target = word.number,
            letter if letter == back => park.e = word.number,
            b'U' if back == b'E' => park.unload = word.number,
            b'L' if back == b'E' => park.load = word.number,
            // A tool (there is only one); beeps; whether to ask.
            b'T' | b'B' | b'P' | b'S' => {}
            letter if word.number.is_some() => park.other = Some(letter),
            // A letter of a name: M600 AUTO.
            _ => {}
        }
    }
    park
}

/// M0, M1: S and P in front, in any order, then a message that is not shown.
pub(super) fn await_user(text: &[u8]) -> Command<'static> {
    let mut ms = 0u64;
    let timed = Words::new(text).map_while(|word| word.number.map(|number| (word.letter, number)));
    for (letter, number) in timed.take_while(|(letter, _)| matches!(letter, b'S' | b'P')) {
        ms += if letter == b'S' { number.to_thousandths().max(0) as u64 } else { u64::from(number.to_u32()) };
    }
    Command::AwaitUser { ms: ms.min(Number::LIMIT as u64) as u32, filament: false, park: ParkWords::default() }
}

/// M28: the name of the file.
pub(super) fn file_name(text: &[u8]) -> &[u8] {
    trim_end(skip_blanks(text), is_outside)
}

/// M486: with S a number, with A a name, with T a count; the other letters cancel.
pub(super) fn object(text: &[u8]) -> Command<'static> {
    match Words::new(text).next() {
        Some(word) if word.letter == b'S' => Command::Object(word.number.unwrap_or_default()),
        Some(word) if matches!(word.letter, b'P' | b'C' | b'U') => Command::CancelObject,
        _ => Command::Silent,
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse::parse;
    use super::*;

    #[test]
    fn messages_and_how_they_are_dressed() {
        let tell = |form, text| Command::Tell { form, to: Audience::Sender, text };
        assert_eq!(parse(b"M118 hello E1 "), tell(Form::Plain, b"hello E1"));
        assert_eq!(parse(b"M118 A1 action:pause"), tell(Form::Action, b"action:pause"));
        assert_eq!(parse(b"M118 E1 Layer 3"), tell(Form::Echo, b"Layer 3"));
        let to = |form, to| Command::Tell { form, to, text: b"Layer 3" };
        assert_eq!(parse(b"M118 E1 P0 Layer 3"), to(Form::Echo, Audience::All));
        assert_eq!(parse(b"M118 P2 A1 Layer 3"), to(Form::Action, Audience::Line(2)));
        assert_eq!(parse(b"M118 Layer P0"), tell(Form::Plain, b"Layer P0"));
        assert_eq!(parse(b"M118 A1 E1 x"), tell(Form::Action, b"x"));
        assert_eq!(parse(b"M118 A0 A12"), tell(Form::Plain, b"A12"));
        assert_eq!(parse(b"M118"), tell(Form::Plain, b""));
    }

    #[test]
    fn a_wait_is_as_long_as_the_words_in_front_say() {
        let wait = |ms| Command::AwaitUser { ms, filament: false, park: ParkWords::default() };
        assert_eq!(parse(b"M0"), wait(0));
        assert_eq!(parse(b"M1 S1.5 P20"), wait(1520));
        assert_eq!(parse(b"M0 S10 Press the button"), wait(10_000));
        assert_eq!(parse(b"M0 Remove plate S5"), wait(0));
        assert_eq!(parse(b"M601"), wait(0));
        let park = ParkWords { x: Some(Number::from(10)), e: Some(Number::from(-5)), ..ParkWords::default() };
        assert_eq!(parse(b"M600 X10 E-5 T0 B3"), Command::AwaitUser { ms: 0, filament: true, park });
        let park = ParkWords { unload: Some(Number::from(80)), load: Some(Number::from(-2)), ..ParkWords::default() };
        assert_eq!(parse(b"M600 U80 L-2"), Command::AwaitUser { ms: 0, filament: true, park });
        let park = ParkWords { other: Some(b'U'), ..ParkWords::default() };
        assert_eq!(parse(b"M125 U80"), Command::Pause { parks: true, park });
        assert_eq!(parse(b"M600 AUTO"), Command::AwaitUser { ms: 0, filament: true, park: ParkWords::default() });
        let park = ParkWords { e: Some(Number::from(3)), z: Some(Number::from(20)), ..ParkWords::default() };
        assert_eq!(parse(b"M125 L3 Z20 P1"), Command::Pause { parks: true, park });
    }

    #[test]
    fn objects_are_numbered_named_or_cancelled() {
        assert_eq!(parse(b"M486 S-1"), Command::Object(Number::from(-1)));
        assert_eq!(parse(b"M486 S3 A\"cube\""), Command::Object(Number::from(3)));
        for line in ["M486 T5", "M486 ASupport P5 (1)*", "M486"] {
            assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
        }
        for line in ["M486 P1", "M486 C", "M486 U2"] {
            assert_eq!(parse(line.as_bytes()), Command::CancelObject, "{line}");
        }
    }
}
