//! Resonances, measured by an accelerometer at the tool.

use super::Command;
use super::grammar::{Grammar, WORDS};
use super::pairs::flaw_of_pairs;
use super::row::Described;
use crate::gcode::lexer::number;
use crate::gcode::number::Number;
use crate::gcode::parts::{SweepAxis, SweepWords};
use crate::text::is_word;

/// Resonances.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum ResonanceCommand {
    /// M955: the accelerometer, its rate and its noise.
    Sensor,
    /// M956: samples of the resting tool.
    Samples {
        /// S: how many.
        count: Option<Number>,
    },
    /// TEST_RESONANCES, SHAPER_CALIBRATE: a sweep.
    Sweep(SweepWords),
}

const ALL: &str = "AXIS= FREQ_START= FREQ_END= ACCEL_PER_HZ= HZ_PER_SEC= SWEEPING_ACCEL= SWEEPING_PERIOD= OUTPUT=";

pub(super) const ROWS: &[Described] = &[
    Described::m(&[955], |_, _| resonance(ResonanceCommand::Sensor))
        .grammar(WORDS)
        .does("", "the accelerometer, its rate, and its noise while the tool rests"),
    Described::m(&[956], |_, text| resonance(ResonanceCommand::Samples { count: number(text, b'S') }))
        .grammar(&Grammar::numbers(b"S").not_negative(b"S"))
        .does("S", "so many samples of the accelerometer, 1000 without S, as Klipper's raw data"),
    Described::name(&["TEST_RESONANCES"], |_, text| Some(sweep(text, false))).does(
        ALL,
        "shakes the tool along X, Y, A (1,-1) or B (1,1) where it stands, and tells frequency and damping of its \
            resonances ([resonance](../explanation/resonance.md))",
    ),
    Described::name(&["SHAPER_CALIBRATE"], |_, text| Some(sweep(text, true)))
        .does(ALL, "the same, and the line that sets a shaper for it (M593), which is not carried out"),
];

const fn resonance(command: ResonanceCommand) -> Option<Command<'static>> {
    Some(Command::Resonance(command))
}

/// The axis; Klipper has names of axes, and directions for diagonals.
fn axis(value: &[u8]) -> Option<SweepAxis> {
    const AXES: [(&[u8], SweepAxis); 6] = [
        (b"X", SweepAxis::X),
        (b"Y", SweepAxis::Y),
        (b"A", SweepAxis::A),
        (b"B", SweepAxis::B),
        (b"1,-1", SweepAxis::A),
        (b"1,1", SweepAxis::B),
    ];
    AXES.into_iter().find(|(name, _)| is_word(value, name)).map(|(_, axis)| axis)
}

/// A sweep in Klipper's words. Those that are for its own files and chips are left out.
fn sweep(text: &[u8], chooses: bool) -> Command<'_> {
    const NAMES: [&str; 8] =
        ["FREQ_START", "FREQ_END", "ACCEL_PER_HZ", "HZ_PER_SEC", "SWEEPING_ACCEL", "SWEEPING_PERIOD", "AXIS", "OUTPUT"];
    let mut sweep = SweepWords { chooses, ..SweepWords::default() };
    let mut numbers = [None; 6];
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        match pair.place {
            6 => match axis(pair.value) {
                Some(axis) => sweep.axis = axis,
                None => return Some(pair.flaw()),
            },
            7 => sweep.wants_raw = is_word(pair.value, b"RAW_DATA"),
            _ => {}
        }
        pair.put_number(&mut numbers)
    });
    let [from, to, accel_per_hz, hz_per_s, swing, period] = numbers;
    let sweep = SweepWords { from, to, accel_per_hz, hz_per_s, swing, period, ..sweep };
    flaw.map_or(Command::Resonance(ResonanceCommand::Sweep(sweep)), Command::Malformed)
}
