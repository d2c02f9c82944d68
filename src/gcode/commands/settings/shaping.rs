//! Shaping: input shapers, pressure advance in the words of three firmwares, and Klipper's minimum cruise ratio.

use super::super::Command;
use super::SettingCommand;
use crate::gcode::axes::axis_flags;
use crate::gcode::commands::pairs::{flaw_of_pairs, times_ten_to};
use crate::gcode::index::absent_extruder;
use crate::gcode::lexer::{Words, numbers};
use crate::gcode::number::Number;
use crate::gcode::parts::{AxisFlags, Flaw, ShaperWords, VelocityWords};
use crate::text::is_word;

/// The shapers of M593; the value of each is its number in M593 T (Prusa-Firmware-Buddy).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ShaperName {
    /// Zero vibration.
    Zv = 0,
    /// Zero vibration and derivative.
    Zvd = 1,
    /// Modified zero vibration.
    Mzv = 2,
    /// Extra insensitive.
    Ei = 3,
    /// Extra insensitive with two humps.
    TwoHumpEi = 4,
}

/// All shapers, with their names in RepRapFirmware's M593 P. Its `ei2` has two humps.
const NAMES: [(&[u8], ShaperName); 6] = [
    (b"zv", ShaperName::Zv),
    (b"zvd", ShaperName::Zvd),
    (b"mzv", ShaperName::Mzv),
    (b"ei", ShaperName::Ei),
    (b"2hump_ei", ShaperName::TwoHumpEi),
    (b"ei2", ShaperName::TwoHumpEi),
];

impl ShaperName {
    /// The shaper with that number.
    #[must_use]
    pub fn of(number: Number) -> Option<Self> {
        NAMES.into_iter().map(|(_, name)| name).find(|name| Number::from(*name as i32) == number)
    }
}

/// M593; a report is of both axes. S is RepRapFirmware's D.
pub(super) fn shaper(text: &[u8]) -> Command<'static> {
    let (mut frequency, mut damping, mut kind) = (None, None, None);
    let mut name = None;
    for word in Words::new(text) {
        match word.letter {
            b'F' => frequency = word.number,
            b'D' | b'S' => damping = word.number,
            b'T' => kind = word.number,
            b'P' => name = Some(word.quoted.unwrap_or_default()),
            _ => {}
        }
    }
    if let Some(name) = name {
        let known = NAMES.iter().find(|(other, _)| is_word(name, other));
        // No shaper has the number -1.
        kind = Some(Number::from(known.map_or(-1, |(_, shaper)| *shaper as i32)));
        if is_word(name, b"none") {
            (frequency, kind) = (Some(Number::ZERO), None);
        }
    }
    let is_report = frequency.or(damping).or(kind).is_none();
    let named = if is_report { AxisFlags::default() } else { axis_flags(text) };
    Command::Setting(SettingCommand::Shaper(ShaperWords {
        axes: AxisFlags { z: false, e: false, ..named },
        frequency,
        damping,
        kind,
    }))
}

/// M900 K (Marlin). Slicers that are programs in Python write small numbers as `K1e-05`, which are two words.
pub(super) fn linear_advance(text: &[u8]) -> Command<'static> {
    let mut time: Option<Number> = None;
    for word in Words::new(text) {
        match word.letter {
            b'K' => time = word.number,
            b'E' => time = time.map(|k| times_ten_to(k, word.number.unwrap_or_default())),
            _ => {}
        }
    }
    Command::Setting(SettingCommand::Advance { time, window: None })
}

/// M572 S and W (RepRapFirmware, Prusa). D is the extruder (`index`).
pub(super) fn pressure_advance(text: &[u8]) -> Command<'static> {
    let [time, window] = numbers(text, b"SW");
    Command::Setting(SettingCommand::Advance { time, window })
}

/// SET_PRESSURE_ADVANCE ADVANCE=.. SMOOTH_TIME=.. (Klipper). EXTRUDER names the extruder; there is only one.
pub(super) fn set_pressure_advance(text: &[u8]) -> Command<'_> {
    const NAMES: [&str; 3] = ["ADVANCE", "SMOOTH_TIME", "EXTRUDER"];
    let mut numbers = [None; 2];
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| match pair.place {
        2 => absent_extruder("SET_PRESSURE_ADVANCE", pair.value).map(Flaw::Absent),
        _ => pair.put_number(&mut numbers),
    });
    let [time, window] = numbers;
    flaw.map_or(Command::Setting(SettingCommand::Advance { time, window }), Command::Malformed)
}

/// SET_VELOCITY_LIMIT (Klipper); without words a report.
pub(super) fn set_velocity_limit(text: &[u8]) -> Command<'_> {
    const NAMES: [&str; 5] = ["ACCEL", "ACCEL_TO_DECEL", "MINIMUM_CRUISE_RATIO", "SQUARE_CORNER_VELOCITY", "VELOCITY"];
    let (mut numbers, mut other) = ([None; 4], None);
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        // Klipper's own word before an unknown one.
        if pair.place == 4 || pair.place > 4 && other.is_none() {
            other = Some(pair.name);
        }
        pair.put_number(&mut numbers)
    });
    let [acceleration, to_deceleration, cruise_ratio, square_corner] = numbers;
    let limit = VelocityWords { acceleration, to_deceleration, cruise_ratio, square_corner, other };
    flaw.map_or(Command::Setting(SettingCommand::VelocityLimit(limit)), Command::Malformed)
}

#[cfg(test)]
mod tests;
