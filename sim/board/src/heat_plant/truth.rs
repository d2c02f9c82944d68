//! Truth: a TOML file with the true values of the simulated machine's heaters. Every key is optional; a missing key
//! takes the machine's setting.

use anyhow::{Result, anyhow};
use corehbot_machine_file::{Place, words};
use corehbot_rig::plant::{ChamberConstants, PlantConstants};
use serde::Deserialize;

/// The prototype's hotend at 215 C, in K above the room: where `hotend.loss` is meant.
const ABOVE_ROOM: f64 = 190.0;

/// Everything.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct TruthToml {
    ambient: Option<f64>,
    supply: Option<f64>,
    noise: Option<f64>,
    seed: Option<u64>,
    hotend: HeaterToml,
    bed: HeaterToml,
    chamber: HeaterToml,
    coupling: CouplingToml,
}

/// A heater.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct HeaterToml {
    power: Option<f64>,
    capacity: Option<f64>,
    loss: Option<f64>,
    fan_loss: Option<f64>,
    heater_lag: Option<f64>,
    sensor_lag: Option<f64>,
    ptc: Option<f64>,
    sensor_in_mat: Option<bool>,
}

/// Heat between two of them.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct CouplingToml {
    hotend_bed: Option<f64>,
    hotend_chamber: Option<f64>,
    bed_chamber: Option<f64>,
}

/// The legal values of a key, with its unit.
#[derive(Clone, Copy)]
struct Legal {
    least: f64,
    most: f64,
    unit: &'static str,
}

/// A number of the file, if it is there and legal.
struct Number {
    key: String,
    value: Option<f64>,
    legal: Legal,
}

const fn legal(least: f64, most: f64, unit: &'static str) -> Legal {
    Legal { least, most, unit }
}

const ROOM: Legal = legal(-30.0, 60.0, "C");
const SUPPLY: Legal = legal(5.0, 60.0, "V");
const NOISE: Legal = legal(0.0, 50.0, "LSB");
const POWER: Legal = legal(1.0, 5000.0, "W");
const CAPACITY: Legal = legal(1.0, 100_000.0, "J/K");
const LOSS: Legal = legal(0.001, 100.0, "W/K");
const FAN_LOSS: Legal = legal(0.0, 100.0, "W/K");
const LAG: Legal = legal(0.05, 600.0, "s");
const PTC: Legal = legal(0.0, 0.01, "1/K");
const COUPLING: Legal = legal(0.0, 20.0, "W/K");

impl Number {
    /// Hands the number to `set`.
    fn put(self, text: &str, set: impl FnOnce(f64)) -> Result<()> {
        let Self { key, value, legal: Legal { least, most, unit } } = self;
        let Some(value) = value else { return Ok(()) };
        if !(least..=most).contains(&value) {
            let place = Place::of_key(text, &key).map_or_else(String::new, |place| format!("{place}: "));
            return Err(anyhow!("{place}{key} = {value} is outside {least} to {most} {unit}"));
        }
        set(value);
        Ok(())
    }
}

