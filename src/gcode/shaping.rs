//! Shaping: input shapers, pressure advance in the words of three firmwares, and Klipper's minimum cruise ratio.

use super::command::{AxisFlags, Command, Flaw, VelocityWords};
use super::lexer::{Words, is_blank};
use super::number::Number;
use super::parse::axis_flags;
use fixed::types::I32F32;

/// The shapers in the words of RepRapFirmware's M593 P, and their numbers in M593 T. Its `ei2` has two humps.
const NAMES: [(&[u8], i32); 6] = [(b"zv", 0), (b"zvd", 1), (b"mzv", 2), (b"ei", 3), (b"2hump_ei", 4), (b"ei2", 4)];

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
        let known = NAMES.iter().find(|(other, _)| name.eq_ignore_ascii_case(other));
        // No shaper has the number -1.
        kind = Some(Number::from(known.map_or(-1, |(_, number)| *number)));
        if name.eq_ignore_ascii_case(b"none") {
            (frequency, kind) = (Some(Number::ZERO), None);
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

/// SET_PRESSURE_ADVANCE ADVANCE=.. SMOOTH_TIME=.. (Klipper). EXTRUDER is the extruder, of which there is one.
pub(super) fn set_pressure_advance(text: &[u8]) -> Command<'_> {
    let (mut time, mut window) = (None, None);
    for word in words(text) {
        let Some((name, value)) = named_value(word) else { return Command::Malformed(Flaw::NoPair(word)) };
        let place = match name {
            name if name.eq_ignore_ascii_case(b"ADVANCE") => &mut time,
            name if name.eq_ignore_ascii_case(b"SMOOTH_TIME") => &mut window,
            _ => continue,
        };
        let Some(number) = scientific(value) else { return Command::Malformed(Flaw::NoPair(word)) };
        *place = Some(number);
    }
    Command::Advance { time, window }
}

/// SET_VELOCITY_LIMIT (Klipper); without words a report.
pub(super) fn set_velocity_limit(text: &[u8]) -> Command<'_> {
    let mut limit = VelocityWords::default();
    for word in words(text) {
        let Some((name, value)) = named_value(word) else { return Command::Malformed(Flaw::NoPair(word)) };
        let place = match name {
            name if name.eq_ignore_ascii_case(b"ACCEL") => &mut limit.acceleration,
            name if name.eq_ignore_ascii_case(b"ACCEL_TO_DECEL") => &mut limit.to_deceleration,
            name if name.eq_ignore_ascii_case(b"MINIMUM_CRUISE_RATIO") => &mut limit.cruise_ratio,
            name if name.eq_ignore_ascii_case(b"SQUARE_CORNER_VELOCITY") => &mut limit.square_corner,
            _ => {
                limit.other = limit.other.or(Some(name));
                continue;
            }
        };
        let Some(number) = scientific(value) else { return Command::Malformed(Flaw::NoPair(word)) };
        *place = Some(number);
    }
    Command::VelocityLimit(limit)
}

/// What stands between blanks, as far as a comment.
fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let text = text.split(|byte| *byte == b';').next().unwrap_or_default();
    text.split(|byte| is_blank(*byte)).filter(|word| !word.is_empty())
}

/// A name and the value after its `=`.
fn named_value(word: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = word.iter().position(|byte| *byte == b'=').filter(|length| *length > 0)?;
    Some((word.get(..length)?, word.get(length + 1..)?))
}

/// `number` times a power of ten, to the nearest (a tie away from zero).
fn times_ten_to(number: Number, exponent: Number) -> Number {
    let (bits, exponent) = (number.value().to_bits(), exponent.to_int());
    // Beyond 10^18 nothing is left, or it is beyond all limits.
    let power = 10i64.pow(exponent.unsigned_abs().min(18));
    let bits = if exponent < 0 { (bits + bits.signum() * (power / 2)) / power } else { bits.saturating_mul(power) };
    Number::saturating(I32F32::from_bits(bits))
}

/// A number that may have an exponent, and nothing after it.
fn scientific(text: &[u8]) -> Option<Number> {
    let (number, after) = Number::read(text)?;
    let (exponent, after) = match after {
        [b'e' | b'E', exponent @ ..] => Number::read(exponent)?,
        _ => (Number::ZERO, after),
    };
    after.is_empty().then(|| times_ten_to(number, exponent))
}

#[cfg(test)]
mod tests {
    extern crate std;

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
        assert_eq!(parse(b"M593 P\"mzv\" F60"), shaper(false, false, "60", "", "2"));
        assert_eq!(parse(b"M593 X P \"EI2\" F60 S0.1"), shaper(true, false, "60", "0.1", "4"));
        assert_eq!(parse(b"M593 P\"none\""), shaper(false, false, "0", "", ""));
        for line in ["M593 P\"zvdd\" F60", "M593 P F60", "M593 P2 F60"] {
            assert_eq!(parse(line.as_bytes()), shaper(false, false, "60", "", "-1"), "{line}");
        }
        for line in ["M593", "M593 X"] {
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
        for line in ["M900", "M572", "M572 D0", "M900 W0.4", "SET_PRESSURE_ADVANCE"] {
            assert_eq!(parse(line.as_bytes()), advance(None, None), "{line}");
        }
    }

    #[test]
    fn velocity_limits_in_the_words_of_klipper() {
        let limit = |line: &'static str| match parse(line.as_bytes()) {
            Command::VelocityLimit(limit) => limit,
            other => panic!("{line}: {other:?}"),
        };
        let none = VelocityWords::default();
        assert_eq!(
            limit("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.3"),
            VelocityWords { cruise_ratio: number("0.3"), ..none }
        );
        assert_eq!(
            limit("set_velocity_limit accel=5e2 minimum_cruise_ratio=0 accel_to_decel=250 square_corner_velocity=8"),
            VelocityWords {
                acceleration: number("500"),
                to_deceleration: number("250"),
                cruise_ratio: number("0"),
                square_corner: number("8"),
                other: None
            }
        );
        assert_eq!(
            limit("SET_VELOCITY_LIMIT VELOCITY=100 ACCEL=5"),
            VelocityWords { acceleration: number("5"), other: Some(b"VELOCITY"), ..none }
        );
        assert_eq!(limit("SET_VELOCITY_LIMIT ; all of them"), none);
        for word in ["ACCEL=", "ACCEL=x", "ACCEL=5,5", "ACCEL", "=5", "ACCEL=1e", "ACCEL=1-2"] {
            for name in ["SET_VELOCITY_LIMIT", "SET_PRESSURE_ADVANCE"] {
                let line = std::format!(
                    "{name} {}",
                    if name.ends_with('E') { word.replace("CCEL", "DVANCE") } else { word.into() }
                );
                assert!(matches!(parse(line.as_bytes()), Command::Malformed(Flaw::NoPair(_))), "{line}");
            }
        }
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
