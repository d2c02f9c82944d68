//! Runs: a controller heats the hotend of a plant, and the figures say how well.
//!
//! A controller is called every 20 ms with the reading of the converter in C. A controller that measures less often
//! counts the time by itself.

use corehbot::port::Sensor;
use corehbot_rig::plant::{Drive, Plant, PlantConstants, Thermistor};

/// How often a controller is asked, s.
const PERIOD: f64 = 0.02;
/// Duration of a heat-up run, s.
const WATCHED: f64 = 300.0;
/// Within this of the target a temperature has settled, K.
const BAND: f64 = 0.5;
/// The target of `flow_step`, C.
pub const PRINTING: f64 = 215.0;

/// Turns measured degrees into power. It keeps its own target.
pub trait Controller {
    /// The duty, 0..=1, after `seconds` more.
    fn duty(&mut self, measured_celsius: f64, seconds: f64) -> f64;

    /// The filament's flow in the coming period, for controllers that care.
    fn flow(&mut self, _mm3_s: f64) {}
}

/// How a temperature came to its target.
#[derive(Clone, Copy, Debug)]
pub struct Approach {
    /// The most that it was above the target, K.
    pub overshoot: f64,
    /// When it first was within 0.5 C of the target, s.
    pub reached: Option<f64>,
    /// The time after which it stayed within 0.5 C of the target, s; `None` if it left that to the end.
    pub settled: Option<f64>,
}

/// A heat-up, as the block felt it and as the sensor saw it.
#[derive(Clone, Copy, Debug)]
pub struct HeatUp {
    pub block: Approach,
    pub sensor: Approach,
}

/// The effect of a filament flow on the block, in K from the target.
#[derive(Clone, Copy, Debug)]
pub struct FlowStep {
    /// The largest drop while there is flow.
    pub dip: f64,
    /// The largest rise after the flow has ended.
    pub rise: f64,
}

/// The hotend of a plant under a controller.
pub struct Loop<'c, C: Controller> {
    pub controller: &'c mut C,
    plant: Plant,
    thermistor: Thermistor,
    pull_up_ohm: f64,
    pub measured: f64,
}

impl<'c, C: Controller> Loop<'c, C> {
    pub fn new(controller: &'c mut C, constants: &PlantConstants, from: f64) -> Self {
        let plant = Plant::hot(constants, from, constants.ambient_celsius);
        let thermistor = constants.hotend.sensor.thermistor;
        Self { controller, plant, thermistor, pull_up_ohm: constants.converter.pull_up_ohm, measured: from }
    }

    /// A period: measure, decide, heat.
    pub fn step(&mut self, flow_mm3_s: f64) {
        let reading = f64::from(self.plant.sample(Sensor::Hotend0).unwrap());
        let ohm = self.pull_up_ohm * reading / (65_536.0 - reading);
        self.measured = celsius(self.thermistor, ohm);
        self.controller.flow(flow_mm3_s);
        let hotend = self.controller.duty(self.measured, PERIOD);
        self.plant.step(&Drive { hotend, flow_mm3_s, ..Drive::IDLE }, PERIOD);
    }
}

/// The temperature at which a thermistor has this resistance, C.
fn celsius(thermistor: Thermistor, ohm: f64) -> f64 {
    let inverse = match thermistor {
        Thermistor::Beta { ohm_at_25, beta } => 1.0 / 298.15 + (ohm / ohm_at_25).ln() / beta,
        Thermistor::SteinhartHart { a, b, c } => a + b * ohm.ln() + c * ohm.ln().powi(3),
        Thermistor::Platinum => unreachable!("no controller here measures with platinum"),
    };
    1.0 / inverse - 273.15
}

/// Heats up from a steady `from` to `to`, the controller's target.
pub fn heat_up(controller: &mut impl Controller, constants: &PlantConstants, from: f64, to: f64) -> HeatUp {
    let mut run = Loop::new(controller, constants, from);
    let mut block = Approach { overshoot: 0.0, reached: None, settled: Some(0.0) };
    let mut sensor = block;
    let mut time = 0.0;
    while time < WATCHED {
        run.step(0.0);
        time += PERIOD;
        for (approach, celsius) in [(&mut block, run.plant.hotend_celsius()), (&mut sensor, run.measured)] {
            approach.overshoot = approach.overshoot.max(celsius - to);
            if (celsius - to).abs() > BAND {
                approach.settled = Some(time);
            } else if approach.reached.is_none() {
                approach.reached = Some(time);
            }
        }
    }
    for approach in [&mut block, &mut sensor] {
        // A swinging temperature has been in the band for a while at any end.
        approach.settled = approach.settled.filter(|settled| *settled < WATCHED - 30.0);
    }
    HeatUp { block, sensor }
}

/// A minute of flow at 215 C, the controller's target, after two minutes and before one without.
pub fn flow_step(controller: &mut impl Controller, constants: &PlantConstants, mm3_s: f64) -> FlowStep {
    let mut run = Loop::new(controller, constants, PRINTING);
    let mut step = FlowStep { dip: 0.0, rise: 0.0 };
    let periods = |seconds: f64| 0..(seconds / PERIOD) as u32;
    for _ in periods(120.0) {
        run.step(0.0);
    }
    for _ in periods(60.0) {
        run.step(mm3_s);
        step.dip = step.dip.max(PRINTING - run.plant.hotend_celsius());
    }
    for _ in periods(60.0) {
        run.step(0.0);
        step.rise = step.rise.max(run.plant.hotend_celsius() - PRINTING);
    }
    step
}
