//! Offsets of z: M290 and Klipper's SET_GCODE_OFFSET.

use super::Command;
use super::grammar::Grammar;
use super::motion::MotionCommand;
use super::pairs::flaw_of_pairs;
use super::row::Described;
use crate::gcode::lexer::{has, numbers};
use crate::gcode::number::Number;
use crate::gcode::parts::OffsetWords;

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

/// Words of SET_GCODE_OFFSET: its own, and from [`OTHERS`] on those of axes without an offset. Others are ignored.
const NAMES: [&str; 9] = ["Z", "Z_ADJUST", "MOVE", "X", "Y", "E", "X_ADJUST", "Y_ADJUST", "E_ADJUST"];
const OTHERS: usize = 3;

/// SET_GCODE_OFFSET. MOVE_SPEED is not obeyed: z moves as fast as its limits allow.
fn gcode_offset(text: &[u8]) -> Command<'_> {
    let (mut numbers, mut other) = ([None; NAMES.len()], None);
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        let flaw = pair.put_number(&mut numbers);
        // 0 is what the machine has.
        let number = numbers.get(pair.place).copied().flatten().filter(|number| *number != Number::ZERO);
        if flaw.is_none() && pair.place >= OTHERS && number.is_some() {
            // The words behind it do not count.
            other = NAMES.get(pair.place);
            return Some(pair.flaw());
        }
        flaw
    });
    if let Some(other) = other {
        return Command::Motion(MotionCommand::NoOffset("SET_GCODE_OFFSET", other.as_bytes()));
    }
    let [to, by, moves, ..] = numbers;
    let offset = OffsetWords { to, by, moves: moves.is_some_and(|number| number != Number::ZERO) };
    flaw.map_or(Command::Motion(MotionCommand::ZOffset(offset)), Command::Malformed)
}
