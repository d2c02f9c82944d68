//! A printer: the firmware's thermal control on the plant, through its port alone.

use corehbot::connectors::{FANS, Heater, OUTPUTS, Output, OutputSet, Sensor};
use corehbot::fault::Fault;
use corehbot::port::{ThermalPort, Wake};
use corehbot::settings::{ThermalSettings, Thermistor, part_fans};
use corehbot::status::Status;
use corehbot::thermal::{Order, OrderQueue, Orders, PERIOD_MS, ThermalControl};
use corehbot::units::Celsius;
use corehbot_rig::plant::{self, Drive, Plant, PlantConstants};
use std::cell::RefCell;
use std::rc::Rc;

/// A control period, s.
pub const PERIOD: f64 = PERIOD_MS as f64 / 1000.0;

/// Cross-section of filament of 1.75 mm, mm2.
const FILAMENT: f64 = 2.405;

/// The state shared by the port and the test.
pub struct Bench {
    pub plant: Plant,
    /// The outputs in the last period, of 1.
    pub duties: [f64; OUTPUTS],
    pub fans: [f64; FANS],
    pub supply: bool,
    /// How often the watchdog was fed.
    pub fed: u32,
    /// Pulses of the hotend fan's tachometer, if it has one, and whether the fan is stuck.
    pub tachometer: Option<u16>,
    pub is_stuck: bool,
}

/// The firmware's port to it.
pub struct BenchPort(Rc<RefCell<Bench>>);

impl ThermalPort for BenchPort {
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        let mut bench = self.0.borrow_mut();
        match sensor {
            // A second sensor in the bed's mat.
            Sensor::Hotend2 => Some(bench.plant.second_sample(Heater::Bed, &plant::Thermistor::NTC_100K_B3950)),
            _ => bench.plant.sample(sensor),
        }
    }

    fn reference(&mut self) -> Option<u16> {
        self.0.borrow_mut().plant.vref_sample()
    }

    fn outputs(&self) -> OutputSet {
        OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1)
    }

    fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        self.0.borrow_mut().duties = duties.map(|duty| f64::from(duty) / 65_535.0);
    }

    fn fans(&self) -> usize {
        FANS
    }

    fn set_fan(&mut self, fan: usize, duty: u16) {
        self.0.borrow_mut().fans[fan] = f64::from(duty) / 65_535.0;
    }

    fn tachometer(&self, fan: usize) -> Option<u16> {
        self.0.borrow().tachometer.filter(|_| fan == 1)
    }

    fn has_supply_switch(&self) -> bool {
        true
    }

    fn switch_supply(&mut self, on: bool) {
        self.0.borrow_mut().supply = on;
    }

    fn feed_watchdog(&mut self) {
        self.0.borrow_mut().fed += 1;
    }
}

/// A `Wake` without effect.
#[derive(Clone, Copy)]
pub struct NoWake;

impl Wake for NoWake {
    fn wake_generator(&self) {}
    fn wake_stepper(&self) {}
}

/// A printer without motors.
pub struct Printer {
    pub bench: Rc<RefCell<Bench>>,
    pub status: &'static Status,
    pub orders: Orders<'static>,
    control: ThermalControl<'static, BenchPort, NoWake>,
    settings: ThermalSettings,
    extruded: f64,
    /// Contexts that no longer come by: Console, StepGenerator, Stepper.
    pub silent: [bool; 3],
    pub seconds: f64,
}

/// The settings of the plant's prototype, with hotend and bed fitted.
pub fn settings() -> ThermalSettings {
    let mut settings = ThermalSettings::prototype();
    settings.heater_mut(Heater::Hotend).is_fitted = true;
    let bed = settings.heater_mut(Heater::Bed);
    (bed.is_fitted, bed.thermistor) = (true, Thermistor::Beta { ohms: 100_000, beta: 3950, cubic: 0 });
    settings
}

impl Printer {
    /// A printer that has just been switched on, with everything at the room's temperature.
    pub fn new(constants: &PlantConstants, settings: ThermalSettings) -> Self {
        Self::with(Plant::new(constants), settings)
    }

    /// A printer that has just been switched on, as it is.
    pub fn with(plant: Plant, settings: ThermalSettings) -> Self {
        let bench = Bench {
            plant,
            duties: [0.0; OUTPUTS],
            fans: [0.0; FANS],
            supply: true,
            fed: 0,
            tachometer: None,
            is_stuck: false,
        };
        Self::at(Rc::new(RefCell::new(bench)), settings)
    }

