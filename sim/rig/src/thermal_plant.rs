//! Heat: the thermal plant behind the firmware's thermal port.
//!
//! A machine without heaters has thermistors in a room of 25 C, and nothing is computed.

use crate::plant::{ChamberConstants, Drive, Plant, PlantConstants, Thermistor, share_at};
use corehbot::connectors::{FANS, Heater, OUTPUTS, Output, OutputSet, Sensor};
use corehbot::port::ThermalPort;
use corehbot::settings::{
    EXTRA_SENSORS, ExtraSensor, FanPlug, FanRole, HeaterSettings, Law, SensorSource, Settings, Tachometer,
    ThermalSettings, Thermistor as Kind, part_fans,
};
use corehbot::units::Celsius;

/// 100 kOhm under 4.7 kOhm, as on the Octopus: 0.955 of the reference.
const ROOM: u16 = 62594;

/// The processor of a board in this room.
const MCU: Celsius = Celsius::const_from_int(40);

/// A fan of 40 mm at full speed, 4800 turns a minute [estimate], and the duty below which it stands.
const FAN_TURNS_PER_S: f64 = 80.0;
const LEAST_FAN_DUTY: f64 = 0.1;

/// Cross-section of filament of 1.75 mm, mm2.
const FILAMENT: f64 = 2.405;

/// The plant behind the firmware's thermal port, and the firmware's last outputs.
pub struct Heat {
    plant: Option<Plant>,
    settings: ThermalSettings,
    /// Sensors that control no heater: one that guards a heater sits in its element, the others are in the room.
    sensors: [ExtraSensor; EXTRA_SENSORS],
    /// There is a filament sensor, and filament in it.
    has_filament: bool,
    steps_per_mm: f64,
    duties: [u16; OUTPUTS],
    fans: [u16; FANS],
    plugs: [FanPlug; FANS],
    fan_pulses: u8,
    /// Pulses that each fan's tachometer would have given.
    pulses: [f64; FANS],
    has_supply_switch: bool,
    is_supplied: bool,
    /// The extruder's steps at the last advance.
    extruded: i32,
}