/// The plant of a file, on top of the default plant.
///
/// # Errors
/// The problem, with line and column.
pub fn read(text: &str, plant: PlantConstants) -> Result<PlantConstants> {
    let file: TruthToml = toml::from_str(text).map_err(|error| match error.span() {
        Some(span) => anyhow!("{}: {}", Place::of_byte(text, span.start), words(&error)),
        None => anyhow!("{}", words(&error)),
    })?;
    let mut plant = plant;
    let put = |key: &str, value: Option<f64>, legal: Legal, set: &mut dyn FnMut(f64)| {
        Number { key: key.to_owned(), value, legal }.put(text, set)
    };
    put("ambient", file.ambient, ROOM, &mut |celsius| plant.ambient_celsius = celsius)?;
    put("supply", file.supply, SUPPLY, &mut |volts| plant.supply_volts = volts)?;
    put("noise", file.noise, NOISE, &mut |lsb| plant.converter.noise_lsb = lsb)?;
    plant.converter.seed = file.seed.unwrap_or(plant.converter.seed);
    let of = |heater: &str, key: &str| format!("{heater}.{key}");

    let (h, t) = (&mut plant.hotend, &file.hotend);
    put(&of("hotend", "power"), t.power, POWER, &mut |watt| h.heater.nominal_watt = watt)?;
    put(&of("hotend", "capacity"), t.capacity, CAPACITY, &mut |joule| {
        let share = joule / (h.cartridge_joule_per_kelvin + h.block_joule_per_kelvin);
        h.cartridge_joule_per_kelvin *= share;
        h.block_joule_per_kelvin *= share;
        h.cartridge_to_block_watt_per_kelvin *= share;
    })?;
    put(&of("hotend", "loss"), t.loss, LOSS, &mut |watt| {
        let air = h.block_to_air_watt_per_kelvin + h.block_to_air_rise_watt_per_kelvin_sq * ABOVE_ROOM;
        let share = watt / (air + h.block_to_sink_watt_per_kelvin);
        h.block_to_air_watt_per_kelvin *= share;
        h.block_to_air_rise_watt_per_kelvin_sq *= share;
        h.block_to_sink_watt_per_kelvin *= share;
    })?;
    put(&of("hotend", "fan_loss"), t.fan_loss, FAN_LOSS, &mut |watt| h.part_fan_watt_per_kelvin = watt)?;
    put(&of("hotend", "heater_lag"), t.heater_lag, LAG, &mut |lag| {
        h.cartridge_to_block_watt_per_kelvin = h.cartridge_joule_per_kelvin / lag;
    })?;
    put(&of("hotend", "ptc"), t.ptc, PTC, &mut |growth| h.heater.ptc_per_kelvin = growth)?;
    put(&of("hotend", "sensor_lag"), t.sensor_lag, LAG, &mut |lag| h.sensor.lag_seconds = lag)?;

    let (b, t) = (&mut plant.bed, &file.bed);
    put(&of("bed", "power"), t.power, POWER, &mut |watt| b.heater.nominal_watt = watt)?;
    put(&of("bed", "capacity"), t.capacity, CAPACITY, &mut |joule| {
        let share = joule / (b.mat_joule_per_kelvin + b.plate_joule_per_kelvin);
        b.mat_joule_per_kelvin *= share;
        b.plate_joule_per_kelvin *= share;
        b.mat_to_plate_watt_per_kelvin *= share;
    })?;
    put(&of("bed", "loss"), t.loss, LOSS, &mut |watt| b.plate_to_air_watt_per_kelvin = watt)?;
    put(&of("bed", "heater_lag"), t.heater_lag, LAG, &mut |lag| {
        b.mat_to_plate_watt_per_kelvin = b.mat_joule_per_kelvin / lag;
    })?;
    put(&of("bed", "ptc"), t.ptc, PTC, &mut |growth| b.heater.ptc_per_kelvin = growth)?;
    put(&of("bed", "sensor_lag"), t.sensor_lag, LAG, &mut |lag| b.sensor.lag_seconds = lag)?;
    b.is_sensor_in_mat = t.sensor_in_mat.unwrap_or(b.is_sensor_in_mat);
    for (heater, t) in [("hotend", &file.hotend), ("chamber", &file.chamber)] {
        if t.sensor_in_mat.is_some() {
            let key = of(heater, "sensor_in_mat");
            let place = Place::of_key(text, &key).map_or_else(String::new, |place| format!("{place}: "));
            return Err(anyhow!("{place}{key}: only a bed has a mat"));
        }
    }
    chamber(text, &file.chamber, &mut plant.chamber)?;

    for (heater, t) in [("bed", &file.bed), ("chamber", &file.chamber)] {
        if t.fan_loss.is_some() {
            let key = of(heater, "fan_loss");
            let place = Place::of_key(text, &key).map_or_else(String::new, |place| format!("{place}: "));
            return Err(anyhow!("{place}{key}: the part fan cools the hotend alone"));
        }
    }
    let (c, t) = (&mut plant.couplings, &file.coupling);
    put("coupling.hotend_bed", t.hotend_bed, COUPLING, &mut |watt| c.hotend_bed = watt)?;
    put("coupling.hotend_chamber", t.hotend_chamber, COUPLING, &mut |watt| c.hotend_chamber = watt)?;
    put("coupling.bed_chamber", t.bed_chamber, COUPLING, &mut |watt| c.bed_chamber = watt)?;
    Ok(plant)
}

