//! Plain settings: codes with a letter for each setting. The letters come from the rows of `settings`, and what a code
//! keeps to besides its ranges from `setup::rules`.

use super::Entry;
pub(in crate::machine) use super::plain::set_plain as carry_out;
use crate::gcode::{Grammar, Nature, Part};
use crate::settings::plain::{AXIS_CODES, MACHINE_CODES};

/// A number for each axis.
pub(in crate::machine) const OF_AXES: Entry = Entry::m("Settings", AXIS_CODES)
    .nature(Nature::Mode)
    .grammar(&Grammar::plain().parts(&[(b'T', Part::Extruder)]))
    .examples(&[
        ("M92 X80 Y80", &[]),
        ("M92", &["  M92 X80 Y80 Z800 E400"]),
        ("M92 E0", &["echo:M92 ignored: E0 is out of range (1 to 25600), stays 400"]),
        ("M201 X4000", &[]),
        ("M201", &["  M201 X5000 Y5000 Z200 E5000"]),
        ("M201 X0", &["echo:M201 ignored: X0 is out of range (1 to 100000), stays 5000"]),
        ("M203 Z10", &[]),
        ("M203", &["  M203 X300 Y300 Z20 E80"]),
        (
            "M203 X99999 Y-1",
            &[
                "echo:M203 ignored: X99999 is out of range (0.01 to 3000), stays 300; speeds are in mm/s",
                "echo:M203 ignored: Y-1 is out of range (0.01 to 3000), stays 300",
            ],
        ),
        ("M206 X1 Y-1 Z.5", &[]),
        ("M206", &["  M206 X0 Y0 Z0"]),
    ]);

/// A number for each setting of the machine.
pub(in crate::machine) const OF_MACHINE: Entry =
    Entry::m("Settings", MACHINE_CODES).nature(Nature::Mode).grammar(&Grammar::plain()).examples(&[
        ("M204 P500 T500", &[]),
        ("M204", &["  M204 P3000 R3000 T5000"]),
        ("M204 P0 R2 T1e9", &["echo:M204 ignored: P0 is out of range (1 to 100000), stays 3000"]),
        ("M113 S99", &["echo:M113 S99 is out of range, set to 60"]),
        ("M113 S2", &[]),
        ("M113", &["echo:M113 S2"]),
    ]);

pub(in crate::machine) const CORNERS: Entry = Entry::m("Settings", &[205])
    .nature(Nature::Mode)
    .grammar(&Grammar::plain())
    .does("X Y Z E J S T B", "jerks, junction deviation, least feeds; B is not used; or reports")
    .examples(&[
        ("M205 X8 Y8 Z0.4 E4.5", &[]),
        ("M205 Z0", &[]),
        ("M205 Z-1", &["echo:M205 ignored: Z-1 is out of range (0 to 3000), stays 3000"]),
        ("M205", &["  M205 J0.013 E5 S0 T0 Z3000"]),
        ("M205 J5", &["echo:M205 ignored: J5 is out of range (0.001 to 1), stays 0.013"]),
        ("M205 X0", &["echo:M205 ignored: X0 is out of range (0.01 to 3000)"]),
        (
            "M205 E0 S-1",
            &[
                "echo:M205 ignored: E0 is out of range (0.01 to 3000), stays 5",
                "echo:M205 ignored: S-1 is out of range (0 to 3000), stays 0",
            ],
        ),
        ("M205 X8 Y10", &["echo:M205: one value for X and Y*"]),
    ]);

pub(in crate::machine) const PID_OF_HOTEND: Entry = Entry::m("Heat and fans", &[301])
    .nature(Nature::Mode)
    .grammar(&Grammar::plain().parts(&[(b'E', Part::Extruder), (b'H', Part::Heater), (b'T', Part::Tool)]))
    .does("P I D", "PID gains of the hotend; or reports")
    .examples(&[("M301", &["echo:no heaters configured, ignored"])]);

pub(in crate::machine) const PID_OF_BED: Entry = Entry::m("Heat and fans", &[304])
    .nature(Nature::Mode)
    .grammar(&Grammar::plain().parts(&[(b'H', Part::Heater), (b'T', Part::Tool)]))
    .does("P I D", "PID gains of the bed; or reports")
    .examples(&[("M304", &["echo:no heaters configured, ignored"])]);

#[cfg(test)]
mod tests {
    use crate::gcode::{Command, Number};
    use crate::machine::commands::table::parse;
    use crate::machine::setup::plain_words::PlainWords;

    /// The code of a line and the numbers of its first settings.
    fn plain<const N: usize>(line: &str) -> [Option<i32>; N] {
        let Command::Table(command) = parse(line.as_bytes()) else { panic!("{line}") };
        let numbers = PlainWords::read(&command).numbers;
        core::array::from_fn(|place| numbers[place].map(Number::to_int))
    }

    #[test]
    fn a_t_word_is_not_a_tool_change() {
        for line in ["M204 P500 T500", "M204 S500"] {
            assert_eq!(plain(line), [Some(500), None, Some(500)], "{line}");
        }
    }

    #[test]
    fn letters_that_only_one_code_knows() {
        assert_eq!(plain("M204 P1 R2 T3 S4"), [Some(1), Some(2), Some(3)]);
        // E, S, T and Z of rows; X, Y, J and B of the rule.
        let expected = [None, Some(2), Some(3), None, None, Some(4), Some(1), Some(4)];
        assert_eq!(plain("M205 J1 S2 T3 B4 Y4"), expected);
        for line in ["M301 D3 P1", "M304 D3 P1"] {
            assert_eq!(plain(line), [Some(1), None, Some(3)]);
        }
        assert_eq!(plain("M203 X1 Z1"), [Some(1), None, Some(1)]);
        assert_eq!(plain("M851 Z1"), [None, None, Some(1)]);
    }
}
