//! Properties of heaters whatever a host says and whatever breaks: one body for the fuzzer and for the property tests.

use corehbot::connectors::Heater;
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::status::SelfTest;
use corehbot::thermal::PERIOD_MS;
use corehbot::units::{Celsius, Mm, TICKS_PER_MS};
use corehbot_rig::plant::{HeaterFault, PlantFaults, SensorFault};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, HeatPeriod, Sink, World};
use std::cell::Cell;

/// Time passes: this many ms for each unit of the next byte.
const PAUSE: u8 = 0xFD;
const PAUSE_MS: u64 = 16;

/// Breaks or mends a part, named by the next byte.
const BREAK: u8 = 0xFC;

/// Simulated time in all, in ms.
const MOST_MS: u64 = 60_000;

/// A heater is off this long after its sensor has failed: 0.4 s, and the length of the period.
const OFF_MS: u64 = 500;

/// The heaters' power in the last period.
struct Last<'c>(&'c Cell<Option<HeatPeriod>>);

impl Sink for Last<'_> {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}

    fn heat(&mut self, period: &HeatPeriod) {
        self.0.set(Some(*period));
    }
}

/// Breaks a part by a byte. Switches that stick are left out: no duty is to blame for them.
fn break_by(byte: u8, faults: &mut PlantFaults) {
    const SENSOR: [SensorFault; 4] =
        [SensorFault::None, SensorFault::Open, SensorFault::ShortToGround, SensorFault::Frozen];
    const HEATER: [HeaterFault; 2] = [HeaterFault::NONE, HeaterFault::OPEN];
    match byte % 16 {
        0..=3 => faults.hotend_sensor = SENSOR[usize::from(byte % 4)],
        4..=7 => faults.bed_sensor = SENSOR[usize::from(byte % 4)],
        8 | 9 => faults.hotend_heater = HEATER[usize::from(byte % 2)],
        10 | 11 => faults.bed_heater = HEATER[usize::from(byte % 2)],
        12 => faults.converter_stopped = true,
        13 => faults.swapped_sensors = !faults.swapped_sensors,
        14 => faults.supply_volts = 12.0,
        _ => faults.ambient_celsius = 15.0,
    }
}

/// The world, and the properties checked on it.
struct Watched<'w> {
    world: World<'w>,
    last: &'w Cell<Option<HeatPeriod>>,
    limits: [Celsius; 3],
    /// When it halted or a guard found something, in ms.
    stopped: Option<u64>,
    /// Whether any heater had power in the last period, and whether a self-test went on.
    is_powered: bool,
    is_testing: bool,
}

impl Watched<'_> {
    fn ms(&self) -> u64 {
        self.world.now() / u64::from(TICKS_PER_MS)
    }

    fn run(&mut self, ms: u64) {
        let end = self.ms() + ms;
        while self.ms() < end && !self.world.has_ended() {
            self.world.poll();
            drop(self.world.wires()[0].heard());
            self.world.advance();
            self.look();
        }
    }

    fn look(&mut self) {
        let (now, status) = (self.ms(), self.world.status());
        let is_stopped = status.is_halted() || status.fault().is_set();
        assert!(is_stopped || self.stopped.is_none(), "the stop is forgotten");
        self.stopped = self.stopped.or(is_stopped.then_some(now));
        let is_testing = status.heat().self_test() == SelfTest::Testing;
        let Some(period) = self.last.take() else { return };
        let was_testing = std::mem::replace(&mut self.is_testing, is_testing);
        self.is_powered = period.heaters.iter().flatten().any(|heater| heater.duty > 0);
        for (heater, limit) in period.heaters.iter().zip(self.limits) {
            let Some(heater) = heater else { continue };
            assert!(heater.target <= limit && heater.target >= Celsius::ZERO, "{} is a target", heater.target);
            let may_heat = heater.target > Celsius::ZERO || is_testing || was_testing;
            assert!(heater.duty == 0 || may_heat, "{} without a target", heater.duty);
        }
        // It may stop between two periods.
        let is_off = self.stopped.is_some_and(|stopped| now >= stopped + 2 * u64::from(PERIOD_MS));
        assert!(!is_off || !self.is_powered, "power after a stop");
    }
}

/// Bytes from a host, pauses and breakages out of `data`, on a machine with a hotend and a bed. In the end every sensor
/// breaks, and whatever came before, all is off within half a second.
pub fn heat_gcode(data: &[u8]) {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    let limits = Heater::ALL.map(|heater| settings.thermal.heater(heater).most);
    let (drivers, last) = (Drivers::new(), Cell::new(None));
    let (mut desk, mut sink) = (Desk::new(1), Last(&last));
    let start = Some([100, 100, 50].map(Mm::from_num));
    let world = World::new(&mut desk, &settings, start, NoStorage, &drivers, &mut sink);
    let mut watched = Watched { world, last: &last, limits, stopped: None, is_powered: false, is_testing: false };
    watched.run(100);
    let mut bytes = data.iter().copied();
    while let Some(byte) = bytes.next().filter(|_| watched.ms() < MOST_MS) {
        match byte {
            PAUSE => watched.run(u64::from(bytes.next().unwrap_or(1)) * PAUSE_MS),
            BREAK => {
                let what = bytes.next().unwrap_or(0);
                if let Some(plant) = watched.world.heat().plant() {
                    break_by(what, plant.faults());
                }
            }
            _ => {
                watched.world.wires()[0].put([byte]);
                if byte == b'\n' {
                    watched.run(20);
                }
            }
        }
    }
    watched.world.wires()[0].put([b'\n']);
    if let Some(plant) = watched.world.heat().plant() {
        (plant.faults().hotend_sensor, plant.faults().bed_sensor) = (SensorFault::Open, SensorFault::ShortToGround);
    }
    watched.run(OFF_MS);
    // M999 restarts, with all off.
    assert!(watched.world.has_ended() || !watched.is_powered, "a heater has power without a sensor");
}