impl Heat {
    /// The heat of a machine; without heaters nothing is computed.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        Self::with(settings, &constants(&settings.thermal))
    }

    /// The same with a plant that does not depend on the settings.
    #[must_use]
    pub fn with(settings: &Settings, constants: &PlantConstants) -> Self {
        let thermal = settings.thermal;
        Self {
            plant: thermal.has_heater().then(|| Plant::new(constants)),
            settings: thermal,
            sensors: thermal.sensors,
            has_filament: !settings.filament.connector.is_none(),
            steps_per_mm: settings.axes.e.steps_per_mm.to_num(),
            duties: [0; OUTPUTS],
            fans: [0; FANS],
            plugs: settings.fans,
            fan_pulses: settings.fan_pulses,
            pulses: [0.0; FANS],
            has_supply_switch: !settings.supply.is_none(),
            is_supplied: true,
            extruded: 0,
        }
    }

    /// The same on a plant that exists already, if there is one: a reset of the firmware cools nothing.
    #[must_use]
    pub fn standing_on(self, plant: Option<Plant>) -> Self {
        Self { plant: plant.filter(|_| self.plant.is_some()).or(self.plant), ..self }
    }

    /// The plant, for the run after this firmware.
    pub const fn take_plant(&mut self) -> Option<Plant> {
        self.plant.take()
    }

    /// The same with a hotend and a bed that have long been so hot, in C.
    #[must_use]
    pub fn hot(settings: &Settings, hotend_celsius: f64, bed_celsius: f64) -> Self {
        let plant = |thermal: &ThermalSettings| Plant::hot(&constants(thermal), hotend_celsius, bed_celsius);
        Self { plant: settings.thermal.has_heater().then(|| plant(&settings.thermal)), ..Self::new(settings) }
    }

    /// Time passes: the extruder has made `extruded` steps since the start.
    pub fn advance(&mut self, extruded: i32, seconds: f64) {
        let steps = extruded.wrapping_sub(core::mem::replace(&mut self.extruded, extruded));
        let part = |bits: u16| f64::from(bits) / 65_535.0;
        let duty = |heater| part(self.duties[self.settings.heater(heater).output as usize]);
        let cools = |role| {
            let mut fans = self.settings.fans.iter().zip(self.fans).filter(|(fan, _)| fan.role == role);
            fans.next().map(|(_, duty)| part(duty)).unwrap_or_default()
        };
        let parts = part_fans(self.settings.fans.map(|fan| fan.role));
        let blown = parts.into_iter().zip(self.fans).map(|(is_part, duty)| if is_part { part(duty) } else { 0.0 });
        let drive = Drive {
            hotend: duty(Heater::Hotend),
            bed: duty(Heater::Bed),
            chamber: duty(Heater::Chamber),
            part_fan: blown.fold(0.0, f64::max),
            hotend_fan: cools(FanRole::Hotend),
            flow_mm3_s: f64::from(steps) / self.steps_per_mm * FILAMENT / seconds,
            supply_on: self.is_supplied,
        };
        if let Some(plant) = &mut self.plant {
            plant.step(&drive, seconds);
        }
        self.turn(parts, seconds);
    }

    /// The fans turn for a while.
    fn turn(&mut self, parts: [bool; FANS], seconds: f64) {
        let broken =
            self.plant.as_mut().map(|plant| [plant.faults().hotend_fan_broken, plant.faults().part_fan_broken]);
        let [hotend_fan, part_fan] = broken.unwrap_or_default();
        for (fan, pulses) in self.pulses.iter_mut().enumerate() {
            let is_broken = match self.settings.fans[fan].role {
                FanRole::Hotend => hotend_fan,
                _ => parts[fan] && part_fan,
            };
            let duty = f64::from(self.fans[fan]) / 65_535.0;
            if self.is_supplied && !is_broken && duty >= LEAST_FAN_DUTY {
                *pulses += duty * FAN_TURNS_PER_S * f64::from(self.fan_pulses) * seconds;
            }
        }
    }

    /// Whether the line of a fan's tachometer is high: in the second half of each pulse.
    #[must_use]
    pub fn is_tachometer_high(&self, fan: usize) -> bool {
        self.pulses.get(fan).is_none_or(|pulses| (2.0 * pulses) as u64 % 2 == 1)
    }

    /// The plant, if there are heaters: to read, and to break.
    pub const fn plant(&mut self) -> Option<&mut Plant> {
        self.plant.as_mut()
    }

    /// Whether the heaters' supply is on (PS_ON).
    #[must_use]
    pub const fn is_supplied(&self) -> bool {
        self.is_supplied
    }

    /// A single conversion at a sensor, 0 to 4095, for a board that adds them up itself; `None` without heaters, and if
    /// no heater has this sensor.
    pub fn convert(&mut self, sensor: Sensor) -> Option<u16> {
        let place = self.place(sensor)?;
        self.plant.as_mut()?.convert(place)
    }

    /// The plant's sensor at this connector: sensors are connected as in the machine's file.
    fn place(&self, sensor: Sensor) -> Option<Sensor> {
        let of = |heater| self.settings.heater(heater).sensor == sensor;
        if of(Heater::Hotend) {
            Some(Sensor::Hotend0)
        } else if of(Heater::Bed) {
            Some(Sensor::Bed)
        } else if of(Heater::Chamber) && self.settings.heaters.chamber.is_fitted {
            Some(Sensor::Hotend1)
        } else {
            None
        }
    }

    /// The duty of each output, of 65,535.
    #[must_use]
    pub const fn duties(&self) -> [u16; OUTPUTS] {
        self.duties
    }

    /// The duty of a heater, of 65,535, if it is fitted.
    #[must_use]
    pub fn duty(&self, heater: Heater) -> Option<u16> {
        let settings = self.settings.heater(heater);
        settings.is_fitted.then(|| self.duties[settings.output as usize])
    }

    /// The duty of each fan, of 65,535.
    #[must_use]
    pub const fn fan_duties(&self) -> [u16; FANS] {
        self.fans
    }
}

