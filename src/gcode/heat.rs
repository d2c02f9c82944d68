//! Heaters and fans: targets, waits, and heater models.

use super::command::Command;
use super::lexer::{Words, last, number};
use super::number::Number;
use super::parts::ModelWords;
use crate::connectors::Heater;

/// M106 without S: full speed.
const FULL_SPEED: i32 = 255;

/// M104, M140, M141. R is as good as S to set a target.
pub(super) fn target(heater: Heater, text: &[u8]) -> Command<'static> {
    Command::HeaterTarget { heater, target: number(text, b'S').or(number(text, b'R')) }
}

/// M109, M190, M191. With S and R it is S, as in Marlin.
pub(super) fn wait(heater: Heater, text: &[u8]) -> Command<'static> {
    let (heats, both) = (number(text, b'S'), number(text, b'R'));
    let cools = heats.is_none() && both.is_some();
    Command::HeaterWait { heater, target: heats.or(both), cools }
}

/// M106, and M107 with speed 0.
pub(super) fn fan(text: &[u8], stops: bool) -> Command<'static> {
    let fan = number(text, b'P').map_or(0, |fan| u8::try_from(fan.to_int()).unwrap_or(u8::MAX));
    let speed = if stops { Number::ZERO } else { number(text, b'S').unwrap_or(Number::from(FULL_SPEED)) };
    Command::FanSpeed { fan, speed }
}

/// M301, M304.
pub(super) fn pid(heater: Heater, text: &[u8]) -> Command<'static> {
    Command::Pid { heater, gains: [b'P', b'I', b'D'].map(|letter| number(text, letter)) }
}

/// The heater of E.
fn heater(text: &[u8]) -> Option<Heater> {
    match number(text, b'E').map_or(0, Number::to_int) {
        0 => Some(Heater::Hotend),
        -1 => Some(Heater::Bed),
        -2 => Some(Heater::Chamber),
        _ => None,
    }
}

/// M303. U alone is U1.
pub(super) fn tune(text: &[u8]) -> Command<'static> {
    let applies = last(text, b'U').is_some_and(|word| word.number != Some(Number::ZERO));
    Command::TuneHeater { heater: heater(text), target: number(text, b'S'), cycles: number(text, b'C'), applies }
}

/// M306. With T it tunes and uses the result.
pub(super) fn model(text: &[u8]) -> Command<'static> {
    let heater = heater(text);
    if last(text, b'T').is_some() {
        return Command::TuneHeater { heater, target: None, cycles: None, applies: true };
    }
    let [power, capacity, loss, fan_loss, responsiveness, heater_lag, filament] =
        [b'P', b'C', b'A', b'F', b'R', b'L', b'H'].map(|letter| number(text, letter));
    let words = ModelWords { power, capacity, loss, fan_loss, responsiveness, heater_lag, filament };
    Command::HeaterModel { heater, is_named: last(text, b'E').is_some(), words }
}

/// M302. P0 forbids, any other P allows.
pub(super) fn cold_extrusion(text: &[u8]) -> Command<'static> {
    let allow = number(text, b'P').map(|allow| allow != Number::ZERO);
    Command::ColdExtrusion { least: number(text, b'S'), allow }
}

/// M710.
pub(super) fn controller_fan(text: &[u8]) -> Command<'static> {
    let other = Words::new(text).map(|word| word.letter).find(|letter| matches!(letter, b'A' | b'I'));
    let resets = last(text, b'R').is_some();
    Command::ControllerFan { speed: number(text, b'S'), run_on: number(text, b'D'), resets, other }
}
