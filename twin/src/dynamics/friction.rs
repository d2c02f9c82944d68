//! Friction: of guides, and of brakes and obstacles that stick.

use super::frame::MM_PER_M;
use super::plant::{BRAKED_IN_S, Plant};
use crate::math::{hypot, tanh};

/// Dry friction changes its sign over this speed, in mm/s.
pub const CREEP: f64 = 1.0;

impl Plant {
    /// Guides: viscous and dry friction.
    pub(super) fn rub(&self, speeds: &[f64], forces: &mut [f64]) {
        let guides = self.params.guides().into_iter().take(self.axes());
        for ((viscous, dry), (speed, force)) in guides.zip(speeds.iter().zip(forces)) {
            *force -= viscous / MM_PER_M * speed;
            if dry > 0.0 {
                *force -= dry * tanh(speed / CREEP);
            }
        }
    }

    /// Deceleration rate of creeping parts by dry friction of the guides, in 1/s.
    pub(super) fn rubs(&self) -> f64 {
        let guides = self.params.guides().into_iter().take(self.axes());
        guides.zip(&self.mobility).map(|((_, dry), mobility)| dry * mobility / CREEP).fold(0.0, f64::max)
    }

    /// Dry friction that sticks, on the rotors or idlers from the coordinate `first` on: the force that stops each at
    /// once, as far as its brake can.
    pub(super) fn brake(&self, first: usize, speeds: &[f64], brakes_n: &[f64], forces: &mut [f64]) {
        let wheels = speeds.iter().zip(&self.mobility).skip(first).zip(forces.iter_mut().skip(first));
        for (((speed, mobility), force), brake) in wheels.zip(brakes_n) {
            if *brake == 0.0 {
                continue;
            }
            let stops = *force + speed / (mobility * BRAKED_IN_S);
            *force -= stops.clamp(-brake, *brake);
        }
    }

    /// The same on the tool, in any direction of motion.
    pub(super) fn obstruct(&self, speeds: &[f64], most_n: f64, forces: &mut [f64]) {
        let ([vx, vy, ..], [mx, my, ..], [fx, fy, ..]) = (speeds, &self.mobility[..], forces) else { return };
        let stops = [*fx + vx / (mx * BRAKED_IN_S), *fy + vy / (my * BRAKED_IN_S)];
        let part = (most_n / hypot(stops[0], stops[1]).max(most_n)).min(1.0);
        *fx -= part * stops[0];
        *fy -= part * stops[1];
    }
}
