//! Quiet commands: hosts and slicers send them, but this machine has nothing to do for them.
//!
//! An echo for each would flood the host's console and cost link time. Only commands that change nothing on the plate
//! are here: a command with a missing effect that a user must know of is answered in words.

use super::Command;
use super::grammar::Grammar;
use super::jobs::JobCommand;
use super::row::Described;
use crate::gcode::index::Part;
use crate::gcode::lexer::{number, skip_blanks};
use crate::gcode::number::Number;

/// Unless a row gives another reason, it asks for a part (lamp, beeper, display, power switch, second extruder) that
/// this machine does not have. A code with a meaning that it did not have before leaves this table.
pub(super) const ROWS: &[Described] = &[
    Described::silent(&[2], "end of program: the end of the file is the end"),
    Described::silent(&[20, 21], "card: there is none; hosts send these when they connect"),
    Described::silent(&[74], "weight of the print (Prusa)"),
    Described::silent(&[76], "stops a job timer; the print goes on"),
    Described::silent(&[80], "power supply on: it is on"),
    Described::silent(&[142], "heatbreak temperature (Prusa): no such sensor"),
    Described::silent(&[150, 355], "lamps: none"),
    Described::m(&[200], |_, text| if is_volumetric(text) { None } else { SILENT })
        .grammar(&Grammar::numbers(b"").parts(&[(b'T', Part::Extruder)]))
        .silently("volumetric extrusion off (`D0`, `S0`); with a diameter or S1 it is unknown"),
    Described::silent(&[202], "travel acceleration (Repetier): M204 T does that"),
    Described::silent(&[217], "tool change: one tool"),
    Described::silent(&[240], "photo: no camera"),
    Described::silent(&[300], "beeper: none"),
    Described::silent(&[403], "filament of a multi-material unit: none"),
    Described::silent(&[425], "backlash compensation: none"),
    Described::silent(&[530, 532], "print mode and progress (Repetier): not shown"),
    Described::silent(&[862], "asks whether nozzle, model and firmware fit (PrusaSlicer, with a subcode)")
        .with_subcodes(),
    Described::silent(&[870], "Prusa's own"),
    Described::silent(&[907], "motor current by a potentiometer: M906 sets it"),
    Described::g(&[12], |_, _| SILENT).silently("nozzle wiper: none"),
    // The names of a print's objects, and the begin and end of each. Nothing here depends on it.
    Described::name(&["EXCLUDE_OBJECT_START", "EXCLUDE_OBJECT_END"], |_, _| SILENT)
        .silently("names of objects: not used"),
    Described::name(&["EXCLUDE_OBJECT"], |_, text| Some(exclude_object(text)))
        .silently("lists skipped objects: none; with NAME= or CURRENT= it is refused"),
];

const SILENT: Option<Command<'static>> = Some(Command::Silent);

/// Whether M200 requests volumetric extrusion, which would print wrongly if it were ignored: a diameter or S1.
/// `M200 D0` and `M200 S0` are how slicers make sure that it is off.
fn is_volumetric(text: &[u8]) -> bool {
    let is_set = |number: Option<Number>| number.is_some_and(|number| number != Number::ZERO);
    match number(text, b'S') {
        Some(switch) => is_set(Some(switch)),
        None => is_set(number(text, b'D')),
    }
}

/// EXCLUDE_OBJECT: without a name it asks which objects are left out, with RESET=1 for none of them.
fn exclude_object(text: &[u8]) -> Command<'static> {
    let asks = skip_blanks(text).get(..5).is_none_or(|word| !matches!(word, b"NAME=" | b"CURRE"));
    if asks { Command::Silent } else { Command::Job(JobCommand::CancelObject) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::code::Code;
    use crate::gcode::commands::table;
    use crate::gcode::parse::parse;

    #[test]
    fn subcodes_are_silent_only_where_they_mean_something() {
        let is_silent = |number, subcode| table::row_of(Code { letter: b'M', number, subcode }).is_some();
        assert!(is_silent(862, 3));
        assert!(is_silent(74, 0));
        assert!(!is_silent(74, 1));
    }

    #[test]
    fn objects_are_announced_and_not_left_out() {
        for line in [
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
        assert_eq!(parse(b"EXCLUDE_OBJECT NAME=cube"), Command::Job(JobCommand::CancelObject));
        assert_eq!(parse(b"EXCLUDE_OBJECT CURRENT=1"), Command::Job(JobCommand::CancelObject));
        assert_eq!(parse(b"EXCLUDE_OBJECTS"), Command::Unknown(b"EXCLUDE_OBJECTS"));
    }
}
