//! Jobs, pauses and waits.

use super::Command;
use super::row::Described;
use crate::gcode::lexer::{Words, is_outside, numbers, skip_blanks};
use crate::gcode::number::Number;
use crate::gcode::parts::ParkWords;
use crate::text::trim_end;

/// Jobs, pauses and waits.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum JobCommand<'a> {
    /// M0, M1, M600, M601: pause the print and wait for the user.
    AwaitUser {
        /// S and P summed, in ms, after which it continues by itself; 0 is never.
        ms: u32,
        /// Whether the filament is to be changed in the pause (M600).
        filament: bool,
        /// Where the tool waits.
        park: ParkWords,
    },
    /// M25, M125: pause the print.
    Pause {
        /// Whether the tool is parked even if nothing is printed (M125).
        parks: bool,
        /// Where the tool waits.
        park: ParkWords,
    },
    /// M24, M602: continue the print. A wait for the user is ended on the receive path.
    Resume,
    /// M75: a print begins.
    BeginJob,
    /// M77: it ends.
    EndJob,
    /// M524: it is cancelled. The receive path acts on it.
    Cancel,
    /// M108: end the present wait.
    Continue,
    /// M876: an answer to a question. It is taken on the receive path.
    Answer,
    /// M28: the following lines are a file for a card; there is no card.
    BeginUpload(&'a [u8]),
    /// M29: that was all of it.
    EndUpload,
    /// M486 S: the object that the following lines belong to; none if negative.
    Object(Number),
    /// M486 P, U, C and EXCLUDE_OBJECT: leave an object out, which this firmware cannot.
    CancelObject,
    /// M112: stop everything until M999 or a reset.
    EmergencyStop,
    /// M999: restart after a stop. The receive path acts on it if the machine is halted.
    Restart,
}

/// Rows without a grammar have a text for people behind them, take no words at all, or must act in any case.
pub(super) const ROWS: &[Described] = &[
    Described::m(&[0, 1], |_, text| job(await_user(text)))
        .does("S P", "pauses until the user answers, or for S s and P ms"),
    Described::m(&[600, 601], |number, text| {
        job(JobCommand::AwaitUser { ms: 0, filament: number == 600, park: park_words(text, b'E') })
    })
    .does("X Y Z E R U L", "pauses; M600 asks for a filament change"),
    Described::m(&[24, 602], |_, _| job(JobCommand::Resume)).does("", "resumes"),
    Described::m(&[25], |_, _| job(JobCommand::Pause { parks: false, park: ParkWords::default() })).does("", "pauses"),
    Described::m(&[125], |_, text| job(JobCommand::Pause { parks: true, park: park_words(text, b'L') }))
        .does("X Y Z L", "pauses and parks, also without a print"),
    Described::m(&[75, 77], |number, _| job(if number == 75 { JobCommand::BeginJob } else { JobCommand::EndJob }))
        .does("", "a job begins, ends"),
    Described::m(&[524], |_, _| job(JobCommand::Cancel)).does("", "cancels the job; acts at once"),
    Described::m(&[108], |_, _| job(JobCommand::Continue)).does("", "ends the present wait; acts at once"),
    Described::m(&[876], |_, _| job(JobCommand::Answer)).does("S P", "answer to a question; acts at once"),
    Described::m(&[28, 29], |number, text| {
        job(if number == 28 { JobCommand::BeginUpload(file_name(text)) } else { JobCommand::EndUpload })
    })
    .does("", "an upload to a card: answered, not stored, not carried out"),
    Described::m(&[486], |_, text| Some(object(text)))
        .does("S T A, P U C", "object of the following lines; leaving one out (P, U, C) is refused"),
    Described::m(&[112], |_, _| job(JobCommand::EmergencyStop)).does("", "stops everything; acts at once"),
    Described::m(&[999], |_, _| job(JobCommand::Restart)).does("", "starts again after a stop"),
];

