//! M106, M107: the speed of a fan, in its turn among the moves.

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Absent, Grammar, Named, Number, Part};
use crate::settings::{FanRole, Range, ThermalSettings, part_fans};
use crate::units::Ratio;

pub(in crate::machine) const SPEED: Entry = Entry::m("Heat and fans", &[106])
    .grammar(&Grammar::numbers(b"SP").parts(&[(b'I', Part::Preset)]))
    .does("P S", "fan P: S of 255")
    .examples(&[
        ("M106", &[]),
        ("M106 S91.8", &[]),
        ("M106 P3 S10", &[]),
        ("M106 P9 S10", &["echo:M106 ignored: there is no fan 9"]),
        ("M106 P-1", &["echo:M106 ignored: there is no fan of that number"]),
        ("M106 P1", &["echo:fan 1 is not commanded"]),
        ("M106 S300", &["echo:M106 S300 is out of range, set to 255"]),
        ("M106 S-5", &["echo:M106 S-5 is out of range, set to 0"]),
        ("M106 Sinf", &["echo:line ignored: S needs a number"]),
    ]);

pub(in crate::machine) const OFF: Entry = Entry::m("Heat and fans", &[107])
    .grammar(&Grammar::numbers(b"P"))
    .does("P", "fan P is off")
    .examples(&[("M107", &[]), ("M107 P2", &["echo:fan 2 is not commanded"])]);

/// M106 without S.
const FULL_SPEED: i32 = 255;

/// The number for full speed.
pub(in crate::machine) const FULL: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::const_from_int(255) };

/// A speed of 255 as one of 65,535.
const fn duty(speed: Ratio) -> u16 {
    ((speed.to_bits() as u64 * 257) >> 16) as u16
}

/// P is 0 without a word, and 255 for a number that no machine has. M106 without S is full speed.
pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, notices, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let speed = match command.code() {
        107 => Number::ZERO,
        _ => command.number(b'S').unwrap_or(Number::from(FULL_SPEED)),
    };
    let fan = command.number(b'P').map_or(0, |fan| u8::try_from(fan.to_int()).unwrap_or(u8::MAX));
    let fan = fan_meant(fan, &main_loop.settings.thermal);
    let role = main_loop.settings.thermal.fans.get(usize::from(fan)).map(|fan| fan.role);
    if !role.is_some_and(FanRole::is_commanded) {
        // Slicers name fans of other machines.
        let absent = Absent { command: Named::Code(b'M', 106), part: Part::Fan, which: &[fan] };
        if !notices.give_absent(absent.key()) {
            return Ok(Answer::Nothing);
        }
        match role {
            // Something else decides on it.
            Some(_) => main_loop.say(text!("echo:fan {fan} is not commanded")),
            // P is read into a byte, so this one stands for every greater number, too.
            None if fan == u8::MAX => main_loop.say(text!("echo:M106 ignored: there is no fan of that number")),
            None => main_loop.say(text!("echo:M106 ignored: there is no fan {fan}")),
        }
        return Ok(Answer::Said);
    }
    if let Some(speed) = clamps.near_of(["M106", "S"], speed, FULL, None) {
        main_loop.set_fan(fan, duty(speed)).await?;
    }
    Ok(Answer::Nothing)
}

/// The fan that M106 P means: where FAN0 has something else to do, P0 (and no P) is the part fan, as for slicers.
fn fan_meant(fan: u8, thermal: &ThermalSettings) -> u8 {
    if fan > 0 || thermal.fans.first().is_some_and(|first| first.role.is_commanded()) {
        return fan;
    }
    let parts = part_fans(thermal.fans.map(|fan| fan.role));
    (0..).zip(parts).find_map(|(place, is_part)| is_part.then_some(place)).unwrap_or(fan)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_speed_is_full_duty() {
        for (speed, expected) in [(0, 0), (1, 257), (128, 32_896), (255, 65_535)] {
            assert_eq!(duty(Ratio::from_num(speed)), expected);
        }
    }
}
