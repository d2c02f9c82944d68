//! Watch: the loads of a machine while a trace is played.

use super::series::{Bin, Series};
use crate::contour::error::ContourError;
use crate::contour::touches::Touches;
use crate::dynamics::plant::Plant;
use crate::dynamics::state::State;
use crate::model::ways::residual_mm;
use crate::routing::Machine;
use crate::torque::pull_out::pull_out_torque_at_belt_nm;

/// At rest is slower than this in mm/s, with at most [`STILL_MM_S2`] of acceleration.
const STILL_MM_S: f64 = 1e-4;

/// See [`STILL_MM_S`].
const STILL_MM_S2: f64 = 0.1;

/// Lowest and highest value of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lowest.
    pub least: f64,
    /// Highest.
    pub greatest: f64,
}

impl Range {
    const fn at(value: f64) -> Self {
        Self { least: value, greatest: value }
    }

    const fn take(&mut self, value: f64) {
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
    }
}

/// Loads of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorWatch {
    /// Largest force at the belt, in N.
    pub greatest_force_n: f64,
    /// Largest part of the motor's torque at its rotor's speed, of 1; 0 if motors are not rotors.
    pub greatest_part_at_speed: f64,
    /// Number of electrical turns lost or gained.
    pub slips: u32,
    /// Electrical turns by which it is off.
    pub turns_off: f64,
}

/// Loads of a machine so far.
#[derive(Clone, Debug)]
pub struct Watch {
    machine: Machine,
    /// Errors of the tool.
    pub contour: ContourError,
    /// Errors of the commanded places from the same line: rounding to steps, and a shaper's.
    pub commanded: ContourError,
    /// How far the line itself may be from the planned one, in mm: 0 for a plan, a step for a line of steps.
    pub line_share_mm: f64,
    /// Tension of each span in N.
    pub tensions_n: Vec<Range>,
    /// Number of times that a span became slack.
    pub slack: u32,
    is_slack: Vec<bool>,
    /// The motors, ascending.
    pub motors: Vec<MotorWatch>,
    /// Largest residual of the commanded steps.
    pub commanded_residual_mm: f64,
    /// Largest residual of the motors' real positions.
    pub residual_mm: f64,
    /// Largest torque with which the guides kept the bar square.
    pub yaw_torque_n_mm: f64,
    /// Largest torque of all motors together on the frame.
    pub motors_torque_n_mm: f64,
    /// Largest displacement of a soft frame on the ground along x and y; none of a rigid one.
    pub frame_mm: Option<[f64; 2]>,
    /// The tool minus the end of its line along x and y, once it is at rest after the last step.
    pub end_off_mm: [f64; 2],
    /// Results over time.
    pub series: Series,
    /// Present values, kept to avoid allocation at each look.
    now: Bin,
}

/// Errors from a line.
pub(super) struct Errors {
    pub tool: ContourError,
    pub commanded: ContourError,
    pub line_share_mm: f64,
}

impl Errors {
    /// The same with the errors in touches apart.
    pub(super) fn apart_from(self, touches: Touches) -> Self {
        let Self { tool, commanded, line_share_mm } = self;
        Self { tool: tool.apart_from(touches.clone()), commanded: commanded.apart_from(touches), line_share_mm }
    }
}

/// Whether nothing moves, nor is about to.
pub(super) fn is_at_rest(plant: &Plant, state: &mut State) -> bool {
    let is_slow = state.speeds.iter().all(|v| v.abs() < STILL_MM_S);
    is_slow && state.accelerations(plant).iter().all(|a| a.abs() < STILL_MM_S2)
}

