//! How heaters behave, as lines set it: M301, M304, M306.
//!
//! A heater is controlled by its model or by PID: by the model as it is made, by PID once M301 or M304 has set a gain, by the
//! model again once M306 has set a number. M503 says the one in use last (`reports::heat_settings_report`).

use crate::connectors::Heater;
use crate::gcode::{ModelWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::{HeatSetting, pid_code};
use crate::machine::numbers::rate;
use crate::machine::state::clamps::Clamps;
use crate::settings::{Control, HeaterSettings, Pid, Range, ThermalSettings, ranges};
use crate::units::{Ratio, Seconds};

/// The reciprocal of a time constant, in 1/s: of the longest and of the shortest legal one.
const RESPONSIVENESS: Range<Ratio> = Range { least: const { Ratio::lit("0.00834") }, most: Ratio::const_from_int(10) };

/// M301, M304.
pub(in crate::machine) fn set_pid(
    heater: Heater,
    gains: [Option<Number>; 3],
    settings: &mut HeaterSettings,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if gains == [None; 3] {
        return Answer::HeatSetting(HeatSetting::Pid(heater));
    }
    let mut wanted = settings.pid;
    let Pid { p, i, d } = &mut wanted;
    for ((place, letter), gain) in [(p, "P"), (i, "I"), (d, "D")].into_iter().zip(gains) {
        if let Some(gain) = gain {
            clamps.near([pid_code(heater), letter], gain, ranges::GAIN, place);
        }
    }
    if !clamps.refuses_line() {
        (settings.pid, settings.control) = (wanted, Control::Pid);
    }
    Answer::Nothing
}

/// M306. F is the whole loss with the part fan at full speed, as in Marlin.
pub(in crate::machine) fn set_model(
    heater: Heater,
    words: &ModelWords,
    thermal: &mut ThermalSettings,
    clamps: &mut Clamps,
) -> Answer<'static> {
    if *words == ModelWords::default() {
        return Answer::HeatSetting(HeatSetting::Model(heater));
    }
    let ModelWords { power, capacity, loss, fan_loss, responsiveness, heater_lag, filament } = *words;
    let mut wanted = *thermal;
    let settings = wanted.heater_mut(heater);
    if let Some(number) = power {
        clamps.near(["M306", "P"], number, ranges::POWER, &mut settings.power);
    }
    let model = &mut settings.model;
    if let Some(number) = capacity {
        clamps.near(["M306", "C"], number, ranges::CAPACITY, &mut model.capacity);
    }
    if let Some(number) = loss {
        clamps.near(["M306", "A"], number, ranges::LOSS, &mut model.loss);
    }
    if let Some(number) = fan_loss {
        let mut whole = model.loss.saturating_add(model.fan_loss);
        clamps.near(["M306", "F"], number, Range { least: model.loss, ..ranges::LOSS }, &mut whole);
        model.fan_loss = whole.saturating_sub(model.loss);
    }
    if let Some(number) = responsiveness {
        let old = rate(model.sensor_lag);
        if let Some(rate) = clamps.near_of(["M306", "R"], number, RESPONSIVENESS, Some(old)) {
            model.sensor_lag = ranges::LAG.clamp(reciprocal(rate));
        }
    }
    if let Some(number) = heater_lag {
        clamps.near(["M306", "L"], number, ranges::LAG, &mut model.heater_lag);
    }
    settings.control = Control::Model;
    if let Some(number) = filament {
        clamps.near(["M306", "H"], number, ranges::FILAMENT, &mut wanted.filament);
    }
    if !clamps.refuses_line() {
        *thermal = wanted;
    }
    Answer::Nothing
}

/// The time constant of a rate in 1/s.
fn reciprocal(rate: Ratio) -> Seconds {
    Seconds::from_bits(((1u64 << 40) / u64::from(rate.to_bits().max(1))).min(u64::from(u32::MAX)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lag_and_its_rate_read_back() {
        for ms in [20, 100, 1200, 5000, 20_000, 200_000] {
            let shown = rate(Seconds::from_num(f64::from(ms) / 1000.0));
            assert_eq!(rate(reciprocal(shown)), shown, "{ms}");
        }
    }
}
