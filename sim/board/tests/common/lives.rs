//! A life of a simulated machine: its parts, its use, and its answers.

use corehbot::connectors::Heater;
use corehbot::port::NoStorage;
use corehbot::settings::{Settings, ThermalSettings};
use corehbot::units::{Mm, TICKS_PER_SECOND, Watts};
use corehbot_rig::plant::{ChamberConstants, PlantConstants, PlantFaults};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::heat_plant::truth;
use corehbot_sim::world::{Desk, World};

use super::deaf::Deaf;

/// Numbers by a seed, the same on every platform (SplitMix64).
#[derive(Clone)]
pub struct Dice(u64);

impl Dice {
    pub const fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    pub const fn below(&mut self, most: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % most
    }

    pub fn within(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.below(1 << 20) as f64 / f64::from(1 << 20)
    }

    pub fn is_one_of(&mut self, many: u64) -> bool {
        self.below(many) == 0
    }

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u64) as usize]
    }
}

/// The true values of a heater.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    pub watt: f64,
    pub joule_per_kelvin: f64,
    pub watt_per_kelvin: f64,
    /// Lags in s: from the element to the heated part, and from there to the sensor.
    pub lags: [f64; 2],
}

/// A machine, and the settings that its owner gave the firmware.
#[derive(Clone, Debug)]
pub struct Machine {
    pub settings: Settings,
    pub plant: PlantConstants,
    pub hotend: Truth,
    pub bed: Truth,
    pub has_chamber: bool,
    /// Heat that the bed loses to the chamber, W/K.
    pub to_chamber: f64,
    pub room: f64,
    /// So far from the default model that its owner has to tune it before anything else.
    pub is_tuned_first: [bool; 2],
}

impl Machine {
    /// A machine of this seed: 25 to 100 W, blocks of 6 to 34 J/K, beds of 300 to 5500 J/K, noise of 0 to 3 LSB.
    pub fn of(seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let room = dice.within(5.0, 32.0);
        let is_usual = [dice.below(3) > 0, dice.below(3) > 0];
        let watt = dice.pick(&[25.0, 30.0, 40.0, 50.0, 60.0, 70.0, 100.0]);
        let usual = |dice: &mut Dice, value: f64| value * dice.within(0.7, 1.4);
        let hotend = if is_usual[0] {
            let (heat, loss) = (usual(&mut dice, 10.8), usual(&mut dice, 0.075));
            Truth {
                watt,
                joule_per_kelvin: heat,
                watt_per_kelvin: loss,
                lags: [usual(&mut dice, 1.2), usual(&mut dice, 1.2)],
            }
        } else {
            let (heat, loss) = (dice.within(6.0, 34.0), dice.within(0.05, 0.13));
            Truth {
                watt,
                joule_per_kelvin: heat,
                watt_per_kelvin: loss,
                lags: [dice.within(0.8, 4.0), dice.within(0.5, 5.0)],
            }
        };
        let bed = if is_usual[1] {
            let (watt, heat) = (dice.pick(&[400.0, 500.0, 600.0, 750.0]), usual(&mut dice, 1700.0));
            let loss = usual(&mut dice, 3.5);
            Truth {
                watt,
                joule_per_kelvin: heat,
                watt_per_kelvin: loss,
                lags: [usual(&mut dice, 10.0), usual(&mut dice, 5.0)],
            }
        } else {
            let heat: f64 = dice.pick(&[300.0, 600.0, 1000.0, 1700.0, 3000.0, 5500.0]);
            // From 25 to 60 C in 2 to 20 minutes or so.
            let watt = (heat * dice.within(0.04, 0.35)).clamp(120.0, 1500.0);
            Truth {
                watt,
                joule_per_kelvin: heat,
                watt_per_kelvin: watt / dice.within(90.0, 160.0),
                lags: [dice.within(3.0, 15.0), dice.within(2.0, 8.0)],
            }
        };
        let has_chamber = dice.is_one_of(4);
        let noise = dice.within(0.0, 3.0);
        let coupling = [dice.within(0.0, 0.05), dice.within(0.0, 2.0)];
        let mut settings = Settings::prototype();
        let thermal = &mut settings.thermal;
        (thermal.heaters.hotend.is_fitted, thermal.heaters.bed.is_fitted) = (true, true);
        thermal.heaters.chamber.is_fitted = has_chamber;
        thermal.heaters.hotend.power = Watts::from_num(hotend.watt);
        thermal.heaters.bed.power = Watts::from_num(bed.watt);
        thermal.heaters.bed.period_ms = dice.pick(&[0, 1000]);
        let to_chamber = if has_chamber { coupling[1] } else { 0.0 };
        let plant = plant(thermal, room, noise, seed, [hotend, bed], [coupling[0], to_chamber]);
        let is_tuned_first = [!is_usual[0], !is_usual[1]];
        Self { settings, plant, hotend, bed, has_chamber, to_chamber, room, is_tuned_first }
    }

