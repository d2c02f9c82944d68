//! How heaters behave, as the lines that set it: M301, M304, M306 and M710, alone and in M503; M302 in M503.
//!
//! M503 says the control in use last, so that its lines, sent back, leave it in use.

use crate::connectors::Heater;
use crate::machine::answers::setting::{HeatSetting, pid_code};
use crate::machine::answers::speaker::Speaker;
use crate::machine::numbers::{rate, shortest};
use crate::settings::{Control, FanRole, Pid, ThermalSettings};

/// The line of one of them.
pub(in crate::machine) fn report_heat_setting(to: &mut Speaker<'_>, setting: HeatSetting, thermal: &ThermalSettings) {
    match setting {
        HeatSetting::Pid(heater) => {
            let Pid { p, i, d } = thermal.heater(heater).pid;
            let [p, i, d] = [p, i, d].map(shortest);
            to.setting(format_args!("{} P{p} I{i} D{d}", pid_code(heater)));
        }
        HeatSetting::Model(heater) => {
            let settings = thermal.heater(heater);
            let model = settings.model;
            let (power, capacity, lag) =
                (shortest(settings.power), shortest(model.capacity), shortest(model.heater_lag));
            let [a, f] = [model.loss, model.loss.saturating_add(model.fan_loss)].map(shortest);
            let (rate, filament) = (shortest(rate(model.sensor_lag)), shortest(thermal.filament));
            // A BTT TFT takes the number behind E as a hotend's, whatever the number is, and writes the values after it
            // there (MPC.c). So E of a bed or a chamber comes last.
            let [first, last] = match heater {
                Heater::Hotend => ["E0 ", ""],
                Heater::Bed => ["", " E-1"],
                Heater::Chamber => ["", " E-2"],
            };
            to.setting(format_args!("M306 {first}P{power} C{capacity} A{a} F{f} R{rate} L{lag} H{filament}{last}"));
        }
        HeatSetting::ColdExtrusion => to.setting(format_args!("M302 S{}", shortest(thermal.min_extrude))),
        HeatSetting::ControllerFan => {
            let fan = thermal.fans.iter().find(|fan| fan.role == FanRole::Controller);
            let speed = fan.map_or(0, |fan| (u64::from(fan.most.to_bits()) * 255 + (1 << 15)) >> 16);
            to.setting(format_args!("M710 S{speed} D{}", thermal.fan_run_on_s));
        }
    }
}

/// M503, the part of heaters that are fitted.
pub(in crate::machine) fn report_heat_settings(to: &mut Speaker<'_>, thermal: &ThermalSettings) {
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
            report_heat_setting(to, line, thermal);
        }
    }
    if thermal.heater(Heater::Hotend).is_fitted {
        report_heat_setting(to, HeatSetting::ColdExtrusion, thermal);
    }
    if fitted().next().is_some() {
        report_heat_setting(to, HeatSetting::ControllerFan, thermal);
    }
}
