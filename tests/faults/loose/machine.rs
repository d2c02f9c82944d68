//! A machine by its seed, on either plant: the simulator's, and the one of these tests.

use super::other::{Other, OtherPort};
use crate::faults::constants;
use crate::printer::{NoWake, PERIOD, Printer, settings};
use corehbot::connectors::Heater;
use corehbot::fault::Fault;
use corehbot::settings::{Control, ThermalSettings};
use corehbot::status::Status;
use corehbot::thermal::{Order, OrderQueue, Orders, ThermalControl};
use corehbot::units::{Celsius, JoulesPerKelvin, Seconds, Watts, WattsPerKelvin};
use corehbot_rig::plant::{Plant, SensorFault};
use std::cell::RefCell;
use std::rc::Rc;

/// Numbers by a seed (SplitMix64).
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

    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u64) as usize]
    }
}

/// The true values of a hotend.
#[derive(Clone, Copy, Debug)]
pub struct Spec {
    pub watt: f64,
    /// J/K.
    pub cartridge: f64,
    pub block: f64,
    pub nozzle: f64,
    /// W/K at 190 K above the room, and in addition with the part fan at full speed.
    pub loss: f64,
    pub fan_loss: f64,
    /// s.
    pub heater_lag: f64,
    pub sensor_lag: f64,
    /// C.
    pub room: f64,
    /// LSB of one conversion of 12 bits.
    pub noise: f64,
    /// The bed's heat capacity and losses, of those of its model.
    pub bed_mass: f64,
    pub bed_loss: f64,
    pub seed: u64,
}

/// What changes around a machine.
#[derive(Clone, Copy, Debug)]
pub struct Outside {
    pub room: f64,
    /// Of the nominal power.
    pub supply: f64,
    /// Of the losses to the air.
    pub draught: f64,
}

impl Outside {
    pub const USUAL: Self = Self { room: 25.0, supply: 1.0, draught: 1.0 };
}

/// What breaks in the hotend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Breaks {
    /// The sensor leaves its hole: in the end it shows a share of the rise above the room.
    SensorLeaves { share: f64, seconds: f64 },
    /// Resistance in series with the sensor, which grows.
    Series { ohm: f64, seconds: f64 },
    /// The cartridge slides out of the block: 0.05 W/K are left.
    CartridgeOut,
    /// The switch leaks this part of full power.
    Leak(f64),
    /// This part of the power is left.
    Power(f64),
    /// The same of the bed.
    BedPower(f64),
    /// The bed's sensor comes off: in the end it shows a share of the rise above the room.
    BedSensorLeaves { share: f64, seconds: f64 },
}

impl Spec {
    /// Hotends of 40 to 100 W, with blocks of 6 to 20 J/K.
    pub fn of(seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        Self {
            watt: dice.pick(&[40.0, 50.0, 60.0, 70.0, 100.0]),
            cartridge: dice.within(1.2, 2.2),
            block: dice.within(6.0, 20.0),
            nozzle: dice.within(1.5, 4.0),
            loss: dice.within(0.06, 0.11),
            fan_loss: dice.within(0.02, 0.07),
            heater_lag: dice.within(0.8, 1.6),
            sensor_lag: dice.within(0.8, 2.0),
            room: dice.within(12.0, 32.0),
            noise: dice.within(0.3, 3.0),
            bed_mass: dice.within(0.85, 1.2),
            bed_loss: dice.within(0.7, 1.3),
            seed,
        }
    }

