//! Fans: which one M106 and M107 mean, and its speed in its turn among the moves.

use crate::gcode::{Absent, Named, Number, Part, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
use crate::settings::{FanRole, Range, ThermalSettings, part_fans};
use crate::units::Ratio;

/// The number for full speed.
pub(in crate::machine) const FULL: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::const_from_int(255) };

/// A speed of 255 as one of 65,535.
const fn duty(speed: Ratio) -> u16 {
    ((speed.to_bits() as u64 * 257) >> 16) as u16
}

/// M106, M107. P is 0 without a word, and 255 for a number that no machine has.
pub(in crate::machine) async fn order_fan<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, notices, .. }: &mut States,
    command: &TableCommand<'_>,
    speed: Number,
) -> Result<Answer<'static>, Interrupt> {
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
