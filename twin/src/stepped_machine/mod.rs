//! Live: a machine that takes steps as they are made, and can be observed in between.
//!
//! It is the plant with rotors, in open-ended real time. Motors get and lose power, each at its own phase. The tool is
//! pushed and rotors are braked ([`Outside`](crate::dynamics::external_forces::Outside)). Ten thousand times a second
//! [`rotor`] looks at each motor and reports skips. Time at rest costs nothing. Parts may break ([`failing`]).
//!
//! A motor at speed has less than its holding torque: the law is [`pull_out`](crate::torque::pull_out), with the speed
//! of its rotor at the last look.

pub mod failing;
mod phase;
pub mod rotor;

pub use phase::phases_mm;

use crate::dynamics::plant::{BRAKED_IN_S, Plant};
use crate::dynamics::state::State;
use crate::math::sin;
use crate::model::ways::residual_mm;
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::steps::TICKS_PER_SECOND;
use crate::torque::pull_out::pull_out_torque_at_belt_nm;
use rotor::{Glance, Rotor};

/// Ticks between two looks: 90 looks a period of the faster axis, 29 of the fastest rotor mode.
const LOOK: u64 = 1000;

/// Longest integration step, in s: from one look to the next, a 29th of a period of the fastest rotor mode. It is
/// longer than for a played trace, because a machine runs along with its firmware for minutes; the test below shows the
/// effect.
const LONGEST_STEP_S: f64 = LOOK as f64 / TICKS_PER_SECOND;

// A holding brake stops a rotor in several stages of a step.
const _: () = assert!(LONGEST_STEP_S <= BRAKED_IN_S);

/// At rest is slower than this in mm/s, with at most [`STILL_MM_S2`].
const STILL_MM_S: f64 = 1e-4;

/// The slowest mode has 57 Hz, so the tool is within this over (2 pi 57 Hz)^2 of its rest position: 1 nm.
const STILL_MM_S2: f64 = 0.1;

/// A skip of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skip {
    /// Time when it left its place, in ticks.
    pub tick: u64,
    /// The motor's index.
    pub motor: usize,
    /// Electrical turns of four full steps, positive counter-clockwise.
    pub turns: i32,
    /// The tool's place then.
    pub tool: Place,
}

/// A machine in motion.
#[derive(Clone, Debug)]
pub struct Live {
    machine: Machine,
    plant: Plant,
    state: State,
    /// Belt per step of each motor.
    step_mm: Vec<f64>,
    /// Steps of each motor since the start.
    counts: Vec<i64>,
    /// The same in mm of belt.
    stepped_mm: Vec<f64>,
    /// Field strength of each motor, relative to its run current.
    given: Vec<f64>,
    rotors: Vec<Rotor>,
    skips: Vec<Skip>,
    /// By how much belt each pulley is ahead of its rotor, in mm.
    shifted_mm: Vec<f64>,
    now: u64,
    next_look: u64,
    is_at_rest: bool,
}

/// A plant with rotors, and with these idlers.
fn plant_of(machine: Machine, params: &Params, start: Place, idlers: &[usize]) -> Plant {
    Plant::with_idlers(machine, params, start, idlers).in_steps_of(LONGEST_STEP_S)
}

impl Live {
    /// A machine at rest with its tool at `start`, at a time in ticks of 0.1 us. No motor has power. A step is
    /// `step_mm` of belt, motor by motor. `phases_mm` has the magnetic zero of each motor relative to the belt without
    /// strain.
    #[must_use]
    pub fn new(machine: Machine, params: &Params, start: Place, step_mm: &[f64], phases_mm: &[f64], now: u64) -> Self {
        let plant = plant_of(machine, params, start, &[]);
        let motors = plant.ways.motors.len();
        let mut state = State::at_rest(&plant);
        for (sent, phase) in state.sent_mm.iter_mut().zip(phases_mm) {
            *sent = *phase;
        }
        state.outside.zeros_mm = state.sent_mm.clone();
        state.outside.strengths = vec![0.0; motors];
        state.outside.brakes_n = vec![0.0; motors];
        Self {
            machine,
            plant,
            state,
            step_mm: step_mm.to_vec(),
            counts: vec![0; motors],
            stepped_mm: vec![0.0; motors],
            given: vec![0.0; motors],
            rotors: vec![Rotor::default(); motors],
            skips: Vec::new(),
            shifted_mm: vec![0.0; motors],
            now,
            next_look: now + LOOK,
            is_at_rest: true,
        }
    }

