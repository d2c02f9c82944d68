//! How heaters behave, as lines set and show it: M301, M304, M306, and M302 and M710 in M503.
//!
//! A heater is controlled by its model or by PID: by the model as it is made, by PID once M301 or M304 has set a gain, by the
//! model again once M306 has set a number. M503 says the one in use last, so that its lines, sent back, leave it in use.

use crate::connectors::Heater;
use crate::gcode::{ModelWords, Number};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::HeatSetting;
use crate::machine::answers::speaker::Speaker;
use crate::machine::numbers::shortest;
use crate::machine::state::clamps::Clamps;
use crate::settings::{Control, FanRole, HeaterSettings, Pid, Range, ThermalSettings, ranges};
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
    let Pid { p, i, d } = &mut settings.pid;
    for ((place, letter), gain) in [(p, "P"), (i, "I"), (d, "D")].into_iter().zip(gains) {
        if let Some(gain) = gain {
            *place = clamps.near([pid_code(heater), letter], gain, ranges::GAIN);
        }
    }
    settings.control = Control::Pid;
    Answer::Nothing
}

const fn pid_code(heater: Heater) -> &'static str {
    match heater {
        Heater::Hotend => "M301",
        Heater::Bed => "M304",
        Heater::Chamber => "M309",
    }
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
    let settings = thermal.heater_mut(heater);
    if let Some(number) = power {
        settings.power = clamps.near(["M306", "P"], number, ranges::POWER);
    }
    let model = &mut settings.model;
    if let Some(number) = capacity {
        model.capacity = clamps.near(["M306", "C"], number, ranges::CAPACITY);
    }
    if let Some(number) = loss {
        model.loss = clamps.near(["M306", "A"], number, ranges::LOSS);
    }
    if let Some(number) = fan_loss {
        let whole = clamps.near(["M306", "F"], number, Range { least: model.loss, ..ranges::LOSS });
        model.fan_loss = whole.saturating_sub(model.loss);
    }
    if let Some(number) = responsiveness {
        let lag = reciprocal(clamps.near(["M306", "R"], number, RESPONSIVENESS));
        model.sensor_lag = ranges::LAG.clamp(lag);
    }
    if let Some(number) = heater_lag {
        model.heater_lag = clamps.near(["M306", "L"], number, ranges::LAG);
    }
    settings.control = Control::Model;
    if let Some(number) = filament {
        thermal.filament = clamps.near(["M306", "H"], number, ranges::FILAMENT);
    }
    Answer::Nothing
}

/// The time constant of a rate in 1/s.
fn reciprocal(rate: Ratio) -> Seconds {
    Seconds::from_bits(((1u64 << 40) / u64::from(rate.to_bits().max(1))).min(u64::from(u32::MAX)) as u32)
}

/// The rate of a time constant, in 1/s.
fn rate(lag: Seconds) -> Ratio {
    let bits = (1u64 << 40) + u64::from(lag.to_bits() / 2);
    Ratio::from_bits((bits / u64::from(lag.to_bits().max(1))).min(u64::from(u32::MAX)) as u32)
}

/// The line of one of them.
pub(in crate::machine) fn say_heat_setting(to: &mut Speaker<'_>, setting: HeatSetting, thermal: &ThermalSettings) {
    match setting {
        HeatSetting::Pid(heater) => {
            let Pid { p, i, d } = thermal.heater(heater).pid;
            let [p, i, d] = [p, i, d].map(shortest);
            to.say(format_args!("echo:  {} P{p} I{i} D{d}", pid_code(heater)));
        }
        HeatSetting::Model(heater) => {
            let settings = thermal.heater(heater);
            let model = settings.model;
            let (power, capacity, lag) =
                (shortest(settings.power), shortest(model.capacity), shortest(model.heater_lag));
            let [a, f] = [model.loss, model.loss.saturating_add(model.fan_loss)].map(shortest);
            let (rate, filament) = (shortest(rate(model.sensor_lag)), shortest(thermal.filament));
            let e = -(heater as i32);
            to.say(format_args!("echo:  M306 E{e} P{power} C{capacity} A{a} F{f} R{rate} L{lag} H{filament}"));
        }
        HeatSetting::ColdExtrusion => to.say(format_args!("echo:  M302 S{}", shortest(thermal.min_extrude))),
        HeatSetting::ControllerFan => {
            let fan = thermal.fans.iter().find(|fan| fan.role == FanRole::Controller);
            let speed = fan.map_or(0, |fan| (u64::from(fan.most.to_bits()) * 255 + (1 << 15)) >> 16);
            to.say(format_args!("echo:  M710 S{speed} D{}", thermal.fan_run_on_s));
        }
    }
}

/// M503, the part of heaters that are fitted.
pub(in crate::machine) fn say_heat_settings(to: &mut Speaker<'_>, thermal: &ThermalSettings) {
    let fitted = || Heater::ALL.into_iter().filter(|heater| thermal.heater(*heater).is_fitted);
    for heater in fitted() {
        let (pid, model) = (HeatSetting::Pid(heater), HeatSetting::Model(heater));
        let lines = match (heater, thermal.heater(heater).control) {
            // There is no command for the chamber's gains.
            (Heater::Chamber, _) => [None, Some(model)],
            (_, Control::Model) => [Some(pid), Some(model)],
            (_, Control::Pid) => [Some(model), Some(pid)],
        };
        for line in lines.into_iter().flatten() {
            say_heat_setting(to, line, thermal);
        }
    }
    if thermal.heater(Heater::Hotend).is_fitted {
        say_heat_setting(to, HeatSetting::ColdExtrusion, thermal);
    }
    if fitted().next().is_some() {
        say_heat_setting(to, HeatSetting::ControllerFan, thermal);
    }
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
