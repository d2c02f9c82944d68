//! Shaping: input shapers, pressure advance in the words of three firmwares, and Klipper's minimum cruise ratio.

use super::command::{AxisFlags, Command};
use super::lexer::{Words, is_blank};
use super::number::Number;
use super::parse::axis_flags;
use fixed::types::I32F32;

/// M593; a report is of both axes.
pub(super) fn shaper(text: &[u8]) -> Command<'static> {
    let (mut frequency, mut damping, mut kind) = (None, None, None);
    for word in Words::new(text) {
        match word.letter {
            b'F' => frequency = word.number,
            b'D' => damping = word.number,
            b'T' => kind = word.number,
            _ => {}
        }
    }
    let is_report = frequency.or(damping).or(kind).is_none();
    let named = if is_report { AxisFlags::default() } else { axis_flags(text) };
    Command::Shaper { axes: AxisFlags { z: false, e: false, ..named }, frequency, damping, kind }
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
    Command::Advance { time, window: None }
}

/// M572 S and W (RepRapFirmware, Prusa). D is the extruder, of which there is one.
pub(super) fn pressure_advance(text: &[u8]) -> Command<'static> {
    let (mut time, mut window) = (None, None);
    for word in Words::new(text) {
        match word.letter {
            b'S' => time = word.number,
            b'W' => window = word.number,
            _ => {}
        }
    }
    Command::Advance { time, window }
}

/// SET_PRESSURE_ADVANCE ADVANCE=.. SMOOTH_TIME=.. (Klipper).
pub(super) fn set_pressure_advance(text: &[u8]) -> Command<'static> {
    Command::Advance { time: value(text, b"ADVANCE="), window: value(text, b"SMOOTH_TIME=") }
}

/// SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=.. (Klipper); without words a report. Its other words are not known.
pub(super) fn set_velocity_limit(text: &[u8]) -> Option<Command<'static>> {
    let ratio = value(text, b"MINIMUM_CRUISE_RATIO=");
    let is_report = words(text).all(<[u8]>::is_empty);
    (ratio.is_some() || is_report).then_some(Command::CruiseRatio(ratio))
}

/// What stands between blanks, as far as a comment.
fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|byte| *byte == b';').next().unwrap_or_default().split(|byte| is_blank(*byte))
}

/// The number behind a name with its `=`.
fn value(text: &[u8], name: &[u8]) -> Option<Number> {
    words(text).find_map(|word| {
        let (key, value) = word.split_at_checked(name.len())?;
        key.eq_ignore_ascii_case(name).then(|| scientific(value))?
    })
}

/// `number` times a power of ten, to the nearest (a tie away from zero).
fn times_ten_to(number: Number, exponent: Number) -> Number {
    let (bits, exponent) = (number.value().to_bits(), exponent.to_int());
    // Beyond 10^18 nothing is left, or it is beyond all limits.
    let power = 10i64.pow(exponent.unsigned_abs().min(18));
    let bits = if exponent < 0 { (bits + bits.signum() * (power / 2)) / power } else { bits.saturating_mul(power) };
    Number::saturating(I32F32::from_bits(bits))
}

/// A number that may have an exponent.
fn scientific(text: &[u8]) -> Option<Number> {
    let (number, rest) = Number::read(text)?;
    let exponent = match rest {
        [b'e' | b'E', exponent @ ..] => Number::read(exponent).unwrap_or_default().0,
        _ => Number::ZERO,
    };
    Some(times_ten_to(number, exponent))
}

#[cfg(test)]
mod tests {
    use super::super::parse::parse;
    use super::*;

    fn number(text: &str) -> Option<Number> {
        Number::read(text.as_bytes()).map(|(number, _)| number)
    }

    fn advance(time: Option<&str>, window: Option<&str>) -> Command<'static> {
        Command::Advance { time: time.and_then(number), window: window.and_then(number) }
    }

    #[test]
    fn shapers_of_one_axis_or_both() {
        let shaper = |x, y, frequency, damping, kind| Command::Shaper {
            axes: AxisFlags { x, y, z: false, e: false },
            frequency: number(frequency),
            damping: number(damping),
            kind: number(kind),
        };
        assert_eq!(parse(b"M593 X F60 D.1 T2"), shaper(true, false, "60", "0.1", "2"));
        assert_eq!(parse(b"M593 F0"), shaper(false, false, "0", "", ""));
        assert_eq!(parse(b"M593 Y Z T1"), shaper(false, true, "", "", "1"));
        for line in ["M593", "M593 X", "M593 F"] {
            assert_eq!(parse(line.as_bytes()), shaper(false, false, "", "", ""), "{line}");
        }
    }

    #[test]
    fn pressure_advance_in_three_dialects() {
        assert_eq!(parse(b"M900 K.05"), advance(Some("0.05"), None));
        assert_eq!(parse(b"M572 D0 S0.05 W.03"), advance(Some("0.05"), Some("0.03")));
        let line = b"SET_PRESSURE_ADVANCE EXTRUDER=extruder ADVANCE=0.05 SMOOTH_TIME=0.03";
        assert_eq!(parse(line), advance(Some("0.05"), Some("0.03")));
        assert_eq!(parse(b"set_pressure_advance advance=0.05; SMOOTH_TIME=2"), advance(Some("0.05"), None));
        for line in ["M900", "M572", "M572 D0", "M900 W0.4", "SET_PRESSURE_ADVANCE", "SET_PRESSURE_ADVANCE ADVANCE="] {
            assert_eq!(parse(line.as_bytes()), advance(None, None), "{line}");
        }
    }

    #[test]
    fn the_minimum_cruise_ratio_in_the_words_of_klipper() {
        assert_eq!(parse(b"SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.3"), Command::CruiseRatio(number("0.3")));
        assert_eq!(parse(b"set_velocity_limit accel=500 minimum_cruise_ratio=0"), Command::CruiseRatio(number("0")));
        assert_eq!(parse(b"SET_VELOCITY_LIMIT ; all of them"), Command::CruiseRatio(None));
        let other = b"SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=5";
        assert_eq!(parse(other), Command::Unknown(other));
    }

    #[test]
    fn a_small_number_may_have_an_exponent() {
        for line in ["M900 K1e-05", "M900 K1E-5", "SET_PRESSURE_ADVANCE ADVANCE=1e-05"] {
            assert_eq!(parse(line.as_bytes()), advance(Some("0.00001"), None), "{line}");
        }
        assert_eq!(parse(b"M900 K1.5e+1"), advance(Some("15"), None));
        assert_eq!(parse(b"M900 K1e-999"), advance(Some("0"), None));
        assert_eq!(parse(b"M900 K1e999"), advance(Some("1000000000"), None));
        assert_eq!(parse(b"M900 E-5"), advance(None, None));
    }
}