/// The prototype's plant with the values of the machine's file.
#[must_use]
pub fn constants(thermal: &ThermalSettings) -> PlantConstants {
    let mut constants = PlantConstants::prototype();
    let (hotend, bed) = (&thermal.heaters.hotend, &thermal.heaters.bed);
    constants.hotend.heater.nominal_watt = hotend.power.to_num();
    constants.bed.heater.nominal_watt = bed.power.to_num();
    constants.hotend.heater.ptc_per_kelvin = hotend.model.ptc.to_num();
    constants.bed.heater.ptc_per_kelvin = bed.model.ptc.to_num();
    constants.hotend.sensor.thermistor = law(hotend.thermistor);
    constants.bed.sensor.thermistor = law(bed.thermistor);
    let share = |heater: &HeaterSettings, prototype: f64| heater.model.capacity.to_num::<f64>() / prototype;
    let (c, b) = (&mut constants.hotend, &mut constants.bed);
    let of_hotend = share(hotend, c.cartridge_joule_per_kelvin + c.block_joule_per_kelvin);
    c.block_joule_per_kelvin *= of_hotend;
    c.cartridge_joule_per_kelvin *= of_hotend;
    let of_bed = share(bed, b.mat_joule_per_kelvin + b.plate_joule_per_kelvin);
    b.plate_joule_per_kelvin *= of_bed;
    b.mat_joule_per_kelvin *= of_bed;
    constants.chamber = thermal.heaters.chamber.is_fitted.then(|| chamber(&thermal.heaters.chamber));
    constants
}

/// A chamber with the values of the machine's file.
fn chamber(heater: &HeaterSettings) -> ChamberConstants {
    let mut c = ChamberConstants::usual();
    let all = c.element_joule_per_kelvin + c.air_joule_per_kelvin;
    let share = heater.model.capacity.to_num::<f64>() / all;
    c.element_joule_per_kelvin *= share;
    c.air_joule_per_kelvin *= share;
    c.heater.nominal_watt = heater.power.to_num();
    c.heater.ptc_per_kelvin = heater.model.ptc.to_num();
    c.sensor.thermistor = law(heater.thermistor);
    c
}

/// The law of a sensor, from its data sheet.
fn law(kind: Kind) -> Thermistor {
    match (kind, kind.sheet().map(|sheet| sheet.law)) {
        (Kind::Beta { ohms, beta, cubic: 0 }, _) => Thermistor::Beta { ohm_at_25: ohms.into(), beta: beta.into() },
        (Kind::Beta { ohms, beta, cubic }, _) => Thermistor::bent(ohms.into(), beta.into(), f64::from(cubic) * 1e-9),
        (_, Some(Law::Ntc(points))) => Thermistor::through(points),
        (_, Some(Law::Platinum) | None) => Thermistor::Platinum,
    }
}

/// The reading of a sensor that controls no heater: in the element of the heater that it guards, or in the room's 25 C.
fn share_of(extra: &ExtraSensor, plant: Option<&Plant>) -> u16 {
    let kind = law(extra.thermistor);
    if let (Some((heater, _)), Some(plant)) = (extra.guarded(), plant) {
        return plant.second_sample(heater, &kind);
    }
    let PlantConstants { converter, ambient_celsius, .. } = PlantConstants::prototype();
    share_at(&kind, ambient_celsius, converter.pull_up_ohm)
}

impl ThermalPort for Heat {
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        let place = self.place(sensor);
        let is_extra = |extra: &&ExtraSensor| extra.is_fitted && extra.sensor == SensorSource::At(sensor);
        let extra = self.sensors.iter().find(is_extra).filter(|_| place.is_none() || self.plant.is_none());
        if let Some(extra) = extra {
            return Some(share_of(extra, self.plant.as_ref()));
        }
        let Some(plant) = &mut self.plant else {
            return matches!(sensor, Sensor::Bed | Sensor::Hotend0).then_some(ROOM);
        };
        place.map_or(Some(ROOM), |place| plant.sample(place))
    }

    fn reference(&mut self) -> Option<u16> {
        self.plant.as_mut()?.vref_sample()
    }

    fn mcu(&mut self) -> Option<Celsius> {
        Some(MCU)
    }

    fn outputs(&self) -> OutputSet {
        // The outputs of the Octopus.
        OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1)
    }

    fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        self.duties = *duties;
    }

    fn fans(&self) -> usize {
        FANS
    }

    fn set_fan(&mut self, fan: usize, duty: u16) {
        if let Some(place) = self.fans.get_mut(fan) {
            *place = duty;
        }
    }

    fn tachometer(&self, fan: usize) -> Option<u16> {
        self.plugs.get(fan).filter(|plug| plug.tachometer != Tachometer::None)?;
        self.pulses.get(fan).map(|pulses| *pulses as u64 as u16)
    }

    fn filament(&self) -> Option<bool> {
        self.has_filament.then_some(true)
    }

    fn has_supply_switch(&self) -> bool {
        self.has_supply_switch
    }

    fn switch_supply(&mut self, on: bool) {
        self.is_supplied = on || !self.has_supply_switch;
    }
}
