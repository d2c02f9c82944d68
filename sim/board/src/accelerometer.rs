//! The accelerometer at the tool: samples by the plant's motion, with noise, and with faults.
//!
//! On the belt plant a sample is the mean acceleration of the tool over its time. A rigid machine has no vibration, so
//! it gets modes: resonators that follow the nozzle, whose weighted sum is the tool.

use corehbot::accelerometer::{Sample, SensorFault, SensorKind};
use corehbot::port::Accelerometer;
use corehbot::units::TICKS_PER_SECOND;
use std::cell::RefCell;
use std::collections::VecDeque;

/// Gravity along z, in mm/s^2.
const GRAVITY: f64 = 9806.65;

/// Longest step of a mode in s: a mode of 100 Hz is 2 millionths off in frequency.
const STEP_S: f64 = 20e-6;

/// A mode of a rigid machine's tool in x or y.
#[derive(Clone, Copy, Debug)]
pub struct ModeTruth {
    /// 0 for x, 1 for y.
    pub axis: usize,
    /// Its frequency in Hz.
    pub hz: f64,
    /// Its damping, a ratio to critical damping.
    pub damping: f64,
    /// Its part of the tool's motion.
    pub part: f64,
}

/// What goes wrong with a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorAccident {
    /// It fails so.
    Fails(SensorFault),
    /// It gives the last sample again and again.
    Sticks,
    /// It gives nothing more.
    IsUnplugged,
}

/// A sensor as it is.
#[derive(Clone, Debug)]
pub struct SensorTruth {
    /// Standard deviation of its noise in mm/s^2.
    pub noise: f64,
    /// Its clock runs faster by this factor.
    pub clock: f64,
    /// Modes of a rigid machine.
    pub modes: Vec<ModeTruth>,
    /// What goes wrong after so many samples since it was last started.
    pub accident: Option<(u64, SensorAccident)>,
}

impl Default for SensorTruth {
    /// 100 mm/s^2 of noise, and a clock 0.5 % fast, as an ADXL345 has them.
    fn default() -> Self {
        Self { noise: 100.0, clock: 1.005, modes: Vec::new(), accident: None }
    }
}

/// The sensor, and the resonators of a rigid machine.
#[derive(Debug, Default)]
pub struct SimSensor {
    /// None if no sensor is plugged in.
    pub truth: Option<SensorTruth>,
    /// Seconds from sample to sample, while it runs.
    period: Option<f64>,
    /// When the next sample is due in s, and samples since the start.
    next: f64,
    count: u64,
    samples: VecDeque<Sample>,
    fault: Option<SensorFault>,
    last: Sample,
    /// Velocity of the tool at the last sample, on the belt plant.
    velocity: Option<[f64; 2]>,
    /// Place from its origin and velocity of each resonator, and the time up to which they are known.
    states: Vec<[f64; 2]>,
    time: f64,
    /// Sums of the tool's acceleration since the last sample.
    impulse: [f64; 2],
    random: u64,
}

impl SimSensor {
    /// When the next sample is due by `now`, in ticks.
    pub(crate) fn due(&self, now: u64) -> Option<u64> {
        self.period?;
        let tick = (self.next * f64::from(TICKS_PER_SECOND)) as u64;
        (tick <= now).then_some(tick)
    }

    /// The time of the next sample has come, and the belt plant's tool moves at this velocity in mm/s.
    pub(crate) fn move_at(&mut self, velocity: [f64; 2]) {
        let Some(period) = self.period else { return };
        let before = self.velocity.replace(velocity).unwrap_or(velocity);
        self.sample([(velocity[0] - before[0]) / period, (velocity[1] - before[1]) / period]);
    }

    /// The time of the next sample has come on a rigid machine.
    pub(crate) fn sample_rigid(&mut self) {
        let Some(period) = self.period else { return };
        let impulse = std::mem::take(&mut self.impulse);
        self.sample(impulse.map(|sum| sum / period));
    }

    /// Whether it runs on a tool with modes, so that it has to know where the nozzle is.
    pub(crate) fn vibrates(&self) -> bool {
        self.period.is_some() && self.truth.as_ref().is_some_and(|truth| !truth.modes.is_empty())
    }

