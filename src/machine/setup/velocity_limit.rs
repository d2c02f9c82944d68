//! SET_VELOCITY_LIMIT: limits in Klipper's words, always in mm, even after G20.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Nature, Number, flaw_of_pairs};
use crate::machine::reports::setting::Setting;
use crate::machine::reports::settings_report::report_setting;
use crate::machine::state::program::Dynamics;
use crate::settings::{CornerRule, Range, ranges};
use crate::units::{MmPerSec2, Ratio, mul_div};

const NAME: &str = "SET_VELOCITY_LIMIT";

pub(in crate::machine) const ENTRY: Entry = Entry::name("Settings", &[NAME])
    .nature(Nature::Mode)
    .judge(|_, text| Words::read(text).err().into())
    .does(
        "ACCEL= SQUARE_CORNER_VELOCITY= MINIMUM_CRUISE_RATIO= ACCEL_TO_DECEL=",
        "acceleration, corner speed, cruise ratio; or reports",
    )
    .examples(&[
        ("SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.3", &[]),
        ("SET_VELOCITY_LIMIT ACCEL=1000 ACCEL_TO_DECEL=500 SQUARE_CORNER_VELOCITY=5", &[]),
        ("SET_VELOCITY_LIMIT VELOCITY=200", &["echo:SET_VELOCITY_LIMIT VELOCITY is not supported by this firmware"]),
        ("SET_VELOCITY_LIMIT", &["  SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0.5"]),
        (
            "SET_VELOCITY_LIMIT ACCEL=0",
            &["echo:SET_VELOCITY_LIMIT ignored: ACCEL=0 is out of range (1 to 100000), stays 3000"],
        ),
        (
            "SET_VELOCITY_LIMIT ACCEL=1000 ACCEL_TO_DECEL=50",
            &["echo:SET_VELOCITY_LIMIT ignored: ACCEL_TO_DECEL=50 is out of range (100*"],
        ),
        ("SET_VELOCITY_LIMIT ACCEL=fast", &["echo:line ignored: \"ACCEL=fast\" is not a name with = and a number"]),
    ]);

/// Its words.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
struct Words<'a> {
    /// ACCEL, mm/s2.
    acceleration: Option<Number>,
    /// ACCEL_TO_DECEL, mm/s2.
    to_deceleration: Option<Number>,
    /// MINIMUM_CRUISE_RATIO.
    cruise_ratio: Option<Number>,
    /// SQUARE_CORNER_VELOCITY, mm/s.
    square_corner: Option<Number>,
    /// The name of another word: VELOCITY, or else the first.
    other: Option<&'a [u8]>,
}

impl<'a> Words<'a> {
    #[inline(never)]
    fn read(text: &'a [u8]) -> Result<Self, Flaw<'a>> {
        const NAMES: [&str; 5] =
            ["ACCEL", "ACCEL_TO_DECEL", "MINIMUM_CRUISE_RATIO", "SQUARE_CORNER_VELOCITY", "VELOCITY"];
        let (mut numbers, mut other) = ([None; 4], None);
        let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
            // Klipper's own word before an unknown one.
            if pair.place == 4 || pair.place > 4 && other.is_none() {
                other = Some(pair.name);
            }
            pair.put_number(&mut numbers)
        });
        let [acceleration, to_deceleration, cruise_ratio, square_corner] = numbers;
        flaw.map_or(Ok(Self { acceleration, to_deceleration, cruise_ratio, square_corner, other }), Err)
    }
}