    /// The time, in ticks.
    #[must_use]
    pub const fn now(&self) -> u64 {
        self.now
    }

    /// Whether everything is at rest.
    #[must_use]
    pub const fn is_at_rest(&self) -> bool {
        self.is_at_rest
    }

    /// Advances to a time in ticks; a past time changes nothing.
    pub fn advance(&mut self, tick: u64) {
        while self.now < tick {
            if self.is_at_rest {
                self.now = tick;
                self.next_look = tick + LOOK;
                return;
            }
            let until = tick.min(self.next_look);
            self.state.advance(&self.plant, (until - self.now) as f64 / TICKS_PER_SECOND);
            self.now = until;
            self.slip();
            if until == self.next_look {
                self.next_look += LOOK;
                self.look();
            }
        }
    }

    /// Steps motors now: this many steps each, counter-clockwise.
    pub fn step(&mut self, steps: &[i64]) {
        let motors = self.counts.iter_mut().zip(steps).zip(&mut self.stepped_mm).zip(&self.step_mm);
        for (((count, steps), stepped), step_mm) in motors {
            *count += steps;
            *stepped = *count as f64 * step_mm;
        }
        let fields = self.state.sent_mm.iter_mut().zip(&self.state.outside.zeros_mm);
        for ((sent, zero), stepped) in fields.zip(&self.stepped_mm) {
            *sent = zero + stepped;
        }
        self.plant.send(&self.state.sent_mm);
        self.is_at_rest = false;
    }

    /// Sets a motor's field to this part of its full strength; 0 is no power.
    pub fn give(&mut self, motor: usize, strength: f64) {
        let all = self.given.get_mut(motor).zip(self.state.outside.strengths.get_mut(motor));
        let Some(((given, now), rotor)) = all.zip(self.rotors.get_mut(motor)) else { return };
        if *given == strength {
            return;
        }
        if *given == 0.0 || strength == 0.0 {
            rotor.forget();
        }
        (*given, *now) = (strength, strength);
        self.is_at_rest = false;
    }

    /// Pushes the tool with this many N in x and y, until the next call.
    pub fn push(&mut self, force_n: [f64; 2]) {
        if self.state.outside.push_n != force_n {
            self.state.outside.push_n = force_n;
            self.is_at_rest = false;
        }
    }

    /// Puts an obstacle in the tool's way that resists with this many N in any direction; 0 removes it.
    pub fn obstruct(&mut self, force_n: f64) {
        if self.state.outside.obstacle_n != force_n {
            self.state.outside.obstacle_n = force_n;
            self.is_at_rest = false;
        }
    }

    /// Brakes a rotor with this many N at the belt, until the next call.
    pub fn brake(&mut self, motor: usize, force_n: f64) {
        if let Some(brake) = self.state.outside.brakes_n.get_mut(motor).filter(|brake| **brake != force_n) {
            *brake = force_n;
            self.is_at_rest = false;
        }
    }

    /// The tool's place, from motor 1's axis.
    #[must_use]
    pub fn tool(&self) -> Place {
        self.place_of(self.of_tool(&self.state.at))
    }

    /// Its speed, in mm/s.
    #[must_use]
    pub fn velocity_mm_s(&self) -> [f64; 2] {
        let [x, y, _] = self.of_tool(&self.state.speeds);
        [x, y]
    }

    /// The tool's commanded place, from its start and the steps.
    #[must_use]
    pub fn stepped_to(&self) -> Place {
        self.place_of(self.plant.ways.tool(&self.stepped_mm))
    }

    /// Residual of the rotors in mm: the strain of the belt. `None` on a machine that has none.
    #[must_use]
    pub fn residual_mm(&self) -> Option<f64> {
        residual_mm(self.machine, self.state.at.get(self.plant.first_motor()..).unwrap_or_default())
    }

    /// The machine.
    #[must_use]
    pub const fn machine(&self) -> Machine {
        self.machine
    }

