//! How heaters behave, as the lines that set it: M306 and M710, alone and in M503; M301, M304 and M302 in M503.
//!
//! M503 says the control in use last, so that its lines, sent back, leave it in use.

use super::plain_setting::PlainSetting;
use crate::connectors::Heater;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::numbers::{rate, shortest};
use crate::settings::{Control, FanRole, Settings, ThermalSettings};
use crate::units::Ratio;

/// M306: the line of a heater's model.
pub(in crate::machine) fn report_model(to: &mut ReplyWriter<'_>, heater: Heater, thermal: &ThermalSettings) {
    let settings = thermal.heater(heater);
    let model = settings.model;
    let (power, capacity, lag) = (shortest(settings.power), shortest(model.capacity), shortest(model.heater_lag));
    let [a, f] = [model.loss, model.loss.saturating_add(model.fan_loss)].map(shortest);
    let (rate, filament) = (shortest(rate(model.sensor_lag)), shortest(thermal.filament));
    // A BTT TFT takes the number behind E as a hotend's, whatever the number is, and writes the values after it
    // there (MPC.c). So E of a bed or a chamber comes last.
    let [first, last] = match heater {
        Heater::Hotend => ["E0 ", ""],
        Heater::Bed => ["", " E-1"],
        Heater::Chamber => ["", " E-2"],
    };
    if model.ptc == Ratio::ZERO {
        to.setting(text!("M306 {first}P{power} C{capacity} A{a} F{f} R{rate} L{lag} H{filament}{last}"));
    } else {
        let ptc = shortest(model.ptc);
        to.setting(text!("M306 {first}P{power} C{capacity} A{a} F{f} R{rate} L{lag} H{filament} K{ptc}{last}"));
    }
}

/// M710.
pub(in crate::machine) fn report_controller_fan(to: &mut ReplyWriter<'_>, thermal: &ThermalSettings) {
    let fan = thermal.fans.iter().find(|fan| fan.role == FanRole::Controller);
    let speed = fan.map_or(0, |fan| (u64::from(fan.most.to_bits()) * 255 + (1 << 15)) >> 16);
    to.setting(text!("M710 S{speed} D{}", thermal.fan_run_on_s));
}

/// M503, the part of heaters that are fitted.
pub(in crate::machine) fn report_heat_settings(to: &mut ReplyWriter<'_>, s: &Settings) {
    let thermal = &s.thermal;
    let fitted = || Heater::ALL.into_iter().filter(|heater| thermal.heater(*heater).is_fitted);
    for heater in fitted() {
        let gains = match heater {
            Heater::Hotend => Some(301),
            Heater::Bed => Some(304),
            // There is no command for the chamber's gains.
            Heater::Chamber => None,
        };
        let gains = gains.map(|code| PlainSetting { code, s });
        let is_by_model = gains.is_none() || thermal.heater(heater).control == Control::Model;
        if !is_by_model {
            report_model(to, heater, thermal);
        }
        if let Some(gains) = gains {
            to.setting(text!("{gains}"));
        }
        if is_by_model {
            report_model(to, heater, thermal);
        }
    }
    if thermal.heater(Heater::Hotend).is_fitted {
        to.setting(text!("M302 S{}", shortest(thermal.min_extrude)));
    }
    if fitted().next().is_some() {
        report_controller_fan(to, thermal);
    }
}