/// The chamber, if the machine has one or the file says something of it.
fn chamber(text: &str, t: &HeaterToml, chamber: &mut Option<ChamberConstants>) -> Result<()> {
    let numbers = [
        ("power", t.power, POWER),
        ("capacity", t.capacity, CAPACITY),
        ("loss", t.loss, LOSS),
        ("heater_lag", t.heater_lag, LAG),
        ("sensor_lag", t.sensor_lag, LAG),
        ("ptc", t.ptc, PTC),
    ];
    if numbers.iter().all(|(_, value, _)| value.is_none()) {
        return Ok(());
    }
    let c = chamber.get_or_insert_with(ChamberConstants::usual);
    for (name, value, legal) in numbers {
        Number { key: format!("chamber.{name}"), value, legal }.put(text, |number| match name {
            "power" => c.heater.nominal_watt = number,
            "capacity" => {
                let share = number / (c.element_joule_per_kelvin + c.air_joule_per_kelvin);
                c.element_joule_per_kelvin *= share;
                c.air_joule_per_kelvin *= share;
                c.element_to_air_watt_per_kelvin *= share;
            }
            "loss" => c.air_to_room_watt_per_kelvin = number,
            "ptc" => c.heater.ptc_per_kelvin = number,
            "heater_lag" => c.element_to_air_watt_per_kelvin = c.element_joule_per_kelvin / number,
            _ => c.sensor.lag_seconds = number,
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "ambient = 12.5\nnoise = 3\nseed = 7\n[hotend]\npower = 60\ncapacity = 34\nloss = 0.16\n\
        heater_lag = 2\nsensor_lag = 3\n[bed]\npower = 220\ncapacity = 5500\n[chamber]\ncapacity = 3000\n\
        [coupling]\nbed_chamber = 1.5\n";

    #[test]
    fn a_plant_is_what_its_file_says() {
        let plant = read(FILE, PlantConstants::prototype()).unwrap();
        let h = &plant.hotend;
        assert_eq!((plant.ambient_celsius, plant.converter.noise_lsb, plant.converter.seed), (12.5, 3.0, 7));
        assert!((h.cartridge_joule_per_kelvin + h.block_joule_per_kelvin - 34.0).abs() < 1e-9);
        assert!((h.cartridge_joule_per_kelvin / h.cartridge_to_block_watt_per_kelvin - 2.0).abs() < 1e-9);
        let air = h.block_to_air_watt_per_kelvin + h.block_to_air_rise_watt_per_kelvin_sq * ABOVE_ROOM;
        assert!((air + h.block_to_sink_watt_per_kelvin - 0.16).abs() < 1e-9);
        assert_eq!((h.heater.nominal_watt, h.sensor.lag_seconds), (60.0, 3.0));
        let b = &plant.bed;
        assert!((b.mat_joule_per_kelvin + b.plate_joule_per_kelvin - 5500.0).abs() < 1e-9);
        // Values that the file does not name stay: the lag from mat to plate too.
        assert!((b.mat_joule_per_kelvin / b.mat_to_plate_watt_per_kelvin - 5.0).abs() < 1e-9);
        assert_eq!(b.plate_to_air_watt_per_kelvin, 3.5);
        let c = plant.chamber.unwrap();
        assert!((c.element_joule_per_kelvin + c.air_joule_per_kelvin - 3000.0).abs() < 1e-9);
        assert_eq!(plant.couplings.bed_chamber, 1.5);
        let nothing = read("", PlantConstants::prototype()).unwrap();
        assert_eq!(format!("{nothing:?}"), format!("{:?}", PlantConstants::prototype()));
    }

    #[test]
    fn what_is_wrong_has_a_place_and_what_is_legal() {
        let wrong = |text: &str| read(text, PlantConstants::prototype()).unwrap_err().to_string();
        assert_eq!(wrong("[hotend]\npower = 0"), "2:9: hotend.power = 0 is outside 1 to 5000 W");
        assert_eq!(wrong("noise = nan"), "1:9: noise = NaN is outside 0 to 50 LSB");
        assert!(
            wrong("[hotend]\npowr = 40").starts_with("2:1: unknown field `powr`"),
            "{}",
            wrong("[hotend]\npowr = 40")
        );
        assert!(wrong("[hotend]\npowr = 40").ends_with("did you mean `power`?"));
        assert_eq!(wrong("[bed]\nfan_loss = 1"), "2:12: bed.fan_loss: the part fan cools the hotend alone");
    }
}
