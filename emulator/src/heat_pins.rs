//! Heat: the thermal plant of the rig on the board's pins, in virtual time.
//!
//! Heaters and fans get the levels of their pins, summed up to the nanosecond, while PS_ON is driven low. The plant's
//! sensors are the converter's inputs: each conversion by the firmware's converter is a conversion of the plant, with
//! noise of its own. A machine without heaters costs nothing here.

use crate::board::Emulated;
use crate::wiring::{Pin, Wiring};
use corehbot::connectors::{FANS, Heater, OUTPUTS, Output, OutputSet};
use corehbot::port::ThermalPort;
use corehbot::settings::Settings;
use corehbot_rig::plant::PlantFaults;
use corehbot_rig::thermal_plant::Heat;
use corehbot_sim::accident::Accident;
use corehbot_sim::heat_plant::HeatSetup;
use corehbot_sim::user_actions::WARM;
use rigless::time::VirtualNanos;
use std::collections::VecDeque;

/// The plant advances in steps of 1 ms, a fifth of its own longest part.
const STEP_NS: u64 = 1_000_000;

/// Steps between two samples that are kept: 20 ms.
const SAMPLED: u32 = 20;

/// Duties and speeds are of 65,535 (`ThermalPort`).
const FULL: f64 = 65_535.0;

/// The thermal surroundings of the machine.
#[derive(Clone, Copy, Default, Debug)]
pub struct Climate {
    /// Hotend and bed have long been so hot at the start, in C; otherwise they have the room's temperature.
    pub start: Option<[f64; 2]>,
    /// Something of it breaks.
    pub mishap: Option<Mishap>,
    /// A fan, and the pin that its tachometer is on.
    pub tachometer: Option<(usize, Pin)>,
}

/// Something of the plant that breaks.
#[derive(Clone, Copy, Debug)]
pub struct Mishap {
    /// Virtual time before it, in ns.
    pub after: u64,
    /// The fault to inject.
    pub what: fn(&mut PlantFaults),
}

/// The level of a heater's pin changes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Edge {
    /// When, in ns.
    pub at: u64,
    /// The output of this pin.
    pub output: Output,
    /// Its new level.
    pub is_high: bool,
}

/// The state at an instant.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sample {
    /// When, in ns.
    pub at: u64,
    /// True temperatures of block and plate in C.
    pub celsius: [f64; 2],
    /// The part of the last ms that each fan's pin was on.
    pub fans: [f64; FANS],
}

/// The time that a pin is on.
#[derive(Clone, Copy, Default)]
struct Meter {
    level: f64,
    since: u64,
    sum: f64,
}

impl Meter {
    /// Sets the pin's level from `at` on; returns whether it changed.
    fn set(&mut self, at: u64, level: f64) -> bool {
        self.sum += self.level * (at - self.since) as f64;
        let has_changed = self.level != level;
        (self.level, self.since) = (level, at);
        has_changed
    }

    /// The share of the time since `begin` that it was on; restarts the count.
    fn take(&mut self, begin: u64, at: u64) -> f64 {
        self.set(at, self.level);
        std::mem::take(&mut self.sum) / (at - begin) as f64
    }
}

/// The machine's heat, and the record of it.
pub struct HeatWatch {
    wiring: &'static Wiring,
    heat: Heat,
    is_heated: bool,
    mishap: Option<Mishap>,
    /// Accidents to come, by time.
    accidents: VecDeque<Accident>,
    tachometer: Option<(usize, Pin)>,
    heaters: [Meter; OUTPUTS],
    fans: [Meter; FANS],
    /// How often the level of each fan's pin changed.
    pub fan_edges: [u32; FANS],
    /// When the step of the plant that is under way began, in ns, and its number.
    begun: u64,
    steps: u32,
    /// When something broke, in ns.
    pub broken: Option<u64>,
    /// Levels of the heaters' pins.
    pub edges: Vec<Edge>,
    /// When the power supply was switched on or off, in ns.
    pub supply: Vec<(u64, bool)>,
    /// Temperatures and fans, every 20 ms.
    pub samples: Vec<Sample>,
}

/// The outputs that a machine has heaters on.
#[must_use]
pub fn fitted(settings: &Settings) -> OutputSet {
    let heaters = settings.thermal.heaters.all().into_iter().filter(|heater| heater.is_fitted);
    heaters.fold(OutputSet::NONE, |set, heater| set.with(heater.output))
}

impl HeatWatch {
    /// The heat of a machine of `settings`; the supply starts off if the board can switch it.
    #[must_use]
    pub fn new(wiring: &'static Wiring, settings: &Settings, climate: &Climate, setup: &HeatSetup) -> Self {
        let mut heat = match (climate.start, &setup.truth) {
            (Some([hotend, bed]), _) => Heat::hot(settings, hotend, bed),
            (None, Some(truth)) => Heat::with(settings, truth),
            (None, None) => Heat::new(settings),
        };
        heat.switch_supply(wiring.supply(settings).is_none());
        Self {
            wiring,
            heat,
            is_heated: settings.thermal.has_heater(),
            mishap: climate.mishap,
            accidents: setup.accidents.iter().cloned().collect(),
            tachometer: climate.tachometer,
            heaters: [Meter::default(); OUTPUTS],
            fans: [Meter::default(); FANS],
            fan_edges: [0; FANS],
            begun: 0,
            steps: 0,
            broken: None,
            edges: Vec::new(),
            supply: Vec::new(),
            samples: Vec::new(),
        }
    }

