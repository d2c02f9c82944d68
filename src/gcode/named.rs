//! Named commands: the few words of Klipper that slicers write for any firmware, and the words of programs with
//! conditions and loops.

use super::command::Command;
use super::lexer::skip_blanks;
use super::machine_record;
use super::shaping::{set_pressure_advance, set_velocity_limit};

/// The known names, each with the function that reads the text after it.
const NAMES: [(&str, Read); 17] = [
    // The names of a print's objects, and the begin and end of each. Nothing here depends on it.
    ("EXCLUDE_OBJECT_DEFINE", silent),
    ("EXCLUDE_OBJECT_START", silent),
    ("EXCLUDE_OBJECT_END", silent),
    ("EXCLUDE_OBJECT", exclude_object),
    ("MACHINE_GET", machine_record::get),
    ("MACHINE_PUT", machine_record::put),
    ("MACHINE_STORE", machine_record::store),
    ("SELF_TEST", self_test),
    ("SET_PRESSURE_ADVANCE", set_pressure_advance),
    ("SET_VELOCITY_LIMIT", set_velocity_limit),
    // Conditions and loops of RepRapFirmware.
    ("if", conditional),
    ("elif", conditional),
    ("else", conditional),
    ("while", conditional),
    ("break", conditional),
    ("continue", conditional),
    ("abort", conditional),
];

type Read = for<'a> fn(&'a [u8]) -> Command<'a>;

/// The names that are known.
pub fn names() -> impl Iterator<Item = &'static str> {
    NAMES.into_iter().map(|(name, _)| name)
}

/// The command of a name, or `None` if it is not known. `text` is the whole line.
pub(super) fn parse_named(text: &[u8]) -> Option<Command<'_>> {
    let text = skip_blanks(text);
    // A condition that a slicer should have worked out. The subroutines and loops of LinuxCNC (`O100`) are unknown: a
    // line number with one wrong bit looks like that.
    if matches!(text, [b'{', b'i' | b'e', ..]) {
        return Some(Command::Conditional);
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
    let (_, read) = NAMES.into_iter().find(|(known, _)| name.eq_ignore_ascii_case(known.as_bytes()))?;
    Some(read(after))
}

const fn silent(_: &[u8]) -> Command<'_> {
    Command::Silent
}

const fn self_test(_: &[u8]) -> Command<'_> {
    Command::SelfTest
}

const fn conditional(_: &[u8]) -> Command<'_> {
    Command::Conditional
}

/// EXCLUDE_OBJECT: without a name it asks which objects are left out, with RESET=1 for none of them.
fn exclude_object(text: &[u8]) -> Command<'_> {
    let asks = skip_blanks(text).get(..5).is_none_or(|word| !matches!(word, b"NAME=" | b"CURRE"));
    if asks { Command::Silent } else { Command::CancelObject }
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
