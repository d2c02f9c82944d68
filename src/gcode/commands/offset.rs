//! Offsets of z: M290 and Klipper's SET_GCODE_OFFSET.

use super::Command;
use super::grammar::Grammar;
use super::motion::MotionCommand;
use super::row::Described;
use super::settings::{named_value, scientific, words};
use crate::gcode::lexer::{has, numbers};
use crate::gcode::number::Number;
use crate::gcode::parts::{Flaw, OffsetWords};
use crate::text::is_word;

pub(super) const ROWS: &[Described] = &[
    Described::m(&[290], |_, text| Some(babystep(text)))
        .grammar(&Grammar::numbers(b"ZSP"))
        .does("Z S P, R", "shifts Z by Z or S while moves are under way; P0 does not keep it; or reports"),
    Described::name(&["SET_GCODE_OFFSET"], |_, text| Some(gcode_offset(text)))
        .does("Z= Z_ADJUST= MOVE=", "the kept offset of Z, at its next move or at once (MOVE=1); or reports"),
];

/// M290. Z counts before S, and a report makes no move (Marlin, M290.cpp). X and Y have no such offset.
fn babystep(text: &[u8]) -> Command<'_> {
    for (letter, name) in [(b'X', b"X"), (b'Y', b"Y")] {
        if has(text, letter) {
            return Command::Motion(MotionCommand::NoOffset("M290", name));
        }
    }
    let [z, s, kept] = numbers(text, b"ZSP");
    let by = z.or(s).filter(|_| !has(text, b'R'));
    let is_kept = kept != Some(Number::ZERO);
    Command::Motion(MotionCommand::Babystep { by, is_kept })
}

/// Words of SET_GCODE_OFFSET for axes without an offset.
const OTHERS: [&str; 6] = ["X", "Y", "E", "X_ADJUST", "Y_ADJUST", "E_ADJUST"];

/// Its own words. Any other one is ignored.
const KNOWN: [&str; 3] = ["Z", "Z_ADJUST", "MOVE"];

/// SET_GCODE_OFFSET. MOVE_SPEED is not obeyed: z moves as fast as its limits allow.
fn gcode_offset(text: &[u8]) -> Command<'_> {
    let mut offset = OffsetWords::default();
    for word in words(text) {
        let Some((name, value)) = named_value(word) else { return Command::Malformed(Flaw::NoPair(word)) };
        let is_known = KNOWN.iter().chain(&OTHERS).any(|known| is_word(name, known.as_bytes()));
        if !is_known {
            continue;
        }
        let Some(number) = scientific(value) else { return Command::Malformed(Flaw::NoPair(word)) };
        match name {
            name if name.eq_ignore_ascii_case(b"Z") => offset.to = Some(number),
            name if name.eq_ignore_ascii_case(b"Z_ADJUST") => offset.by = Some(number),
            name if name.eq_ignore_ascii_case(b"MOVE") => offset.moves = number != Number::ZERO,
            // None is what the machine has.
            _ if number == Number::ZERO => {}
            name => {
                if let Some(other) = OTHERS.into_iter().find(|other| name.eq_ignore_ascii_case(other.as_bytes())) {
                    return Command::Motion(MotionCommand::NoOffset("SET_GCODE_OFFSET", other.as_bytes()));
                }
            }
        }
    }
    Command::Motion(MotionCommand::ZOffset(offset))
}