    /// The settings of an owner whose model is off by up to so much, PID or model.
    pub fn settings(&self, off: f64) -> ThermalSettings {
        let mut dice = Dice::new(self.seed ^ 0xabcd);
        let mut settings = settings();
        let hotend = settings.heater_mut(Heater::Hotend);
        let mut about = |value: f64| value * dice.within(1.0 - off, 1.0 + off);
        let model = &mut hotend.model;
        model.capacity = JoulesPerKelvin::from_num(about(self.cartridge + self.block + self.nozzle));
        model.loss = WattsPerKelvin::from_num(about(self.loss));
        model.fan_loss = WattsPerKelvin::from_num(about(self.fan_loss));
        model.heater_lag = Seconds::from_num(about(self.heater_lag));
        model.sensor_lag = Seconds::from_num(about(self.sensor_lag));
        hotend.power = Watts::from_num(self.watt);
        if self.seed % 3 == 2 {
            hotend.control = Control::Pid;
            // Gains for 10.8 J/K and 40 W, and as many for any other.
            let share = (self.cartridge + self.block + self.nozzle) / 10.8 * 40.0 / self.watt;
            let scaled = |gain: corehbot::units::Ratio| corehbot::units::Ratio::from_num(gain.to_num::<f64>() * share);
            hotend.pid.p = scaled(hotend.pid.p);
            hotend.pid.i = scaled(hotend.pid.i);
            hotend.pid.d = scaled(hotend.pid.d);
        }
        settings
    }
}

/// A machine on one of the plants.
pub trait Machine {
    /// It has just been switched on, cold.
    fn new(spec: &Spec, settings: ThermalSettings) -> Self;
    fn order(&mut self, order: Order);
    /// A control period with this flow in mm3/s, by s from now.
    fn period(&mut self, flow: impl Fn(f64) -> f64);
    fn outside(&mut self, outside: Outside);
    fn break_it(&mut self, breaks: Breaks);
    fn fault(&self) -> Option<Fault>;
    fn status(&self) -> &'static Status;
    /// The true temperatures of block and cartridge, C.
    fn block(&self) -> f64;
    fn hottest(&self) -> f64;
    fn is_supplied(&self) -> bool;

    fn set(&mut self, heater: Heater, celsius: f64) {
        self.order(Order::Target(heater, Celsius::from_num(celsius)));
    }

    /// Stores and tells what heaters have learned of themselves, as the Console does.
    fn learn(&mut self) {
        for heater in [Heater::Hotend, Heater::Bed] {
            let figures = self.status().heat().figures(heater);
            if figures.has_learned() {
                self.order(Order::Baseline(heater, figures.learned));
            }
        }
    }

    fn reading(&self) -> f64 {
        self.status().heat().measured(Heater::Hotend).map_or(f64::NAN, |celsius| celsius.to_num())
    }

    /// Runs for `seconds`; ends with a fault.
    fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / PERIOD) as u64 {
            if self.fault().is_some() {
                break;
            }
            self.period(|_| 0.0);
        }
    }
}

/// On the simulator's plant.
pub struct Simulated(Printer);

impl Machine for Simulated {
    fn new(spec: &Spec, settings: ThermalSettings) -> Self {
        let mut plant = constants();
        let h = &mut plant.hotend;
        h.heater.nominal_watt = spec.watt;
        (h.cartridge_joule_per_kelvin, h.block_joule_per_kelvin) = (spec.cartridge, spec.block + spec.nozzle);
        h.cartridge_to_block_watt_per_kelvin = spec.cartridge / spec.heater_lag;
        // At 190 K: the throat, the air, and its growth with the temperature.
        h.block_to_sink_watt_per_kelvin = 0.25 * spec.loss;
        h.block_to_air_watt_per_kelvin = 0.6 * spec.loss;
        h.block_to_air_rise_watt_per_kelvin_sq = 0.15 * spec.loss / 190.0;
        h.part_fan_watt_per_kelvin = spec.fan_loss;
        h.sensor.lag_seconds = spec.sensor_lag;
        plant.bed.plate_joule_per_kelvin *= spec.bed_mass;
        plant.bed.plate_to_air_watt_per_kelvin *= spec.bed_loss;
        (plant.ambient_celsius, plant.converter.noise_lsb, plant.converter.seed) = (spec.room, spec.noise, spec.seed);
        Self(Printer::with(Plant::new(&plant), settings))
    }

    fn order(&mut self, order: Order) {
        self.0.order(order);
    }

    fn period(&mut self, flow: impl Fn(f64) -> f64) {
        self.0.period_with(flow);
    }

