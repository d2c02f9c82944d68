//! Named commands: the few words of Klipper that slicers write for any firmware, and those of programs with a flow of
//! their own. A new name needs a row in `boards/sim/tests/commands/table.rs` and a line in `CODES` of `tests/gcode.rs`; no test
//! asks for them, as names cannot be counted through.

use super::command::Command;
use super::lexer::skip_blanks;
use super::shaping::{set_pressure_advance, set_velocity_limit};

/// What the objects of a print are called, and where each begins and ends. Nothing here depends on it.
const SILENT: [&[u8]; 3] = [b"EXCLUDE_OBJECT_DEFINE", b"EXCLUDE_OBJECT_START", b"EXCLUDE_OBJECT_END"];

/// What decides in RepRapFirmware which lines run.
const CONDITIONALS: [&[u8]; 7] = [b"if", b"elif", b"else", b"while", b"break", b"continue", b"abort"];

/// The command that a name stands for, or `None` if it is not known. `text` is the whole line.
pub(super) fn parse_named(text: &[u8]) -> Option<Command<'_>> {
    let text = skip_blanks(text);
    // A condition that a slicer should have worked out. The subroutines and loops of LinuxCNC (`O100`) are unknown: a line
    // number with one wrong bit looks like that.
    if matches!(text, [b'{', b'i' | b'e', ..]) {
        return Some(Command::Conditional);
    }
    let end = text.iter().position(|byte| !(byte.is_ascii_alphabetic() || *byte == b'_')).unwrap_or(text.len());
    let (name, after) = text.split_at_checked(end)?;
    let is = |other: &[u8]| name.eq_ignore_ascii_case(other);
    if SILENT.iter().any(|silent| is(silent)) {
        return Some(Command::Silent);
    }
    if is(b"EXCLUDE_OBJECT") {
        // Without a name it asks which objects are left out, with RESET=1 for none of them.
        let asks = skip_blanks(after).get(..5).is_none_or(|word| !matches!(word, b"NAME=" | b"CURRE"));
        return Some(if asks { Command::Silent } else { Command::CancelObject });
    }
    if is(b"SET_PRESSURE_ADVANCE") {
        return Some(set_pressure_advance(after));
    }
    if is(b"SET_VELOCITY_LIMIT") {
        return Some(set_velocity_limit(after));
    }
    if CONDITIONALS.iter().any(|conditional| is(conditional)) && !matches!(after, [b'0'..=b'9', ..]) {
        return Some(Command::Conditional);
    }
    // A multi-material unit's loading, cutting and choosing: Tx, Tc and T?.
    matches!((name, after), (b"Tx" | b"Tc", _) | (b"T", b"?")).then_some(Command::Silent)
}

#[cfg(test)]
mod tests {
    use super::super::parse::parse;
    use super::*;

    #[test]
    fn objects_are_announced_and_not_left_out() {
        for line in [
            "EXCLUDE_OBJECT_DEFINE NAME=cube_id_0_copy_0 CENTER=10,10 POLYGON=[[5,5],[15,5],[15,15]]",
            "exclude_object_start NAME=cube",
            "EXCLUDE_OBJECT_END",
            "EXCLUDE_OBJECT",
            "EXCLUDE_OBJECT RESET=1",
            "Tx",
            "Tc",
            "T?",
        ] {
            assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
        }
        assert_eq!(parse(b"EXCLUDE_OBJECT NAME=cube"), Command::CancelObject);
        assert_eq!(parse(b"EXCLUDE_OBJECT CURRENT=1"), Command::CancelObject);
        assert_eq!(parse(b"EXCLUDE_OBJECTS"), Command::Unknown(b"EXCLUDE_OBJECTS"));
    }
}