impl Watch {
    /// A machine at rest.
    pub(super) fn new(machine: Machine, plant: &Plant, errors: Errors, commanded_residual_mm: f64) -> Self {
        let spans = plant.span_names().count();
        Self {
            machine,
            contour: errors.tool,
            commanded: errors.commanded,
            line_share_mm: errors.line_share_mm,
            tensions_n: plant.tensions(&[]).map(Range::at).collect(),
            slack: 0,
            is_slack: vec![false; spans],
            motors: vec![MotorWatch::default(); plant.ways.motors.len()],
            commanded_residual_mm,
            residual_mm: 0.0,
            yaw_torque_n_mm: 0.0,
            motors_torque_n_mm: 0.0,
            frame_mm: plant.has_soft_frame().then_some([0.0; 2]),
            end_off_mm: [0.0; 2],
            series: Series::default(),
            now: Bin::default(),
        }
    }

    pub(super) const fn machine(&self) -> Machine {
        self.machine
    }

    /// Looks at the machine and returns whether it is at rest.
    pub(super) fn look(&mut self, tick: u64, plant: &Plant, state: &mut State) -> bool {
        let is_at_rest = is_at_rest(plant, state);
        let State { at, speeds, sent_mm, .. } = state;
        let [x, y] = [at.first(), at.get(1)].map(|v| v.copied().unwrap_or(0.0));
        self.now.error_mm = self.contour.sample(tick, [plant.start().x + x, plant.start().y + y]);
        let [x, y, _] = plant.ways.tool(sent_mm);
        self.commanded.sample(tick, [plant.start().x + x, plant.start().y + y]);
        self.now.tensions_n.clear();
        self.now.forces_n.clear();
        let spans = self.tensions_n.iter_mut().zip(&mut self.is_slack);
        for (tension, (range, is_slack)) in plant.tensions(at).zip(spans) {
            range.take(tension);
            self.now.tensions_n.push([tension; 2]);
            self.slack += u32::from(tension <= 0.0 && !*is_slack);
            *is_slack = tension <= 0.0;
        }
        for (force, motor) in plant.motor_forces(at, sent_mm).zip(&mut self.motors) {
            motor.greatest_force_n = motor.greatest_force_n.max(force.abs());
            self.now.forces_n.push(force.abs());
        }
        if plant.are_rotors() {
            self.look_at_rotors(plant, at, speeds, sent_mm);
        } else {
            self.residual_mm = self.commanded_residual_mm;
        }
        let torque = plant.motors_torque_n_mm(at, sent_mm);
        self.motors_torque_n_mm = self.motors_torque_n_mm.max(torque.abs());
        self.now.motors_torque_n_mm = [torque.min(0.0), torque.max(0.0)];
        self.now.frame_mm = plant.frame_mm(at).map(f64::abs);
        for (most, moved) in self.frame_mm.iter_mut().flatten().zip(self.now.frame_mm) {
            *most = most.max(moved);
        }
        self.series.add(tick, &self.now);
        self.yaw_torque_n_mm = self.yaw_torque_n_mm.max(plant.yaw_torque_n_mm(at, speeds).abs());
        is_at_rest
    }

    fn look_at_rotors(&mut self, plant: &Plant, at: &[f64], speeds: &[f64], sent_mm: &[f64]) {
        let rotor_speeds = speeds.get(plant.first_motor()..).unwrap_or_default();
        for (index, ((force, speed), motor)) in
            self.now.forces_n.iter().zip(rotor_speeds).zip(&mut self.motors).enumerate()
        {
            let has_nm = pull_out_torque_at_belt_nm(&plant.params, index, *speed);
            let part = force * plant.params.radius_mm(index) / 1000.0 / has_nm;
            motor.greatest_part_at_speed = motor.greatest_part_at_speed.max(part);
        }
        let rotors = at.get(plant.first_motor()..).unwrap_or_default();
        for (index, ((at, sent), motor)) in rotors.iter().zip(sent_mm).zip(&mut self.motors).enumerate() {
            let turns = plant.slips(index, *at, *sent);
            if turns != motor.turns_off {
                motor.slips += 1;
                motor.turns_off = turns;
            }
        }
        self.residual_mm = self.residual_mm.max(residual_mm(self.machine, rotors).unwrap_or(0.0).abs());
    }
}
