//! Bears: loads of belts, motors, guides and frame on a plant in motion.
//!
//! Tensions are elastic, without damping. Between two steps a held motor is at rest, so damping would show the belt's
//! whole speed. The motion of the steps themselves is in their impulses.

use super::field::Field;
use super::frame::{FrameAxis, MM_PER_M};
use super::plant::{Plant, Spring, sum};
use crate::math::{cos, square};
use std::f64::consts::TAU;

impl Plant {
    /// Elastic tension of each span in N.
    pub fn tensions<'a>(&'a self, at: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let springs = self.spans.iter().filter_map(|(_, first)| self.springs.get(*first));
        springs.map(|spring| self.tension(spring, at))
    }

    /// Electrical turns between a rotor and its commanded place: how often it has slipped.
    #[must_use]
    pub fn slips(&self, motor: usize, at_mm: f64, sent_mm: f64) -> f64 {
        ((at_mm - sent_mm) / (TAU * self.field(motor).radian_mm)).round()
    }

    /// Force of each motor at the belt, in N.
    pub fn motor_forces<'a>(&'a self, at: &'a [f64], sent_mm: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let first = self.first_motor();
        sent_mm.iter().enumerate().map(move |(motor, sent)| {
            if self.are_rotors() {
                return at.get(first + motor).map_or(0.0, |at| self.field_n(motor, *at, *sent));
            }
            let pull = |spring: &Spring| {
                let c: f64 = spring.row.iter().filter(|(i, _)| *i == first + motor).map(|(_, c)| c).sum();
                c * self.tension(spring, at)
            };
            self.springs.iter().map(pull).sum()
        })
    }

    /// Torque of all motors together in N mm, counter-clockwise on their rotors; the frame bears the opposite one.
    /// \[H\], after equation 38.
    #[must_use]
    pub fn motors_torque_n_mm(&self, at: &[f64], sent_mm: &[f64]) -> f64 {
        let forces = self.motor_forces(at, sent_mm).enumerate();
        forces.map(|(motor, force)| force * self.params.radius_mm(motor)).sum()
    }

    /// Torque in N mm with which the guides keep the bar square, against the belts and the head's inertia off the
    /// middle; 0 where the bar does not move in y.
    #[must_use]
    pub fn yaw_torque_n_mm(&self, at: &[f64], speeds: &[f64]) -> f64 {
        if !self.has_yawing_bar {
            return 0.0;
        }
        let (mut belts, mut force_y) = (0.0, 0.0);
        for spring in &self.springs {
            let tension = self.tension(spring, at);
            belts += spring.yaw_mm * tension;
            // A free length grows with the tool as its belt does.
            force_y -= spring.grows[1] * tension;
        }
        let mut forces = [0.0, force_y];
        self.rub(speeds, &mut forces);
        let arm = self.start().x + at.first().copied().unwrap_or(0.0) - self.params.width_mm / 2.0;
        let mass = self.masses_kg[1];
        belts + self.params.head_mass_kg / mass * forces[1] * arm
    }

    /// Mechanical energy in N mm beyond the preload at rest: motion, belts, fields.
    #[must_use]
    pub fn energy_n_mm(&self, at: &[f64], speeds: &[f64], sent_mm: &[f64]) -> f64 {
        let motion: f64 = speeds.iter().zip(&self.mobility).map(|(v, mobility)| v * v / mobility / 2.0).sum();
        let stored = |spring: &Spring| spring.stiffness * square(sum(&spring.row, at)) / 2.0;
        let belts: f64 = self.springs.iter().map(stored).sum::<f64>() + self.frame_energy_n_mm(at, speeds);
        if !self.are_rotors() {
            return motion + belts;
        }
        let rotors = at.iter().skip(self.first_motor()).zip(sent_mm).zip(&self.fields);
        let stored = |((at, sent), field): ((&f64, &f64), &Field)| {
            let radian = field.radian_mm;
            let (holding, detent) = (field.holding_n * radian, field.detent_n * radian / 4.0);
            holding * (1.0 - cos((sent - at) / radian)) + detent * (1.0 - cos(4.0 * at / radian))
        };
        motion + belts + rotors.map(stored).sum::<f64>()
    }

    /// The part of the energy that a soft frame adds: its spring, and the motion that the tool shares with it.
    fn frame_energy_n_mm(&self, at: &[f64], speeds: &[f64]) -> f64 {
        let Some(frame) = &self.frame else { return 0.0 };
        let first = self.first_frame();
        let of = |all: &[f64], index: usize| all.get(index).copied().unwrap_or(0.0);
        let axis = |(axis, (frame, kg)): (usize, (&FrameAxis, &f64))| {
            let moved = of(at, first + axis);
            frame.stiffness * moved * moved / 2.0 + kg / MM_PER_M * of(speeds, axis) * of(speeds, first + axis)
        };
        frame.0.iter().zip(&self.masses_kg).enumerate().map(axis).sum()
    }
}