    /// The hottest target that four fifths of the power hold, with some filament running.
    pub fn most(&self, heater: Heater) -> f64 {
        let (truth, most): (Truth, f64) = match heater {
            Heater::Hotend => (self.hotend, 275.0),
            Heater::Bed => (self.bed, 110.0),
            Heater::Chamber => return 55.0,
        };
        let filament = if heater == Heater::Hotend { 0.012 } else { 0.0 };
        let fan = if heater == Heater::Hotend { 0.05 } else { 0.0 };
        let chamber = if heater == Heater::Bed { self.to_chamber } else { 0.0 };
        most.min(self.room + 0.8 * truth.watt / (truth.watt_per_kelvin + filament + fan + chamber))
    }
}

fn plant(
    thermal: &ThermalSettings,
    room: f64,
    noise: f64,
    seed: u64,
    [hotend, bed]: [Truth; 2],
    [hotend_bed, bed_chamber]: [f64; 2],
) -> PlantConstants {
    let table = |name: &str, t: Truth| {
        let [heater_lag, sensor_lag] = t.lags;
        format!(
            "[{name}]\npower = {:.3}\ncapacity = {:.3}\nloss = {:.5}\nheater_lag = {heater_lag:.3}\nsensor_lag = {sensor_lag:.3}\n",
            t.watt, t.joule_per_kelvin, t.watt_per_kelvin
        )
    };
    let file = format!(
        "ambient = {room:.2}\nnoise = {noise:.2}\nseed = {seed}\n{}{}[coupling]\nhotend_bed = {hotend_bed:.4}\nbed_chamber = {:.3}\n",
        table("hotend", hotend),
        table("bed", bed),
        bed_chamber,
    );
    let mut without = corehbot_rig::thermal_plant::constants(thermal);
    without.chamber = thermal.heaters.chamber.is_fitted.then(ChamberConstants::usual);
    truth::read(&file, without).unwrap()
}

/// A machine in use.
pub struct Life<'w> {
    world: World<'w>,
    pub machine: &'w Machine,
    pub dice: Dice,
    heard: Vec<String>,
    partial: Vec<u8>,
    /// Answers that are missing.
    awaiting: u32,
    /// Temperatures of the last print: hotend and bed.
    pub last: Option<[f64; 2]>,
    /// The hottest of hotend, bed and chamber in truth, C.
    pub hottest: [f64; 3],
    /// Everything that was sent, with its time in s, for debugging.
    pub log: Vec<String>,
}