    fn outside(&mut self, outside: Outside) {
        let mut bench = self.0.bench.borrow_mut();
        let faults = bench.plant.faults();
        (faults.ambient_celsius, faults.draught) = (outside.room, outside.draught);
        faults.supply_volts = 24.0 * outside.supply.sqrt();
    }

    fn break_it(&mut self, breaks: Breaks) {
        let mut bench = self.0.bench.borrow_mut();
        let faults = bench.plant.faults();
        match breaks {
            Breaks::SensorLeaves { share, seconds } => faults.hotend_sensor = SensorFault::Leaves { share, seconds },
            Breaks::Series { ohm, seconds } => faults.hotend_sensor = SensorFault::Series { ohm, seconds },
            Breaks::CartridgeOut => faults.hotend_heater.contact = 0.05 / 1.5,
            Breaks::Leak(part) => faults.hotend_heater.leaks = part,
            Breaks::Power(part) => faults.hotend_heater.power = part,
            Breaks::BedPower(part) => faults.bed_heater.power = part,
            Breaks::BedSensorLeaves { share, seconds } => faults.bed_sensor = SensorFault::Leaves { share, seconds },
        }
    }

    fn fault(&self) -> Option<Fault> {
        self.0.fault()
    }

    fn status(&self) -> &'static Status {
        self.0.status
    }

    fn block(&self) -> f64 {
        self.0.hotend()
    }

    fn hottest(&self) -> f64 {
        self.0.bench.borrow().plant.hottest_celsius()
    }

    fn is_supplied(&self) -> bool {
        self.0.bench.borrow().supply
    }
}

/// On the plant of these tests.
pub struct Apart {
    plant: Rc<RefCell<Other>>,
    control: ThermalControl<'static, OtherPort, NoWake>,
    orders: Orders<'static>,
    status: &'static Status,
    extruded: f64,
    per_mm3: f64,
    lag: f64,
}

impl Machine for Apart {
    fn new(spec: &Spec, settings: ThermalSettings) -> Self {
        let plant = Rc::new(RefCell::new(Other::new(spec)));
        let queue: &'static mut OrderQueue = Box::leak(Box::new(OrderQueue::new()));
        let (orders, orders_in) = queue.split();
        let status: &'static Status = Box::leak(Box::new(Status::new()));
        let control = ThermalControl::new(&settings, orders_in, status, OtherPort(plant.clone()), NoWake);
        let per_mm3 = settings.filament.to_num::<f64>() / 2.405;
        let lag = settings.heater(Heater::Hotend).model.heater_lag.to_num();
        Self { plant, control, orders, status, extruded: 0.0, per_mm3, lag }
    }

    fn order(&mut self, order: Order) {
        self.orders.enqueue(order).unwrap();
    }

    fn period(&mut self, flow: impl Fn(f64) -> f64) {
        let bits = |value: f64| (value * f64::from(1 << 24)) as u32;
        self.extruded += flow(0.0) * PERIOD / 2.405;
        let heat = self.status.heat();
        heat.set_extruded_um(((self.extruded * 1000.0) as i64) as u32);
        let coming = (flow(0.25 * self.lag) + flow(0.75 * self.lag)) / 2.0 * self.lag;
        heat.set_filament_ahead([bits(coming * self.per_mm3), bits(flow(self.lag) * self.per_mm3)]);
        heat.beat_of_console();
        heat.beat_of_generator();
        self.status.count_look();
        self.control.period();
        self.plant.borrow_mut().step(flow(0.0), PERIOD);
    }

    fn outside(&mut self, outside: Outside) {
        self.plant.borrow_mut().outside = outside;
    }

    fn break_it(&mut self, breaks: Breaks) {
        self.plant.borrow_mut().break_it(breaks);
    }

    fn fault(&self) -> Option<Fault> {
        self.status.fault().fault()
    }

    fn status(&self) -> &'static Status {
        self.status
    }

    fn block(&self) -> f64 {
        self.plant.borrow().hotend[1]
    }

    fn hottest(&self) -> f64 {
        self.plant.borrow().hotend[0]
    }

    fn is_supplied(&self) -> bool {
        self.plant.borrow().is_supplied
    }
}
