//! Remarks on words that nothing here uses.

use crate::pattern::matches;
use crate::translation::Kind::{self, Approximated, Decide, NotNeeded, NotYet};
use crate::translation::Verdict;

/// The remarks: a command, a pattern of words, and what to say; the first that fits counts.
const REMARKS: &[(&str, &str, Kind, &str)] = &[
    ("G90", "*", NotNeeded, "the state at the start"),
    ("G91", "*", NotNeeded, "a state of the moment"),
    ("M82", "*", NotNeeded, "the slicer says it"),
    ("M83", "*", NotNeeded, "the slicer says it"),
    ("G21", "*", NotNeeded, "lengths are millimetres"),
    ("G20", "*", Decide, "lengths in inches are not converted here: convert them"),
    ("M550", "*", NotNeeded, "of a network"),
    ("M551", "*", NotNeeded, "of a network"),
    ("M552", "*", NotNeeded, "of a network"),
    ("M553", "*", NotNeeded, "of a network"),
    ("M554", "*", NotNeeded, "of a network"),
    ("M586", "*", NotNeeded, "of a network"),
    ("M540", "*", NotNeeded, "of a network"),
    ("M555", "*", NotNeeded, "answers are Marlin's"),
    ("M575", "*", NotNeeded, "every host line of the board is open"),
    ("M929", "*", NotNeeded, "of its log"),
    ("M111", "*", NotNeeded, "of its log"),
    ("M115", "*", NotNeeded, "of its build"),
    ("M117", "*", NotNeeded, "of a display"),
    ("M918", "*", NotNeeded, "of a display"),
    ("M98", "*", Approximated, "another file of its: read its lines yourself"),
    ("M501", "*", Approximated, "config-override.g may replace values of this file"),
    ("M502", "*", NotNeeded, "of its memory"),
    ("M500", "*", NotNeeded, "of its memory"),
    ("G4", "*", NotNeeded, "a pause"),
    ("T*", "*", NotNeeded, "the first tool is chosen"),
    ("M563", "*", NotNeeded, "the first tool is the machine's"),
    ("G10", "*", NotNeeded, "temperatures and offsets of tools: there is one"),
    ("M568", "*", NotNeeded, "temperatures of tools: the host's"),
    ("M207", "*", NotYet, "M207 in the start G-code sets it"),
    ("M671", "*", NotYet, "write the screws into [screws.1] and so on"),
    ("M557", "*", NotNeeded, "G29 measures all that the probe reaches, or the area of its words"),
    ("M140", "*", NotNeeded, "which heater is the bed"),
    ("M141", "*", NotNeeded, "which heater is the chamber"),
    ("M950", "*", NotYet, "a pin of that board: plug it in here, and name the output"),
    ("M106", "*", NotYet, "give its output a role in [fans.fan0] and so on"),
    ("M591", "*", NotYet, "nothing stops at the end of the filament"),
    ("M570", "*", NotNeeded, "guards follow the heater's model and cannot be switched off"),
    ("M569", "*P", NotNeeded, "which driver it is"),
    ("M569", "*R", NotYet, "drivers are enabled by a low level"),
    ("M569", "*T", NotNeeded, "pulses are as long as a TMC2209 needs"),
    ("M574", "*", NotNeeded, "which switch it is"),
    ("M584", "*", NotNeeded, "the sockets are named in [motors]"),
    ("M308", "*", NotNeeded, "which sensor it is"),
    ("M305", "*", NotNeeded, "which sensor it is"),
    ("M307", "*", NotNeeded, "which heater it is"),
    ("M143", "*", NotNeeded, "which heater it is"),
    ("M558", "*", NotYet, "no setting for it: see [probe] in docs/reference/settings.md"),
    ("G31", "P*", NotNeeded, "a switch has no threshold"),
    ("G31", "*", NotNeeded, "the threshold of an analog probe"),
    ("M593", "*", NotYet, "no setting for it"),
    ("M572", "*", NotNeeded, "which extruder it is"),
    ("M208", "S", NotNeeded, "which end it is"),
    ("M350", "I", NotNeeded, "interpolation"),
    ("M915", "*", NotYet, "no axis homes by StallGuard"),
    ("M911", "*", NotYet, "a print does not go on after a power cut"),
    ("M84", "*", NotNeeded, "motors hold until M84"),
    ("M18", "*", NotNeeded, "motors hold until M84"),
    ("M669", "*", Decide, "a matrix, or numbers of other kinematics: write the rows into [mechanism]"),
    ("M665", "*", Decide, "a delta is not there yet"),
    ("M666", "*", Decide, "a delta is not there yet"),
    ("M564", "*", NotNeeded, "see soft_endstops and require_homing"),
];

/// Commands whose words may become keys of a machine file.
const READ: &str = "G31 M84 M92 M106 M140 M141 M143 M201 M203 M204 M208 M302 M305 M307 M308 M350 M376 M550 M558 M563 \
                    M564 M566 M569 M572 M574 M584 M593 M667 M669 M906 M950";

/// Whether a word of a command may become a key of a machine file.
pub(super) fn is_read(code: &str) -> bool {
    READ.split(' ').any(|known| known == code)
}

/// What to say of a word of a command.
pub(super) fn other(code: &str, key: &str) -> Verdict {
    let is_command = code.starts_with(['G', 'M', 'T']) && code[1..].starts_with(|c: char| c.is_ascii_digit());
    if !is_command {
        return Verdict::new(NotYet, "no conditions and variables in a machine file: write what counts yourself");
    }
    let found = REMARKS.iter().find(|(known, word, ..)| matches(known, code) && matches(word, key.trim()));
    match found {
        Some((_, _, kind, text)) => Verdict::new(*kind, *text),
        None => Verdict::new(NotYet, crate::marlin::tables::NO_SETTING),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::sample;

    #[test]
    fn no_remark_hides_a_later_one() {
        for (code, word, _, text) in REMARKS {
            let (a_code, a_word) = (sample(code), sample(word));
            let found = REMARKS.iter().find(|(known, of, ..)| matches(known, &a_code) && matches(of, &a_word));
            assert_eq!(found.map(|(known, of, _, text)| (*known, *of, *text)), Some((*code, *word, *text)));
        }
    }
}