/// Lives one life at a desk.
pub fn live<T>(machine: &Machine, seed: u64, story: impl FnOnce(&mut Life<'_>) -> T) -> T {
    let drivers = Drivers::new();
    let mut desk = Desk::new(1);
    desk.heat.truth = Some(machine.plant.clone());
    let mut sink = Deaf;
    let start = Some([100, 100, 50].map(Mm::from_num));
    let world = World::new(&mut desk, &machine.settings, start, NoStorage, &drivers, &mut sink);
    let dice = Dice::new(seed ^ 0x5eed);
    let mut life = Life {
        world,
        machine,
        dice,
        heard: Vec::new(),
        partial: Vec::new(),
        awaiting: 0,
        last: None,
        hottest: [0.0; 3],
        log: Vec::new(),
    };
    life.pass(1.0);
    story(&mut life)
}

impl Life<'_> {
    /// Time since power-up, s.
    pub fn now(&self) -> f64 {
        self.world.now() as f64 / f64::from(TICKS_PER_SECOND)
    }

    /// Why the machine has stopped, if it has.
    pub fn fault(&self) -> Option<String> {
        self.world.status().fault().fault().map(|fault| fault.to_string())
    }

    /// Whether it has stopped, or refuses to heat one of its heaters.
    pub fn is_found(&self) -> bool {
        let heat = self.world.status().heat();
        self.world.status().fault().is_set() || Heater::ALL.iter().any(|heater| heat.ailment(*heater).is_some())
    }

    /// Changes the plant's faults.
    pub fn faults(&mut self, change: impl FnOnce(&mut PlantFaults)) {
        change(self.world.heat().plant().unwrap().faults());
    }

    /// A plate of this temperature is laid on the bed.
    pub fn lay_plate(&mut self, celsius: f64) {
        self.log.push(format!("{:.1}: plate of {celsius:.1} C", self.now()));
        self.world.heat().plant().unwrap().lay_plate(celsius, 0.25);
    }

    /// The true temperatures of hotend, bed and chamber, C.
    pub fn truth(&mut self) -> [f64; 3] {
        let plant = self.world.heat().plant().unwrap();
        [plant.hotend_celsius(), plant.bed_celsius(), plant.chamber_celsius()]
    }

    /// Whether any heater has power.
    pub fn is_powered(&mut self) -> bool {
        let heat = self.world.heat();
        Heater::ALL.into_iter().any(|heater| heat.duty(heater).is_some_and(|duty| duty > 0))
    }

    /// A control period or so passes; a machine at rest is checked once in one.
    fn turn(&mut self) {
        self.world.poll();
        self.partial.extend(self.world.wires()[0].heard());
        while let Some(end) = self.partial.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.partial.drain(..=end).collect();
            let line = String::from_utf8(line).unwrap().trim_end().to_owned();
            if line.starts_with("ok") {
                self.awaiting = self.awaiting.saturating_sub(1);
            }
            if !line.starts_with("echo:busy") && !line.starts_with(" T:") {
                self.heard.push(line);
            }
        }
        for _ in 0..20 {
            if self.world.advance() {
                break;
            }
        }
        let truth = self.truth();
        for (hottest, is) in self.hottest.iter_mut().zip(truth) {
            *hottest = hottest.max(is);
        }
    }

    /// Lets `seconds` pass.
    pub fn pass(&mut self, seconds: f64) {
        let end = self.now() + seconds;
        while self.now() < end && !self.world.status().fault().is_set() {
            self.turn();
        }
    }

    /// Time passes although the machine has stopped.
    pub fn pass_after(&mut self, seconds: f64) {
        let end = self.now() + seconds;
        while self.now() < end {
            self.turn();
        }
    }

    /// Sends a line without waiting for its answer.
    pub fn put(&mut self, line: &str) {
        self.log.push(format!("{:.1}: {line}", self.now()));
        self.world.wires()[0].put(format!("{line}\n").into_bytes());
        self.awaiting += 1;
    }

    /// Waits for all answers, `most` seconds at the most; returns whether they came.
    pub fn await_answers(&mut self, most: f64) -> bool {
        let end = self.now() + most;
        while self.awaiting > 0 && self.now() < end && !self.world.status().fault().is_set() {
            self.turn();
        }
        self.awaiting == 0
    }

    /// Sends a line and waits for its answer; returns the lines heard until then. A line without an answer for two
    /// hours is a failure.
    pub fn say(&mut self, line: &str) -> Vec<String> {
        self.heard.clear();
        self.put(line);
        if !self.await_answers(7200.0) && !self.world.status().fault().is_set() {
            panic!("no answer to {line} within two hours\n{}", self.story());
        }
        std::mem::take(&mut self.heard)
    }

    /// The last lines of its story.
    pub fn story(&self) -> String {
        let from = self.log.len().saturating_sub(25);
        format!("{:#?}\n{}", (self.machine.hotend, self.machine.bed, self.machine.room), self.log[from..].join("\n"))
    }
}
