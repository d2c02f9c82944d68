//! Fans: which one M106 and M107 mean, and its speed in its turn among the moves.

use crate::gcode::{Absent, Named, Number, Part, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::next_step::NextStep;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::says::Facts;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
use crate::settings::{Range, ThermalSettings, part_fans};
use crate::units::Ratio;

/// The number for full speed.
pub(in crate::machine) const FULL: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::const_from_int(255) };

/// A speed of 255 as one of 65,535.
const fn duty(speed: Ratio) -> u16 {
    ((speed.to_bits() as u64 * 257) >> 16) as u16
}

/// M106, M107. P is 0 without a word, and 255 for a number that no machine has.
pub(in crate::machine) fn order_fan<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    States { clamps, notices, .. }: &mut States,
    command: &TableCommand<'_>,
    speed: Number,
) -> Answer<'static> {
    let fan = command.number(b'P').map_or(0, |fan| u8::try_from(fan.to_int()).unwrap_or(u8::MAX));
    let fan = fan_meant(fan, &main_loop.settings.thermal);
    // Slicers name fans of other machines.
    let answer = match main_loop.settings.thermal.fans.get(usize::from(fan)) {
        Some(settings) if settings.role.is_commanded() => None,
        Some(_) => Some(Answer::says(say_not_commanded, fan.into())),
        None => Some(Answer::says(say_no_fan, fan.into())),
    };
    if let Some(answer) = answer {
        let absent = Absent { command: Named::Code(b'M', 106), part: Part::Fan, which: &[fan] };
        return if notices.give_absent(absent.key()) { answer } else { Answer::Nothing };
    }
    let speed = clamps.near_of(["M106", "S"], speed, FULL, None);
    speed.map_or(Answer::Nothing, |speed| Answer::Then(NextStep::Fan(fan, duty(speed))))
}

/// Something else decides on it.
fn say_not_commanded(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    to.say(text!("echo:fan {} is not commanded", facts.number));
}

fn say_no_fan(to: &mut ReplyWriter<'_>, facts: &Facts<'_>) {
    // P is read into a byte, so this one stands for every greater number, too.
    if facts.number == i32::from(u8::MAX) {
        to.say(text!("echo:M106 ignored: there is no fan of that number"));
    } else {
        to.say(text!("echo:M106 ignored: there is no fan {}", facts.number));
    }
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
