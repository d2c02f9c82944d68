//! Heaters and fans of a machine file.

use super::MachineFileError;
use super::form::{
    FanToml, FansToml, GuardsToml, HeaterToml, HeatersToml, ModelToml, PidToml, ThermalToml, ThermistorToml,
};
use super::quantity::{
    BED, CAPACITY, COLD_END, FILAMENT, GAIN, HEATING, HOTEND, Kind, LAG, LEAST_LOSS, LOSS, LOST, MAX_DUTY, MIN_EXTRUDE,
    OFF_RISE, OVERSHOOT, PART, POWER, put, put_whole,
};
use corehbot::connectors::{Output, Sensor};
use corehbot::settings::{
    Control, FanRole, FanSettings, Guards, HeaterModel, HeaterSettings, Pid, Range, ThermalSettings, Thermistor, ranges,
};
use corehbot::units::Celsius;

/// Puts what the file says of heat in the place of the defaults.
pub(super) fn thermal(
    t: &mut ThermalSettings,
    common: &ThermalToml,
    heaters: &HeatersToml,
    fans: &FansToml,
) -> Result<(), MachineFileError> {
    put(&mut t.min_extrude, "thermal.min_extrude", common.min_extrude, &MIN_EXTRUDE)?;
    put(&mut t.hotend_fan_above, "thermal.hotend_fan_above", common.hotend_fan_above, &COLD_END)?;
    put_whole(&mut t.fan_run_on_s, "thermal.fan_run_on_s", common.fan_run_on_s, ranges::RUN_ON_S)?;
    put_whole(&mut t.idle_min, "thermal.idle_min", common.idle_min, ranges::IDLE_MIN)?;
    put(&mut t.filament, "thermal.filament", common.filament, &FILAMENT)?;
    heater(&mut t.heaters.hotend, "heaters.hotend", &heaters.hotend, &HOTEND)?;
    heater(&mut t.heaters.bed, "heaters.bed", &heaters.bed, &BED)?;
    heater(&mut t.heaters.chamber, "heaters.chamber", &heaters.chamber, &BED)?;
    let FansToml { fan0, fan1, fan2, fan3, fan4, fan5 } = fans;
    for (number, (slot, file)) in t.fans.iter_mut().zip([fan0, fan1, fan2, fan3, fan4, fan5]).enumerate() {
        fan(slot, &format!("fans.fan{number}"), file)?;
    }
    Ok(())
}

fn heater(
    h: &mut HeaterSettings,
    table: &str,
    file: &HeaterToml,
    target: &Kind<Celsius>,
) -> Result<(), MachineFileError> {
    h.is_fitted = file.is_fitted.unwrap_or(h.is_fitted);
    h.output = file.output.map_or(h.output, Output::from);
    h.sensor = file.sensor.map_or(h.sensor, Sensor::from);
    if let Some(file) = file.thermistor {
        h.thermistor = thermistor(file, table)?;
    }
    put(&mut h.most, &format!("{table}.most"), file.most, target)?;
    put(&mut h.power, &format!("{table}.power"), file.power, &POWER)?;
    put(&mut h.max_duty, &format!("{table}.max_duty"), file.max_duty, &MAX_DUTY)?;
    put_whole(&mut h.period_ms, &format!("{table}.period_ms"), file.period_ms, ranges::RELAY_MS)?;
    h.control = file.control.map_or(h.control, Control::from);
    model(&mut h.model, table, &file.model)?;
    pid(&mut h.pid, table, &file.pid)?;
    guards(&mut h.guards, table, &file.guards)
}

fn thermistor(file: ThermistorToml, table: &str) -> Result<Thermistor, MachineFileError> {
    Ok(match file {
        ThermistorToml::Semitec104Gt2 => Thermistor::Semitec104Gt2,
        ThermistorToml::Semitec104Nt4 => Thermistor::Semitec104Nt4,
        ThermistorToml::Generic3950 => Thermistor::Generic3950,
        ThermistorToml::Slice450 => Thermistor::Slice450,
        ThermistorToml::Pt1000 => Thermistor::Pt1000,
        ThermistorToml::Beta { ohms, beta } => {
            let (mut whole_ohms, mut whole_beta) = (ranges::OHMS.least, ranges::BETA.least);
            let (o, b) = (format!("{table}.thermistor.ohms"), format!("{table}.thermistor.beta"));
            let kind = Kind { range: ranges::OHMS, convert: |ohms| ohms as u32 };
            put(&mut whole_ohms, &o, Some(ohms), &kind)?;
            put_whole(&mut whole_beta, &b, Some(beta), ranges::BETA)?;
            Thermistor::Beta { ohms: whole_ohms, beta: whole_beta }
        }
    })
}

fn model(m: &mut HeaterModel, table: &str, file: &ModelToml) -> Result<(), MachineFileError> {
    put(&mut m.capacity, &format!("{table}.model.capacity"), file.capacity, &CAPACITY)?;
    put(&mut m.loss, &format!("{table}.model.loss"), file.loss, &LOSS)?;
    put(&mut m.fan_loss, &format!("{table}.model.fan_loss"), file.fan_loss, &LEAST_LOSS)?;
    put(&mut m.heater_lag, &format!("{table}.model.heater_lag"), file.heater_lag, &LAG)?;
    put(&mut m.sensor_lag, &format!("{table}.model.sensor_lag"), file.sensor_lag, &LAG)
}

fn pid(p: &mut Pid, table: &str, file: &PidToml) -> Result<(), MachineFileError> {
    for (slot, name, value) in [(&mut p.p, "p", file.p), (&mut p.i, "i", file.i), (&mut p.d, "d", file.d)] {
        put(slot, &format!("{table}.pid.{name}"), value, &GAIN)?;
    }
    Ok(())
}

fn guards(g: &mut Guards, table: &str, file: &GuardsToml) -> Result<(), MachineFileError> {
    put(&mut g.heating, &format!("{table}.guards.heating"), file.heating, &HEATING)?;
    put(&mut g.lost, &format!("{table}.guards.lost"), file.lost, &LOST)?;
    put_whole(&mut g.lost_s, &format!("{table}.guards.lost_s"), file.lost_s, ranges::LOST_S)?;
    put(&mut g.off_rise, &format!("{table}.guards.off_rise"), file.off_rise, &OFF_RISE)?;
    put(&mut g.overshoot, &format!("{table}.guards.overshoot"), file.overshoot, &OVERSHOOT)
}

fn fan(f: &mut FanSettings, table: &str, file: &FanToml) -> Result<(), MachineFileError> {
    f.role = file.role.map_or(f.role, FanRole::from);
    let kick = Range { ..ranges::KICK_MS };
    put_whole(&mut f.kick_ms, &format!("{table}.kick_ms"), file.kick_ms, kick)?;
    put(&mut f.least, &format!("{table}.least"), file.least, &PART)?;
    put(&mut f.most, &format!("{table}.most"), file.most, &PART)
}
