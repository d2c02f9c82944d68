//! Tests of shaping.

extern crate std;

use super::*;
use crate::gcode::parse::parse;

fn number(text: &str) -> Option<Number> {
    Number::read(text.as_bytes()).map(|(number, _)| number)
}

fn advance(time: Option<&str>, window: Option<&str>) -> Command<'static> {
    Command::Setting(SettingCommand::Advance { time: time.and_then(number), window: window.and_then(number) })
}

#[test]
fn shapers_of_one_axis_or_both() {
    let shaper = |x, y, frequency, damping, kind| {
        Command::Setting(SettingCommand::Shaper(ShaperWords {
            axes: AxisFlags { x, y, z: false, e: false },
            frequency: number(frequency),
            damping: number(damping),
            kind: number(kind),
        }))
    };
    assert_eq!(parse(b"M593 X F60 D.1 T2"), shaper(true, false, "60", "0.1", "2"));
    assert_eq!(parse(b"M593 F0"), shaper(false, false, "0", "", ""));
    assert_eq!(parse(b"M593 Y Z E T1"), shaper(false, true, "", "", "1"));
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
        Command::Setting(SettingCommand::VelocityLimit(limit)) => limit,
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
    for others in ["VELOCITY=9 FOO=1", "FOO=1 velocity=9 BAR=3"] {
        let line = std::format!("SET_VELOCITY_LIMIT {others}");
        let Command::Setting(SettingCommand::VelocityLimit(limit)) = parse(line.as_bytes()) else { panic!("{line}") };
        assert!(limit.other.is_some_and(|name| name.eq_ignore_ascii_case(b"VELOCITY")), "{line}");
    }
    assert_eq!(limit("SET_VELOCITY_LIMIT FOO=1 BAR=3"), VelocityWords { other: Some(b"FOO"), ..none });
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
    assert_eq!(parse(b"M900 K-1e-05"), advance(Some("-0.00001"), None));
    assert_eq!(parse(b"M900 K1.5e+1"), advance(Some("15"), None));
    assert_eq!(parse(b"M900 K1.5e0"), advance(Some("1.5"), None));
    assert_eq!(parse(b"M900 K1e-999"), advance(Some("0"), None));
    assert_eq!(parse(b"M900 K1e999"), advance(Some("1000000000"), None));
    assert_eq!(parse(b"M900 E-5"), advance(None, None));
}

#[test]
fn shapers_are_numbered_as_prusa_numbers_them() {
    let shapers = [ShaperName::Zv, ShaperName::Zvd, ShaperName::Mzv, ShaperName::Ei, ShaperName::TwoHumpEi];
    for (number, shaper) in (0..).zip(shapers) {
        assert_eq!(ShaperName::of(Number::from(number)), Some(shaper));
    }
    for text in ["-1", "5", "1.5"] {
        assert_eq!(number(text).and_then(ShaperName::of), None, "{text}");
    }
}
