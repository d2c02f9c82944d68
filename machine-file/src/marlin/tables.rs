//! Tables: words of Marlin that are one number, and remarks on all others.

use crate::pattern::matches;
use crate::translation::Kind::{self, NotNeeded, NotYet};

/// A word that is a number, and the key of ours that it becomes.
pub(super) struct NumberRow {
    pub code: &'static str,
    pub word: &'static str,
    pub to: &'static str,
    /// It is a length, so it follows G20.
    pub is_length: bool,
}

const fn length(code: &'static str, word: &'static str, to: &'static str) -> NumberRow {
    NumberRow { code, word, to, is_length: true }
}

const fn plain(code: &'static str, word: &'static str, to: &'static str) -> NumberRow {
    NumberRow { code, word, to, is_length: false }
}

/// Words that are one number.
pub(super) const NUMBERS: &[NumberRow] = &[
    length("M201", "X", "axes.x.max_acceleration"),
    length("M201", "Y", "axes.y.max_acceleration"),
    length("M201", "Z", "axes.z.max_acceleration"),
    length("M201", "E", "axes.e.max_acceleration"),
    length("M204", "P", "print_acceleration"),
    length("M204", "R", "retract_acceleration"),
    length("M204", "T", "travel_acceleration"),
    length("M205", "S", "min_feed"),
    length("M205", "T", "min_travel"),
    length("M205", "J", "corner.junction_deviation"),
    length("M205", "Z", "z_jerk"),
    length("M205", "E", "extruder_jerk"),
    length("M420", "Z", "mesh.fade"),
    length("M851", "X", "probe.offset.x"),
    length("M851", "Y", "probe.offset.y"),
    length("M851", "Z", "probe.offset.z"),
    plain("M113", "S", "keepalive_s"),
    plain("M301", "P", "heaters.hotend.pid.p"),
    plain("M301", "I", "heaters.hotend.pid.i"),
    plain("M301", "D", "heaters.hotend.pid.d"),
    plain("M302", "S", "thermal.min_extrude"),
    plain("M304", "P", "heaters.bed.pid.p"),
    plain("M304", "I", "heaters.bed.pid.i"),
    plain("M304", "D", "heaters.bed.pid.d"),
    plain("M309", "P", "heaters.chamber.pid.p"),
    plain("M309", "I", "heaters.chamber.pid.i"),
    plain("M309", "D", "heaters.chamber.pid.d"),
    plain("M593", "X D", "shaper.x.damping"),
    plain("M593", "Y D", "shaper.y.damping"),
];

/// The letters of a command that choose a motor or a tool. Of M593 these are X and Y without a number.
pub(super) fn selectors(code: &str) -> &'static str {
    match code {
        "M906" | "M913" | "M914" | "M569" => "IT",
        "M92" | "M201" | "M203" | "M900" => "T",
        "M301" | "M306" => "E",
        "M593" => "XY",
        "M422" => "SW",
        _ => "",
    }
}

/// What to say of words, or of whole commands.
pub(crate) struct Remark {
    pub code: &'static str,
    /// A pattern of words; empty for the command itself, and so for all its words.
    pub word: &'static str,
    pub kind: Kind,
    pub text: &'static str,
}

const fn remark_on(code: &'static str, word: &'static str, kind: Kind, text: &'static str) -> Remark {
    Remark { code, word, kind, text }
}