const fn job(command: JobCommand<'_>) -> Option<Command<'_>> {
    Some(Command::Job(command))
}

/// The words of M125, M600, M601; `back` is the letter of the filament that is pulled back.
fn park_words(text: &[u8], back: u8) -> ParkWords {
    let [x, y, z, target, e] = numbers(text, &[b'X', b'Y', b'Z', b'R', back]);
    let [unload, load] = if back == b'E' { numbers(text, b"UL") } else { [None; 2] };
    // T is a tool (there is only one); B beeps; P and S say whether to ask.
    let known: &[u8] = if back == b'E' { b"XYZREULTBPS" } else { b"XYZRLTBPS" };
    // Without a number it is a letter of a name: M600 AUTO.
    let others = Words::new(text).filter(|word| word.number.is_some() && !known.contains(&word.letter));
    ParkWords { x, y, z, target, e, unload, load, other: others.last().map(|word| word.letter) }
}

/// M0, M1: S and P in front, in any order, then a message that is not shown.
fn await_user(text: &[u8]) -> JobCommand<'static> {
    let mut ms = 0u64;
    let timed = Words::new(text).map_while(|word| word.number.map(|number| (word.letter, number)));
    for (letter, number) in timed.take_while(|(letter, _)| matches!(letter, b'S' | b'P')) {
        ms += if letter == b'S' { number.to_thousandths().max(0) as u64 } else { u64::from(number.to_u32()) };
    }
    JobCommand::AwaitUser { ms: ms.min(Number::LIMIT as u64) as u32, filament: false, park: ParkWords::default() }
}

/// M28: the name of the file.
fn file_name(text: &[u8]) -> &[u8] {
    trim_end(skip_blanks(text), is_outside)
}

/// M486: with S a number, with A a name, with T a count; the other letters cancel.
fn object(text: &[u8]) -> Command<'static> {
    match Words::new(text).next() {
        Some(word) if word.letter == b'S' => Command::Job(JobCommand::Object(word.number.unwrap_or_default())),
        Some(word) if matches!(word.letter, b'P' | b'C' | b'U') => Command::Job(JobCommand::CancelObject),
        _ => Command::Silent,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::parse::parse;

    #[test]
    fn a_wait_is_as_long_as_the_words_in_front_say() {
        let wait = |ms| Command::Job(JobCommand::AwaitUser { ms, filament: false, park: ParkWords::default() });
        assert_eq!(parse(b"M0"), wait(0));
        assert_eq!(parse(b"M1 S1.5 P20"), wait(1520));
        assert_eq!(parse(b"M0 S10 Press the button"), wait(10_000));
        assert_eq!(parse(b"M0 Remove plate S5"), wait(0));
        assert_eq!(parse(b"M601"), wait(0));
        let park = ParkWords { x: Some(Number::from(10)), e: Some(Number::from(-5)), ..ParkWords::default() };
        assert_eq!(parse(b"M600 X10 E-5 T0 B3"), Command::Job(JobCommand::AwaitUser { ms: 0, filament: true, park }));
        let park = ParkWords { unload: Some(Number::from(80)), load: Some(Number::from(-2)), ..ParkWords::default() };
        assert_eq!(parse(b"M600 U80 L-2"), Command::Job(JobCommand::AwaitUser { ms: 0, filament: true, park }));
        let park = ParkWords { other: Some(b'U'), ..ParkWords::default() };
        assert_eq!(parse(b"M125 U80"), Command::Job(JobCommand::Pause { parks: true, park }));
        assert_eq!(
            parse(b"M600 AUTO"),
            Command::Job(JobCommand::AwaitUser { ms: 0, filament: true, park: ParkWords::default() })
        );
        let park = ParkWords { e: Some(Number::from(3)), z: Some(Number::from(20)), ..ParkWords::default() };
        assert_eq!(parse(b"M125 L3 Z20 P1"), Command::Job(JobCommand::Pause { parks: true, park }));
    }

    #[test]
    fn objects_are_numbered_named_or_cancelled() {
        assert_eq!(parse(b"M486 S-1"), Command::Job(JobCommand::Object(Number::from(-1))));
        assert_eq!(parse(b"M486 S3 A\"cube\""), Command::Job(JobCommand::Object(Number::from(3))));
        for line in ["M486 T5", "M486 ASupport P5 (1)*", "M486"] {
            assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
        }
        for line in ["M486 P1", "M486 C", "M486 U2"] {
            assert_eq!(parse(line.as_bytes()), Command::Job(JobCommand::CancelObject), "{line}");
        }
    }
}
