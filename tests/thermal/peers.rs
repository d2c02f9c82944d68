//! The control of other firmwares: bang-bang, and PID with parameters from a relay.
//!
//! Both as Klipper's documentation describes them (Config_Reference, `control: watermark` and `control: pid`;
//! Config_checks, *Calibrate PID settings*), in words and code of our own. It measures every 0.3 s. The relay is Astrom
//! and Hagglund's (Automatic tuning of simple regulators, 1984), the rule Ziegler and Nichols' classic one (1942).

use std::f64::consts::PI;

use corehbot_rig::plant::PlantConstants;

use super::runs::{Controller, Loop};

/// How often it measures, s.
const MEASURED_EVERY: f64 = 0.3;
/// The smoothing time of PID's derivative, s (`smooth_time`).
const SMOOTH_TIME: f64 = 1.0;
/// The most that bang-bang lets the temperature be off, K (`max_delta`).
const MAX_DELTA: f64 = 2.0;
/// The relay switches off at the target and on again this much below it, K.
const RELAY_BAND: f64 = 5.0;
/// Turning points that a calibration waits for, and the number of them in the heat-up.
const TURNS: usize = 12;
const TURNS_OF_HEAT_UP: usize = 4;

/// How a duty gets to the heater.
#[derive(Clone, Copy, Debug)]
pub enum Output {
    /// At once, as the equations have it.
    AtOnce,
    /// As Klipper sends it to its microcontroller: it takes effect 0.3 s after the measurement. Changes of less than
    /// 0.05 are sent only 0.75 of 3 s after the last change took effect.
    ByHost,
}

/// Asks a controller every 0.3 s only, and keeps its duty in between.
struct Seldom<C> {
    controller: C,
    output: Output,
    since: f64,
    duty: f64,
    /// Sent, but not in effect.
    sent: f64,
    /// Since that was sent, s.
    sent_since: f64,
}

impl<C: Controller> Seldom<C> {
    const fn new(controller: C, output: Output) -> Self {
        Self { controller, output, since: 0.0, duty: 0.0, sent: 0.0, sent_since: 0.0 }
    }
}

impl<C: Controller> Controller for Seldom<C> {
    fn duty(&mut self, measured_celsius: f64, seconds: f64) -> f64 {
        self.since += seconds;
        if self.since < MEASURED_EVERY - 1e-9 {
            return self.duty;
        }
        let wanted = self.controller.duty(measured_celsius, self.since);
        self.sent_since += self.since;
        self.since = 0.0;
        match self.output {
            Output::AtOnce => self.duty = wanted,
            Output::ByHost => {
                self.duty = self.sent;
                let is_small = (wanted - self.sent).abs() < 0.05;
                if !is_small || (self.sent > 0.0 && self.sent_since >= MEASURED_EVERY + 0.75 * 3.0) {
                    (self.sent, self.sent_since) = (wanted, 0.0);
                }
            }
        }
        self.duty
    }
}

/// All or nothing.
struct BangBang {
    target: f64,
    heats: bool,
}

impl Controller for BangBang {
    fn duty(&mut self, measured_celsius: f64, _seconds: f64) -> f64 {
        if measured_celsius >= self.target + MAX_DELTA {
            self.heats = false;
        } else if measured_celsius <= self.target - MAX_DELTA {
            self.heats = true;
        }
        f64::from(u8::from(self.heats))
    }
}

/// The parameters of a PID, in duty: 1/K, 1/(K s), s/K.
#[derive(Clone, Copy, Debug)]
pub struct Gains {
    pub proportional: f64,
    pub integral: f64,
    pub derivative: f64,
}

struct Pid {
    gains: Gains,
    target: f64,
    last: Option<f64>,
    /// K/s.
    slope: f64,
    /// K s.
    sum: f64,
}

impl Pid {
    const fn new(gains: Gains, target: f64) -> Self {
        Self { gains, target, last: None, slope: 0.0, sum: 0.0 }
    }
}

impl Controller for Pid {
    fn duty(&mut self, measured_celsius: f64, seconds: f64) -> f64 {
        let Gains { proportional, integral, derivative } = self.gains;
        let rise = measured_celsius - self.last.replace(measured_celsius).unwrap_or(measured_celsius);
        self.slope += (rise - self.slope * seconds) / SMOOTH_TIME;
        let error = self.target - measured_celsius;
        let sum = (self.sum + error * seconds).clamp(0.0, 1.0 / integral);
        let wanted = proportional * error + integral * sum - derivative * self.slope;
        let duty = wanted.clamp(0.0, 1.0);
        // The sum rests while the heater is at a limit.
        if duty == wanted {
            self.sum = sum;
        }
        duty
    }
}

/// Swings round a target and notes where the temperature turns.
struct Relay {
    target: f64,
    heats: bool,
    time: f64,
    /// The extreme since the last switch, and when.
    turn: (f64, f64),
    turns: Vec<(f64, f64)>,
}

impl Controller for Relay {
    fn duty(&mut self, measured_celsius: f64, seconds: f64) -> f64 {
        self.time += seconds;
        let switches =
            if self.heats { measured_celsius >= self.target } else { measured_celsius <= self.target - RELAY_BAND };
        let is_further = if self.heats { measured_celsius < self.turn.0 } else { measured_celsius > self.turn.0 };
        if switches {
            self.turns.push(self.turn);
            self.heats = !self.heats;
        }
        if switches || is_further {
            self.turn = (measured_celsius, self.time);
        }
        f64::from(u8::from(self.heats))
    }
}

/// Calibrates on a cold plant.
pub fn calibrate(constants: &PlantConstants, target: f64, output: Output) -> Gains {
    let cold = constants.ambient_celsius;
    let relay = Relay { target, heats: true, time: 0.0, turn: (cold, 0.0), turns: Vec::new() };
    let mut relay = Seldom::new(relay, output);
    let mut run = Loop::new(&mut relay, constants, cold);
    // 20 ms each: at most an hour.
    for _ in 0..180_000 {
        run.step(0.0);
        if run.controller.controller.turns.len() >= TURNS {
            break;
        }
    }
    let turns = relay.controller.turns;
    assert!(turns.len() >= TURNS, "it does not swing: {turns:?}");
    let mut cycles: Vec<(f64, f64)> = (TURNS_OF_HEAT_UP..turns.len())
        .map(|at| (turns[at].1 - turns[at - 2].1, (turns[at].0 - turns[at - 1].0).abs() / 2.0))
        .collect();
    cycles.sort_by(|a, b| a.0.total_cmp(&b.0));
    // The cycle of median length.
    let (period, amplitude) = cycles[cycles.len() / 2];
    let ultimate = 4.0 / (PI * amplitude);
    let proportional = 0.6 * ultimate;
    Gains { proportional, integral: proportional / (0.5 * period), derivative: proportional * 0.125 * period }
}

/// Bang-bang as Klipper has it.
pub fn bang_bang(target: f64, output: Output) -> impl Controller {
    Seldom::new(BangBang { target, heats: false }, output)
}

/// PID as Klipper has it.
pub fn pid(gains: Gains, target: f64, output: Output) -> impl Controller {
    Seldom::new(Pid::new(gains, target), output)
}
