//! Heat: the rig's thermal plant behind the firmware's thermal port, in virtual time.
//!
//! A machine without heaters has thermistors in a room of 25 C, and nothing is computed.

use corehbot::connectors::{FANS, Heater, OUTPUTS, Output, OutputSet, Sensor};
use corehbot::motors::Motor;
use corehbot::port::ThermalPort;
use corehbot::settings::{FanRole, HeaterSettings, Settings, ThermalSettings};
use corehbot_rig::plant::{Drive, Plant, PlantConstants, Thermistor};
use std::cell::{Cell, RefCell};

/// 100 kOhm under 4.7 kOhm, as on the Octopus: 0.955 of the reference.
const ROOM: u16 = 62594;

/// Cross-section of filament of 1.75 mm, mm2.
const FILAMENT: f64 = 2.405;

/// The plant, and what the firmware last told it.
#[derive(Default)]
pub struct Heat {
    plant: RefCell<Option<Plant>>,
    duties: Cell<[u16; OUTPUTS]>,
    fans: Cell<[u16; FANS]>,
    is_supplied: Cell<bool>,
    /// The extruder's steps when last looked at.
    extruded: Cell<i32>,
}

impl Heat {
    /// The plant of a machine, if it has heaters.
    pub(crate) fn equip(&self, settings: &Settings) {
        let thermal = &settings.thermal;
        let is_heated = Heater::ALL.into_iter().any(|heater| thermal.heater(heater).is_fitted);
        *self.plant.borrow_mut() = is_heated.then(|| Plant::new(&constants(thermal)));
        self.is_supplied.set(true);
    }

    /// Time passes: the extruder has made so many steps since the start.
    pub(crate) fn step(&self, settings: &Settings, extruded: i32, seconds: f64) {
        let steps = extruded.wrapping_sub(self.extruded.replace(extruded));
        let Some(plant) = &mut *self.plant.borrow_mut() else { return };
        let mm = f64::from(steps) / settings.steps_per_mm(Motor::E0).to_num::<f64>();
        let part = |bits: u16| f64::from(bits) / 65_535.0;
        let duty = |heater| part(self.duties.get()[settings.thermal.heater(heater).output as usize]);
        let cools = |role| {
            let fans = settings.thermal.fans.iter().zip(self.fans.get()).filter(|(fan, _)| fan.role == role);
            fans.map(|(_, duty)| part(duty)).next().unwrap_or_default()
        };
        let drive = Drive {
            hotend: duty(Heater::Hotend),
            bed: duty(Heater::Bed),
            part_fan: cools(FanRole::Commanded),
            hotend_fan: cools(FanRole::Hotend),
            flow_mm3_s: mm * FILAMENT / seconds,
            supply_on: self.is_supplied.get(),
        };
        plant.step(&drive, seconds);
    }

    /// The true temperatures of hotend and bed in C, if there are heaters.
    #[must_use]
    pub fn celsius(&self) -> Option<[f64; 2]> {
        self.plant.borrow().as_ref().map(|plant| [plant.hotend_celsius(), plant.bed_celsius()])
    }

    /// Has a test break something.
    pub fn break_it(&self, what: impl FnOnce(&mut corehbot_rig::plant::PlantFaults)) {
        if let Some(plant) = &mut *self.plant.borrow_mut() {
            what(plant.faults());
        }
    }
}

/// The prototype's plant with what the machine's file says of it.
fn constants(thermal: &ThermalSettings) -> PlantConstants {
    let mut constants = PlantConstants::prototype();
    let (hotend, bed) = (&thermal.heaters.hotend, &thermal.heaters.bed);
    constants.hotend.heater.nominal_watt = hotend.power.to_num();
    constants.bed.heater.nominal_watt = bed.power.to_num();
    constants.hotend.sensor.thermistor = law(hotend);
    constants.bed.sensor.thermistor = law(bed);
    let share = |heater: &HeaterSettings, prototype: f64| heater.model.capacity.to_num::<f64>() / prototype;
    let (c, b) = (&mut constants.hotend, &mut constants.bed);
    let of_hotend = share(hotend, c.cartridge_joule_per_kelvin + c.block_joule_per_kelvin);
    c.block_joule_per_kelvin *= of_hotend;
    c.cartridge_joule_per_kelvin *= of_hotend;
    let of_bed = share(bed, b.mat_joule_per_kelvin + b.plate_joule_per_kelvin);
    b.plate_joule_per_kelvin *= of_bed;
    b.mat_joule_per_kelvin *= of_bed;
    constants
}

/// The law of a sensor, from its data sheet (in C and Ohm).
fn law(heater: &HeaterSettings) -> Thermistor {
    use corehbot::settings::Thermistor as Kind;
    match heater.thermistor {
        Kind::Semitec104Gt2 => Thermistor::semitec_104gt2(),
        Kind::Semitec104Nt4 => Thermistor::through([(25.0, 100e3), (160.0, 1074.0), (300.0, 82.78)]),
        Kind::Generic3950 => Thermistor::through([(25.0, 100e3), (150.0, 1770.0), (250.0, 230.0)]),
        Kind::Slice450 => Thermistor::through([(25.0, 500e3), (200.0, 3734.0), (400.0, 240.0)]),
        Kind::Pt1000 => Thermistor::Platinum,
        Kind::Beta { ohms, beta } => Thermistor::Beta { ohm_at_25: ohms.into(), beta: beta.into() },
    }
}

/// The firmware's port to it: sensors where the machine's file has them.
pub(crate) struct HeatPort<'w> {
    pub heat: &'w Heat,
    pub settings: ThermalSettings,
}

impl ThermalPort for HeatPort<'_> {
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        let Some(plant) = &mut *self.heat.plant.borrow_mut() else {
            return matches!(sensor, Sensor::Bed | Sensor::Hotend0).then_some(ROOM);
        };
        let of = |heater| self.settings.heater(heater).sensor == sensor;
        if of(Heater::Hotend) {
            plant.sample(Sensor::Hotend0)
        } else if of(Heater::Bed) {
            plant.sample(Sensor::Bed)
        } else {
            Some(ROOM)
        }
    }

    fn reference(&mut self) -> Option<u16> {
        self.heat.plant.borrow_mut().as_mut()?.vref_sample()
    }

    fn outputs(&self) -> OutputSet {
        // Those of the Octopus.
        OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1)
    }

    fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        self.heat.duties.set(*duties);
    }

    fn fans(&self) -> usize {
        FANS
    }

    fn blow(&mut self, fan: usize, duty: u16) {
        let mut fans = self.heat.fans.get();
        if let Some(place) = fans.get_mut(fan) {
            *place = duty;
        }
        self.heat.fans.set(fans);
    }

    fn has_supply_switch(&self) -> bool {
        true
    }

    fn switch_supply(&mut self, on: bool) {
        self.heat.is_supplied.set(on);
    }
}