    /// Whether the pin of an output is high.
    #[must_use]
    pub fn is_high(&self, output: Output) -> bool {
        self.heaters[output as usize].level > 0.0
    }

    /// Checks the pins, at every access or timer event that may have changed them; the extruder has made `extruded`
    /// steps.
    pub fn look(&mut self, board: &mut Emulated, at: u64, extruded: i32) {
        if !self.is_heated {
            return;
        }
        for &(output, load) in self.wiring.heaters {
            let is_high = board.drives(load);
            if self.heaters[output as usize].set(at, f64::from(is_high)) {
                self.edges.push(Edge { at, output, is_high });
            }
        }
        for ((meter, edges), load) in
            self.fans.iter_mut().zip(&mut self.fan_edges).zip(self.wiring.fans.iter().copied())
        {
            *edges += u32::from(meter.set(at, f64::from(board.drives(load))));
        }
        if at >= self.begun + STEP_NS {
            self.step(board, at, extruded);
        }
        for &(sensor, channel) in self.wiring.thermistors {
            if let Some(reading) = self.heat.convert(sensor) {
                board.show(channel, reading.into());
            }
        }
    }

    /// The power supply's switch may have changed.
    pub fn switch(&mut self, at: u64, is_on: bool) {
        if self.supply.last().is_some_and(|(_, was_on)| *was_on) != is_on {
            self.supply.push((at, is_on));
            self.heat.switch_supply(is_on);
        }
    }

    /// Time passes for the plant, up to `at`.
    fn step(&mut self, board: &mut Emulated, at: u64, extruded: i32) {
        let begin = std::mem::replace(&mut self.begun, at);
        let duties = self.heaters.each_mut().map(|meter| (meter.take(begin, at) * FULL).round() as u16);
        self.heat.heat(&duties);
        let fans = self.fans.each_mut().map(|meter| meter.take(begin, at));
        for (fan, share) in fans.iter().enumerate() {
            self.heat.set_fan(fan, (share * FULL).round() as u16);
        }
        self.heat.advance(extruded, (at - begin) as f64 / 1e9);
        if let Some((fan, pin)) = self.tachometer {
            board.drive(VirtualNanos(at), pin, self.heat.is_tachometer_high(fan));
        }
        let Some(plant) = self.heat.plant() else { return };
        let mishap = self.mishap.take_if(|mishap| at >= mishap.after);
        let accident = self.accidents.pop_front_if(|accident| at as f64 / 1e9 >= accident.at_s);
        if mishap.is_some() || accident.is_some() {
            if let Some(mishap) = mishap {
                (mishap.what)(plant.faults());
            }
            if let Some(accident) = accident {
                accident.happen(plant.faults());
            }
            board.set_analog_supply((plant.faults().vdda_volts * 1000.0).round() as u32);
            self.broken = Some(at);
        }
        self.steps += 1;
        if self.steps.is_multiple_of(SAMPLED) {
            self.samples.push(Sample { at, celsius: [plant.hotend_celsius(), plant.bed_celsius()], fans });
        }
    }

    /// A hand holds a heater's sensor.
    pub fn hold(&mut self, heater: Heater) {
        if let Some(plant) = self.heat.plant() {
            plant.hold(heater, WARM);
        }
    }

    /// When the last pin of a heater went low; `None` while one is high.
    #[must_use]
    pub fn off_since(&self) -> Option<u64> {
        let are_low = self.heaters.iter().all(|meter| meter.level == 0.0);
        are_low.then(|| self.edges.last().map_or(0, |edge| edge.at))
    }

    /// Whether the pin of a heater has just gone high: most of its pulse is still to come.
    #[must_use]
    pub fn has_just_gone_on(&self, at: u64) -> bool {
        self.edges.last().is_some_and(|edge| edge.is_high && at - edge.at < STEP_NS)
    }

    /// Whether the pin of a heater went low a ms ago: a control period has begun, and its interrupt is over.
    #[must_use]
    pub fn has_gone_off(&self, at: u64) -> bool {
        self.edges.last().is_some_and(|edge| !edge.is_high && (STEP_NS..3 * STEP_NS).contains(&(at - edge.at)))
    }

    /// True temperatures of block and plate at a time, in C.
    #[must_use]
    pub fn celsius_at(&self, at: u64) -> Option<[f64; 2]> {
        self.samples.iter().rev().find(|sample| sample.at <= at).map(|sample| sample.celsius)
    }
}

impl std::fmt::Debug for HeatWatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("HeatWatch").field("supply", &self.supply).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_meter_sums_up_what_a_pin_is_on() {
        let mut meter = Meter::default();
        assert!(meter.set(100, 1.0));
        assert!(!meter.set(300, 1.0));
        assert!(meter.set(400, 0.0));
        assert_eq!(meter.take(0, 1000), 0.3);
        assert!(meter.set(1500, 0.5));
        assert_eq!(meter.take(1000, 2000), 0.25);
    }
}