    /// Time passes up to `now` in ticks, with a rigid machine's nozzle at that place.
    pub(crate) fn vibrate(&mut self, now: u64, nozzle: [f64; 3]) {
        let Some(truth) = self.truth.as_ref().filter(|_| self.vibrates()) else { return };
        let now = now as f64 / f64::from(TICKS_PER_SECOND);
        if self.states.len() != truth.modes.len() {
            self.states = truth.modes.iter().map(|mode| [nozzle[mode.axis], 0.0]).collect();
            self.time = now;
        }
        let steps = ((now - self.time) / STEP_S).ceil();
        let step = (now - self.time) / steps.max(1.0);
        for _ in 0..steps as u64 {
            for (mode, [at, speed]) in truth.modes.iter().zip(&mut self.states) {
                let w = std::f64::consts::TAU * mode.hz;
                let force = |at: f64, speed: f64| w * w * (nozzle[mode.axis] - at) - 2.0 * mode.damping * w * speed;
                // Velocity Verlet, with the damping by a mean.
                let half = *speed + 0.5 * step * force(*at, *speed);
                *at += step * half;
                let spring = w * w * (nozzle[mode.axis] - *at);
                let after = (half + 0.5 * step * spring) / (1.0 + mode.damping * w * step);
                self.impulse[mode.axis] += mode.part * (after - *speed);
                *speed = after;
            }
        }
        self.time = now;
    }

    fn sample(&mut self, [x, y]: [f64; 2]) {
        let (Some(truth), Some(period)) = (self.truth.clone(), self.period) else { return };
        self.next += period;
        self.count += 1;
        match truth.accident.filter(|(after, _)| self.count > *after) {
            Some((_, SensorAccident::Fails(fault))) => self.fault = Some(fault),
            Some((_, SensorAccident::IsUnplugged)) => return,
            Some((_, SensorAccident::Sticks)) => {}
            None => self.last = Sample { axes: [x, y, GRAVITY].map(|a| (a + truth.noise * self.normal()) as i32) },
        }
        self.samples.push_back(self.last);
    }

    /// A number of a normal distribution, nearly: a sum of twelve (Knuth, The Art of Computer Programming, 3.4.1).
    fn normal(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (self.random >> 40) as f64 / (1u64 << 24) as f64;
        }
        sum
    }
}

/// The sensor as the firmware's port, at a time in ticks.
pub(crate) struct Sensor<'w> {
    pub sensor: &'w RefCell<SimSensor>,
    pub now: &'w std::cell::Cell<u64>,
}

impl Accelerometer for Sensor<'_> {
    fn start(&mut self, kind: SensorKind, rate: u16) {
        let mut sensor = self.sensor.borrow_mut();
        let clock = sensor.truth.as_ref().map_or(1.0, |truth| truth.clock);
        let rate = if kind == SensorKind::Lis2dw12 { rate.min(1600) } else { rate };
        let period = 1.0 / (f64::from(rate) * clock);
        let now = self.now.get() as f64 / f64::from(TICKS_PER_SECOND);
        (sensor.period, sensor.next, sensor.count) = (sensor.truth.is_some().then_some(period), now + period, 0);
        sensor.fault = if sensor.truth.is_some() { None } else { Some(SensorFault::WrongId(0)) };
        sensor.samples.clear();
        sensor.states.clear();
        (sensor.velocity, sensor.impulse) = (None, [0.0; 2]);
    }

    fn take(&mut self, into: &mut [Sample]) -> Result<usize, SensorFault> {
        let mut sensor = self.sensor.borrow_mut();
        if let Some(fault) = sensor.fault {
            return Err(fault);
        }
        let mut count = 0;
        for place in into {
            let Some(sample) = sensor.samples.pop_front() else { break };
            *place = sample;
            count += 1;
        }
        Ok(count)
    }

    fn stop(&mut self) {
        let mut sensor = self.sensor.borrow_mut();
        sensor.period = None;
        sensor.samples.clear();
    }
}