/// Klipper has one acceleration, and braking had its own word before there was the ratio (klippy/toolhead.py).
pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    let words = Words::read(command.text()).unwrap_or_default();
    let mut s = main_loop.live_settings();
    if words == Words::default() {
        return Answer::words(&|to, facts| report_setting(to, Setting::VelocityLimit, facts.settings));
    }
    let mut dynamics = Dynamics::of(&s);
    let [mut acceleration, retract, travel] = dynamics.accelerations;
    if let Some(number) = words.acceleration {
        clamps.plain([NAME, "ACCEL="], number, ranges::ACCELERATION, &mut acceleration);
    }
    let square_corner = words.square_corner.and_then(|number| {
        let old = if let CornerRule::SquareCorner(old) = s.corner { Some(old) } else { None };
        clamps.plain_of([NAME, "SQUARE_CORNER_VELOCITY="], number, ranges::SPEED, old)
    });
    let mut cruise_ratio = dynamics.cruise_ratio;
    if let Some(number) = words.cruise_ratio {
        clamps.near([NAME, "MINIMUM_CRUISE_RATIO="], number, ranges::CRUISE_RATIO, &mut cruise_ratio);
    } else if let Some(number) = words.to_deceleration {
        // As an acceleration the ratio is the missing part of ACCEL; more than all of ACCEL gives 0.
        let one = u64::from(Ratio::ONE.to_bits());
        let whole = u64::from(acceleration.to_bits());
        let missing = |ratio: Ratio| mul_div(whole, one.saturating_sub(u64::from(ratio.to_bits())), one) as u32;
        let [least, mut wanted] = [ranges::CRUISE_RATIO.most, cruise_ratio].map(missing).map(MmPerSec2::from_bits);
        let range = Range { least: least.max(ranges::ACCELERATION.least), ..ranges::ACCELERATION };
        clamps.plain([NAME, "ACCEL_TO_DECEL="], number, range, &mut wanted);
        let part = mul_div(one, u64::from(wanted.to_bits()), whole);
        cruise_ratio = ranges::CRUISE_RATIO.clamp(Ratio::from_bits(one.saturating_sub(part) as u32));
    }
    if clamps.refuses_line() {
        return Answer::Nothing;
    }
    let travel = if words.acceleration.is_some() { acceleration } else { travel };
    dynamics.accelerations = [acceleration, retract, travel];
    dynamics.corner = square_corner.map_or(dynamics.corner, CornerRule::SquareCorner);
    dynamics.cruise_ratio = cruise_ratio;
    s.set_dynamics(&dynamics);
    words.other.map_or(Answer::Nothing, |other| Answer::NotObeyed(NAME, other))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Option<Number> {
        Number::read(text.as_bytes()).map(|(number, _)| number)
    }

    fn words(text: &str) -> Words<'_> {
        Words::read(text.as_bytes()).unwrap()
    }

    #[test]
    fn velocity_limits_in_the_words_of_klipper() {
        let none = Words::default();
        assert_eq!(words(" MINIMUM_CRUISE_RATIO=0.3"), Words { cruise_ratio: number("0.3"), ..none });
        assert_eq!(
            words(" accel=5e2 minimum_cruise_ratio=0 accel_to_decel=250 square_corner_velocity=8"),
            Words {
                acceleration: number("500"),
                to_deceleration: number("250"),
                cruise_ratio: number("0"),
                square_corner: number("8"),
                other: None
            }
        );
        let expected = Words { acceleration: number("5"), other: Some(b"VELOCITY"), ..none };
        assert_eq!(words(" VELOCITY=100 ACCEL=5"), expected);
        for others in [" VELOCITY=9 FOO=1", " FOO=1 velocity=9 BAR=3"] {
            assert!(words(others).other.is_some_and(|name| name.eq_ignore_ascii_case(b"VELOCITY")), "{others}");
        }
        assert_eq!(words(" FOO=1 BAR=3"), Words { other: Some(b"FOO"), ..none });
        assert_eq!(words(" ; all of them"), none);
        for word in [" ACCEL=", " ACCEL=x", " ACCEL=5,5", " ACCEL", " =5", " ACCEL=1e", " ACCEL=1-2"] {
            assert!(matches!(Words::read(word.as_bytes()), Err(Flaw::NoPair(_))), "{word}");
        }
    }
}