/// The remarks; the first that fits counts.
const REMARKS: &[Remark] = &[
    // Units.
    remark_on("G20", "", NotNeeded, "lengths of the report are inches, and were converted"),
    remark_on("G21", "", NotNeeded, "lengths of the report are millimetres"),
    remark_on("M149", "", NotNeeded, "no temperature is taken from the report"),
    // M115 and M119.
    remark_on("M115", "FIRMWARE_NAME", NotNeeded, "the firmware that answered"),
    remark_on("M115", "*_URL", NotNeeded, "of the firmware"),
    remark_on("M115", "*_VERSION", NotNeeded, "of the firmware"),
    remark_on("M115", "UUID", NotNeeded, "of the firmware"),
    remark_on(
        "M119",
        "*probe",
        NotYet,
        "write the probe's connector into endstops.probe, and its kind into probe.kind",
    ),
    remark_on("M119", "filament*", NotYet, "nothing notices the end of the filament"),
    remark_on("M119", "[xyz][2-9]_*", NotYet, "one switch homes an axis: a second one levels nothing"),
    // Motion.
    remark_on("M92", "T? E", NotYet, "a second extruder: it stays off"),
    remark_on("M201", "T? E", NotYet, "a second extruder: it stays off"),
    remark_on("M203", "T? E", NotYet, "a second extruder: it stays off"),
    remark_on("M205", "[BQ]", NotNeeded, "short moves are joined by the look-ahead"),
    // Only config.g has it.
    remark_on("M584", "", Kind::Taken, "motors of their own"),
    remark_on("M425", "", NotYet, "backlash is not compensated"),
    remark_on("M493", "", NotYet, "no fixed-time motion; M593 shapes, and M900 advances"),
    remark_on("M494", "", NotYet, "no fixed-time motion"),
    remark_on("M592", "", NotYet, "extrusion is linear"),
    remark_on("M665", "", Kind::Decide, "a delta, SCARA or polar machine is not there yet"),
    remark_on("M852", "", NotYet, "skew is not compensated"),
    // The bed.
    remark_on("G29", "", NotYet, "a mesh that was measured: G29 measures it again"),
    remark_on("M420", "*", NotNeeded, "words of reports"),
    remark_on("M421", "", NotYet, "a mesh that was measured: G29 measures it again"),
    remark_on("M423", "", NotYet, "a twisted axis is not compensated"),
    remark_on("M666", "", NotYet, "one switch homes an axis: the others level nothing"),
    remark_on("M281", "", NotYet, "no servo"),
    // The extruder and its filament.
    remark_on("M200", "", NotNeeded, "the slicer knows it; volumes (M200) say it themselves"),
    remark_on("M207", "", NotYet, "G10 retracts, and M207 in the start G-code sets it"),
    remark_on("M208", "", NotYet, "G11 recovers, and M208 in the start G-code sets it"),
    remark_on("M209", "", NotYet, "only G10 and G11 retract"),
    remark_on("M217", "", NotYet, "no tool changes"),
    remark_on("M218", "", NotYet, "one hotend so far"),
    remark_on("M404", "", NotYet, "no sensor measures the filament"),
    remark_on("M405", "", NotYet, "no sensor measures the filament"),
    remark_on("M406", "", NotYet, "no sensor measures the filament"),
    remark_on("M412", "", NotYet, "nothing notices the end of the filament"),
    remark_on("M591", "", NotYet, "nothing notices the end of the filament"),
    remark_on("M603", "", NotYet, "M600 U and L say the lengths"),
    remark_on("M900", "T? K", NotYet, "a second extruder: it stays off"),
    remark_on("M900", "[SL]", NotYet, "one K for all moves"),
    // Heat.
    remark_on("M86", "", NotYet, "thermal.idle_min switches heaters off"),
    remark_on("M145", "", NotNeeded, "presets of a display"),
    remark_on("M301", "[CL]", NotYet, "heat for the filament is computed by the model, not by PID"),
    remark_on("M301", "E? *", NotYet, "one hotend so far"),
    remark_on("M302", "P", NotYet, "cold extrusion is refused"),
    remark_on("M305", "", NotYet, "write the sensor into heaters.hotend.thermistor, as { ohms = ..., beta = ... }"),
    remark_on("M306", "E? *", NotYet, "one hotend so far"),
    remark_on("M710", "[SIA]", NotYet, "the controller's fan runs at full speed, or not"),
    // Drivers.
    remark_on("M122", "T? E", NotYet, "a second extruder: it stays off"),
    remark_on("M906", "T? E", NotYet, "a second extruder: it stays off"),
    remark_on("M913", "T? E", NotYet, "a second extruder: it stays off"),
    remark_on("M914", "", NotYet, "no axis homes by StallGuard: plug in a switch"),
    remark_on("M569", "T? E", NotYet, "a second extruder: it stays off"),
    remark_on("M907", "", NotYet, "a current by a voltage: measure it, and write drivers.*.current_ma for a TMC2209"),
    remark_on("M908", "", NotYet, "a current by a voltage: measure it, and write drivers.*.current_ma for a TMC2209"),
    // Displays and networks.
    remark_on("M250", "", NotNeeded, "of a display"),
    remark_on("M255", "", NotNeeded, "of a display"),
    remark_on("M256", "", NotNeeded, "of a display"),
    remark_on("M413", "", NotYet, "a print does not go on after a power cut"),
    remark_on("M414", "", NotNeeded, "of a display"),
    remark_on("M552", "", NotNeeded, "of a network"),
    remark_on("M553", "", NotNeeded, "of a network"),
    remark_on("M554", "", NotNeeded, "of a network"),
    remark_on("M572", "D", NotNeeded, "M900 says it"),
];

/// What to say of a word without any remark.
pub(crate) const NO_SETTING: &str = "no setting for it";

/// The remark on a word, or on a command as a whole.
pub(crate) fn remark(code: &str, word: Option<&str>) -> Option<&'static Remark> {
    REMARKS.iter().find(|remark| {
        let is_word = match word {
            Some(word) => !remark.word.is_empty() && matches(remark.word, word),
            None => remark.word.is_empty(),
        };
        is_word && remark.code == code
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_remark_hides_a_later_one() {
        for Remark { code, word, text, .. } in REMARKS {
            let a_word = crate::pattern::sample(word);
            let found = remark(code, (!word.is_empty()).then_some(a_word.as_str())).map(|found| found.text);
            assert_eq!(found, Some(*text), "{code} {word}");
        }
    }

    #[test]
    fn no_row_says_what_another_one_says() {
        for (place, row) in NUMBERS.iter().enumerate() {
            assert!(NUMBERS[..place].iter().all(|other| other.to != row.to), "{}", row.to);
            assert!(crate::keys::find(row.to).is_some(), "{}", row.to);
        }
        for (place, Remark { code, word, .. }) in REMARKS.iter().enumerate() {
            assert!(!REMARKS[..place].iter().any(|other| other.code == *code && other.word == *word), "{code} {word}");
        }
    }
}
