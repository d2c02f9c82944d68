//! Quiet commands: hosts and slicers send them, but this machine has nothing to do for them.
//!
//! An echo for each would flood the host's console and cost link time. Only commands that change nothing on the plate
//! are here: a command with a missing effect that a user must know of is answered in words.

use super::code::Code;

/// A command that is answered with `ok` and nothing else.
pub(super) fn is_silent(code: Code) -> bool {
    match (code.letter, code.subcode) {
        (b'G', 0) => code.number == 12,
        (b'M', 0) => SILENT.binary_search(&code.number).is_ok() || code.number == CHECKS,
        (b'M', _) => code.number == CHECKS,
        _ => false,
    }
}

/// M862.1 to M862.6, with which PrusaSlicer asks whether nozzle, model and firmware are the right ones.
const CHECKS: u16 = 862;

/// M-codes in rising order. Unless a comment gives another reason, a code is here because it asks for a part (lamp,
/// beeper, display, power switch, second extruder) that this machine does not have.
const SILENT: [u16; 20] = [
    2,   // end of program: the line itself is the end
    20,  // list files: Repetier-Host sends it when it connects
    21,  // look for a card: OctoPrint and Repetier-Host send it when they connect
    74,  // weight of the print (Prusa)
    76,  // job timer, which stops: the print goes on
    80,  // power supply on, which it is
    142, // heatbreak temperature (Prusa)
    150, // lamps
    202, // travel acceleration of Repetier; M204 T does the work
    217, // tool change settings
    240, // photo
    300, // beep
    355, // lamps
    403, // filament of an MMU
    425, // backlash compensation
    530, // print mode (Repetier)
    532, // progress (Repetier)
    555, // print area (Prusa)
    870, // Prusa
    907, // motor current, which the board's settings fix
];

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::gcode::{Command, parse};

    #[test]
    fn the_table_is_in_order() {
        assert!(SILENT.is_sorted_by(|a, b| a < b));
    }

    /// A code that has got a meaning is no quiet one any more: take it out of here.
    #[test]
    fn nothing_else_answers_a_quiet_code() {
        for number in SILENT.into_iter().chain([CHECKS]) {
            let line = std::format!("M{number}");
            assert_eq!(parse(line.as_bytes()), Command::Silent, "{line}");
        }
        assert_eq!(parse(b"G12"), Command::Silent);
    }

    #[test]
    fn subcodes_are_silent_only_where_they_mean_something() {
        let code = |number, subcode| Code { letter: b'M', number, subcode };
        assert!(is_silent(code(862, 3)));
        assert!(is_silent(code(74, 0)));
        assert!(!is_silent(code(74, 1)));
    }
}