    /// Steps of each motor since the start.
    #[must_use]
    pub fn counts(&self) -> &[i64] {
        &self.counts
    }

    /// The rotors, as of the last look.
    #[must_use]
    pub fn rotors(&self) -> &[Rotor] {
        &self.rotors
    }

    /// Mean torque share of a motor since the last call, of 1.
    pub fn take_share(&mut self, motor: usize) -> f64 {
        self.rotors.get_mut(motor).map_or(0.0, Rotor::take_share)
    }

    /// Motors that have skipped, each reported once.
    pub fn take_skips(&mut self) -> Vec<Skip> {
        std::mem::take(&mut self.skips)
    }

    /// x, y and z from positions or speeds; z is 0 where no belt lifts the tool.
    fn of_tool(&self, of: &[f64]) -> [f64; 3] {
        [0, 1, 2].map(|axis| of.get(axis).copied().filter(|_| axis < self.plant.axes()).unwrap_or(0.0))
    }

    fn place_of(&self, [x, y, z]: [f64; 3]) -> Place {
        let start = self.plant.start();
        Place { x: start.x + x, y: start.y + y, z: start.z + z }
    }

    fn look(&mut self) {
        let is_slow = self.state.speeds.iter().all(|v| v.abs() < STILL_MM_S);
        self.is_at_rest = is_slow && self.state.accelerations(&self.plant).iter().all(|a| a.abs() < STILL_MM_S2);
        let tool = self.tool();
        let (first, params) = (self.plant.first_motor(), &self.plant.params);
        let State { at, speeds, sent_mm, outside, .. } = &mut self.state;
        let moving = at.iter().zip(speeds.iter()).skip(first).zip(sent_mm.iter());
        let powered = self.given.iter().zip(&mut outside.strengths);
        for (motor, ((((at, speed), sent), (given, strength)), rotor)) in
            moving.zip(powered).zip(&mut self.rotors).enumerate()
        {
            if *given == 0.0 {
                continue;
            }
            *strength = given * pull_out_torque_at_belt_nm(params, motor, *speed) / params.holding_torque_nm;
            let glance = Glance {
                tick: self.now,
                turns: self.plant.slips(motor, *at, *sent),
                share: sin((sent - at) / params.electrical_radian_mm(motor)).abs(),
                is_at_rest: self.is_at_rest,
                tool,
            };
            if let Some((tick, turns, tool)) = rotor.look(&glance) {
                self.skips.push(Skip { tick, motor, turns, tool });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tool's oscillation in mm, each 0.1 ms for 0.1 s, after a motor has made this many steps at once, 16 a full
    /// step, with another motor braked.
    fn swing(params: &Params, steps: i64, refinement: f64) -> Vec<[f64; 2]> {
        let start = Place::flat(150.0, 300.0);
        let mut live = Live::new(Machine::CoreHBot, params, start, &[params.full_step_mm(0) / 16.0; 4], &[], 0);
        live.state.refinement = refinement;
        (0..4).for_each(|motor| live.give(motor, 1.0));
        live.step(&[steps, 0, 0, 0]);
        live.brake(2, 5.0);
        let look = |at: u64| {
            live.advance(1000 * at);
            let tool = live.tool();
            [tool.x - start.x, tool.y - start.y]
        };
        (1..=1000).map(look).collect()
    }

    /// Without damping errors grow with time, and faster where the field hardly holds (at two full steps).
    #[test]
    fn shorter_steps_of_the_integration_change_little_in_a_tenth_of_a_second() {
        let undamped = Params { belt_damping_s: 0.0, rotor_damping_nm_s: 0.0, ..Params::default() };
        for (params, steps, part) in
            [(Params::default(), 20, 2e-4), (Params::default(), 24, 2e-4), (undamped, 20, 2e-3)]
        {
            let (coarse, fine) = (swing(&params, steps, 1.0), swing(&params, steps, 8.0));
            let greatest = fine.iter().flatten().fold(0.0_f64, |most, mm| most.max(mm.abs()));
            let off = coarse.iter().flatten().zip(fine.iter().flatten()).map(|(a, b)| (a - b).abs());
            let worst = off.fold(0.0_f64, f64::max);
            assert!(greatest > 0.1 && worst < part * greatest, "{worst} of {greatest} mm");
        }
    }
}
