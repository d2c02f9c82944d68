//! The rig: a machine made of numbers, for boards that have none of metal.
//!
//! It counts the steps of each motor, knows from them where the tool is, and presses endstops. The host simulator and
//! the QEMU board use the same rig, so a homing move ends at the same step on both. Its heat is [`plant`].
//!
//! The switches sit where the settings say ([`Endstop`](corehbot::settings::Endstop)) and stay pressed beyond: that is
//! where homing looks for them (`src/machine/homing`). The probe of a machine that has one is in [`bed`].
#![no_std]
#![forbid(unsafe_code)]

pub mod bed;
pub mod plant;
pub mod thermal_plant;

use corehbot::kinematics::ForwardKinematics;
use corehbot::motors::{EndstopSet, MOTORS, Motor, MotorSet};
use corehbot::settings::{AxisEnd, Settings};
use corehbot::units::Mm;

/// The default place of the tool at power-up: well inside, and not on a round number.
pub const AT_POWER_UP: [Mm; 3] = [Mm::lit("31.7"), Mm::lit("23.3"), Mm::lit("12.4")];

/// The simulated machine. An endstop is pressed while its axis is at its place or beyond.
pub struct Rig {
    /// Steps of each motor, signed, since power-up.
    counts: [i32; MOTORS],
    /// A step's part in the tool's position for each motor: x, y and z are sums of all counts, ready for the step
    /// interrupt. Sums grow away from the switches.
    weights: [[i32; 3]; MOTORS],
    /// Motors up to the last one that moves the tool. The sums leave out the others, so a place for one more motor
    /// costs the step interrupt nothing.
    moving: usize,
    /// Tool at power-up, in units of these sums, seen from the switches: 0 is where they are met.
    start: [i64; 3],
    /// The places of the switches, in mm, and the mm of one unit of these sums, signed.
    switches: [f64; 3],
    units: [f64; 3],
    /// The switches that there are.
    inputs: EndstopSet,
}

impl Rig {
    /// A machine with its tool at `start` (x, y, z in mm), or somewhere if `None`.
    #[must_use]
    pub fn new(settings: &Settings, start: Option<[Mm; 3]>) -> Self {
        let a = &settings.axes;
        let pitch = [a.x.steps_per_mm, a.y.steps_per_mm, a.z.steps_per_mm];
        let switches = settings.endstops.to_array();
        let mut steps = [0; 3];
        let places = start.unwrap_or(AT_POWER_UP).into_iter().zip(switches);
        for ((steps, (mm, switch)), pitch) in steps.iter_mut().zip(places).zip(pitch) {
            let from_switch = i128::from(mm.to_bits()) - i128::from(switch.position.to_bits());
            *steps = ((from_switch * i128::from(pitch.to_bits())) >> 48) as i32;
        }
        let back = settings.mechanism.forward_kinematics().unwrap_or(ForwardKinematics::NONE);
        let (counts, weights) = ([0; MOTORS], [[0; 3]; MOTORS]);
        let away = switches.map(|switch| match switch.end {
            AxisEnd::Min => 1,
            AxisEnd::Max => -1,
        });
        let inputs = EndstopSet::SWITCHES;
        let places = switches.map(|switch| switch.position.to_num());
        let mut rig = Self { counts, weights, moving: 0, start: [0; 3], switches: places, units: [0.0; 3], inputs };
        for (motor, weights) in rig.weights.iter_mut().enumerate() {
            let mut one = [0; MOTORS];
            one[motor] = 1;
            let axes = back.fractions(&one).into_iter().zip(steps).zip(away).zip(pitch);
            let places = weights.iter_mut().zip(&mut rig.start).zip(&mut rig.units);
            for (((place, start), unit), ((((weight, over), steps), away), pitch)) in places.zip(axes) {
                (*place, *start) = (weight as i32 * away, over * i64::from(steps * away));
                *unit = f64::from(away) / (over as f64 * pitch.to_num::<f64>());
            }
            if *weights != [0; 3] {
                rig.moving = motor + 1;
            }
        }
        rig
    }

    /// The same machine with these endstops alone.
    #[must_use]
    pub const fn with_inputs(self, inputs: EndstopSet) -> Self {
        Self { inputs, ..self }
    }

    /// The endstops that there are.
    #[must_use]
    pub const fn inputs(&self) -> EndstopSet {
        self.inputs
    }

    /// One step of each motor in `steps`, forward if it is in `forward`.
    pub fn step(&mut self, steps: MotorSet, forward: MotorSet) {
        self.step_often(steps, forward, 1);
    }

    /// Several steps, `times` of them.
    pub fn step_often(&mut self, steps: MotorSet, forward: MotorSet, times: i32) {
        for (motor, count) in Motor::ALL.into_iter().zip(&mut self.counts) {
            if steps.has(motor) {
                *count = count.wrapping_add(if forward.has(motor) { times } else { -times });
            }
        }
    }

    /// Steps of each motor since power-up, signed.
    #[must_use]
    pub const fn counts(&self) -> [i32; MOTORS] {
        self.counts
    }

    /// How far each axis is from its switch, in units of the sums.
    fn sums(&self) -> [i64; 3] {
        let mut sums = self.start;
        for (weights, count) in self.weights.iter().zip(&self.counts).take(self.moving) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += i64::from(*weight) * i64::from(*count);
            }
        }
        sums
    }

    /// Where the nozzle is, in mm.
    #[must_use]
    pub fn nozzle(&self) -> [f64; 3] {
        let mut places = self.switches;
        for ((place, unit), sum) in places.iter_mut().zip(self.units).zip(self.sums()) {
            *place += unit * sum as f64;
        }
        places
    }

    /// The switches that are pressed.
    #[must_use]
    pub fn endstops(&self) -> EndstopSet {
        let sums = self.sums();
        let switches = [EndstopSet::X, EndstopSet::Y, EndstopSet::Z];
        let mut pressed = 0;
        for (sum, switch) in sums.into_iter().zip(switches) {
            if sum <= 0 {
                pressed |= switch.0;
            }
        }
        EndstopSet(pressed & self.inputs.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype;

    #[test]
    fn the_switch_of_x_is_pressed_when_the_tool_gets_there() {
        let start = [Mm::ONE, Mm::ONE, Mm::ONE];
        let mut rig = Rig::new(&Settings::prototype(), Some(start));
        assert_eq!(rig.endstops(), EndstopSet::NONE);
        // To the left: 1 and 4 counter-clockwise, 8 and 11 clockwise.
        let forward = MotorSet::of(prototype::M1).with(MotorSet::of(prototype::M4));
        for _ in 0..79 {
            rig.step(prototype::BELT, forward);
        }
        assert_eq!(rig.endstops(), EndstopSet::NONE);
        rig.step(prototype::BELT, forward);
        assert_eq!(rig.endstops(), EndstopSet::X);
        assert_eq!(rig.nozzle(), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn the_nozzle_is_as_far_from_a_switch_at_the_far_end() {
        let mut settings = Settings::prototype();
        settings.endstops.x.end = AxisEnd::Max;
        settings.endstops.x.position = settings.axes.x.length;
        let start = ["31.5", "23.25", "12.5"].map(Mm::lit);
        assert_eq!(Rig::new(&settings, Some(start)).nozzle(), [31.5, 23.25, 12.5]);
    }
}
