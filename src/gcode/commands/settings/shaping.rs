//! Shaping: input shapers, pressure advance in the words of three firmwares, and Klipper's minimum cruise ratio.

use super::super::Command;
use super::SettingCommand;
use crate::gcode::axes::axis_flags;
use crate::gcode::index::absent_extruder;
use crate::gcode::lexer::{Words, is_blank, numbers};
use crate::gcode::number::Number;
use crate::gcode::parts::{AxisFlags, Flaw, ShaperWords, VelocityWords};
use crate::text::is_word;
use fixed::types::I32F32;

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
    let (mut time, mut window) = (None, None);
    for word in words(text) {
        let Some((name, value)) = named_value(word) else { return Command::Malformed(Flaw::NoPair(word)) };
        let place = match name {
            name if is_word(name, b"EXTRUDER") => match absent_extruder("SET_PRESSURE_ADVANCE", value) {
                Some(absent) => return Command::Malformed(Flaw::Absent(absent)),
                None => continue,
            },
            name if is_word(name, b"ADVANCE") => &mut time,
            name if is_word(name, b"SMOOTH_TIME") => &mut window,
            _ => continue,
        };
        let Some(number) = scientific(value) else { return Command::Malformed(Flaw::NoPair(word)) };
        *place = Some(number);
    }
    Command::Setting(SettingCommand::Advance { time, window })
}

/// SET_VELOCITY_LIMIT (Klipper); without words a report.
pub(super) fn set_velocity_limit(text: &[u8]) -> Command<'_> {
    let mut limit = VelocityWords::default();
    for word in words(text) {
        let Some((name, value)) = named_value(word) else { return Command::Malformed(Flaw::NoPair(word)) };
        let place = match name {
            name if is_word(name, b"ACCEL") => &mut limit.acceleration,
            name if is_word(name, b"ACCEL_TO_DECEL") => &mut limit.to_deceleration,
            name if is_word(name, b"MINIMUM_CRUISE_RATIO") => &mut limit.cruise_ratio,
            name if is_word(name, b"SQUARE_CORNER_VELOCITY") => &mut limit.square_corner,
            // Klipper's own word before an unknown one.
            name if limit.other.is_none() || is_word(name, b"VELOCITY") => {
                limit.other = Some(name);
                continue;
            }
            _ => continue,
        };
        let Some(number) = scientific(value) else { return Command::Malformed(Flaw::NoPair(word)) };
        *place = Some(number);
    }
    Command::Setting(SettingCommand::VelocityLimit(limit))
}

/// The words between blanks, up to a comment. A text in quotes belongs to its word, with its spaces.
pub(in crate::gcode::commands) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let text = text.split(|byte| *byte == b';').next().unwrap_or_default();
    let mut is_quoted = false;
    let ends_word = move |byte: &u8| {
        is_quoted ^= *byte == b'"';
        is_blank(*byte) && !(is_quoted && *byte == b' ')
    };
    text.split(ends_word).filter(|word| !word.is_empty())
}

/// A name and the value after its `=`, which may stand in quotes.
pub(in crate::gcode::commands) fn named_value(word: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = word.iter().position(|byte| *byte == b'=').filter(|length| *length > 0)?;
    let value = match word.get(length + 1..)? {
        [b'"', inside @ .., b'"'] => inside,
        value => value,
    };
    Some((word.get(..length)?, value))
}

/// `number` times a power of ten, to the nearest (a tie away from zero).
fn times_ten_to(number: Number, exponent: Number) -> Number {
    let (bits, exponent) = (number.value().to_bits(), exponent.to_int());
    // Beyond 10^18 no digit is left, or it is beyond all limits.
    let power = 10i64.pow(exponent.unsigned_abs().min(18));
    let bits = if exponent < 0 { (bits + bits.signum() * (power / 2)) / power } else { bits.saturating_mul(power) };
    Number::saturating(I32F32::from_bits(bits))
}

/// A number that may have an exponent, up to the end of the text.
pub(in crate::gcode::commands) fn scientific(text: &[u8]) -> Option<Number> {
    let (number, after) = Number::read(text)?;
    let (exponent, after) = match after {
        [b'e' | b'E', exponent @ ..] => Number::read(exponent)?,
        _ => (Number::ZERO, after),
    };
    after.is_empty().then(|| times_ten_to(number, exponent))
}

#[cfg(test)]
mod tests;