    /// The firmware after a reset, on the same plant.
    pub fn restarted(self) -> Self {
        Self::at(self.bench, self.settings)
    }

    fn at(bench: Rc<RefCell<Bench>>, settings: ThermalSettings) -> Self {
        let queue: &'static mut OrderQueue = Box::leak(Box::new(OrderQueue::new()));
        let (orders, orders_in) = queue.split();
        let status: &'static Status = Box::leak(Box::new(Status::new()));
        let control = ThermalControl::new(&settings, orders_in, status, BenchPort(bench.clone()), NoWake);
        Self { bench, status, orders, control, settings, extruded: 0.0, silent: [false; 3], seconds: 0.0 }
    }

    /// Sends an order.
    pub fn order(&mut self, order: Order) {
        self.orders.enqueue(order).unwrap();
    }

    /// M104, M140.
    pub fn set(&mut self, heater: Heater, celsius: f64) {
        self.order(Order::Target(heater, Celsius::from_num(celsius)));
    }

    /// A control period with this flow of filament, and the flow that is known to come, by s from now.
    pub fn period_with(&mut self, flow: impl Fn(f64) -> f64) {
        let lag = self.settings.heater(Heater::Hotend).model.heater_lag.to_num::<f64>();
        let per_mm3 = self.settings.filament.to_num::<f64>() / FILAMENT;
        let steps = 24;
        let coming: f64 =
            (0..steps).map(|n| flow(lag * (f64::from(n) + 0.5) / f64::from(steps)) * lag / f64::from(steps)).sum();
        let bits = |value: f64| (value * f64::from(1 << 24)) as u32;
        self.extruded += flow(0.0) * PERIOD / FILAMENT;
        let heat = self.status.heat();
        heat.set_extruded_um(((self.extruded * 1000.0) as i64) as u32);
        heat.set_filament_ahead([bits(coming * per_mm3), bits(flow(lag) * per_mm3)]);
        if !self.silent[0] {
            heat.beat_of_console();
        }
        if !self.silent[1] {
            heat.beat_of_generator();
        }
        if !self.silent[2] {
            self.status.count_look();
        }
        self.control.period();
        let mut bench = self.bench.borrow_mut();
        let parts = part_fans(self.settings.fans.map(|fan| fan.role)).into_iter();
        let drive = Drive {
            hotend: bench.duties[Output::He0 as usize],
            bed: bench.duties[Output::Bed as usize],
            chamber: bench.duties[Output::He1 as usize],
            part_fan: parts.zip(bench.fans).map(|(is_part, duty)| if is_part { duty } else { 0.0 }).fold(0.0, f64::max),
            hotend_fan: bench.fans[1],
            flow_mm3_s: flow(0.0),
            supply_on: bench.supply,
        };
        // 3000 turns a minute, two pulses each: two in a control period.
        if bench.fans[1] > 0.5 && !bench.is_stuck {
            bench.tachometer = bench.tachometer.map(|pulses| pulses.wrapping_add(2));
        }
        bench.plant.step(&drive, PERIOD);
        self.seconds += PERIOD;
    }

    /// A control period without filament.
    pub fn period(&mut self) {
        self.period_with(|_| 0.0);
    }

    /// Runs for `seconds` without filament.
    pub fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / PERIOD).round() as u64 {
            self.period();
        }
    }

    /// Runs until `done`, for `most` seconds at the most; returns the time.
    pub fn run_until(&mut self, most: f64, done: impl Fn(&Self) -> bool) -> Option<f64> {
        let begun = self.seconds;
        while self.seconds - begun < most {
            self.period();
            if done(self) {
                return Some(self.seconds - begun);
            }
        }
        None
    }

    /// The first fault.
    pub fn fault(&self) -> Option<Fault> {
        self.status.fault().fault()
    }

    /// A heater's output, of 1.
    pub fn duty(&self, output: Output) -> f64 {
        self.bench.borrow().duties[output as usize]
    }

    /// The block's true temperature, C.
    pub fn hotend(&self) -> f64 {
        self.bench.borrow().plant.hotend_celsius()
    }

    /// The plate's.
    pub fn bed(&self) -> f64 {
        self.bench.borrow().plant.bed_celsius()
    }

    /// The firmware's temperature of a heater.
    pub fn measured(&self, heater: Heater) -> f64 {
        self.status.heat().measured(heater).map_or(f64::NAN, |celsius| celsius.to_num())
    }
}
