//! Frame: a soft frame on the ground, which moves along x and y with all that it carries.
//!
//! The tool's coordinates count from the frame. With the force F on a coordinate, its mass m, the frame's place f and
//! the mass M of the frame and all on it:
//!
//! ```text
//! m x'' + m f'' = F,   m x'' + M f'' = G,   so   f'' = (G - F) / (M - m)   and   x'' = F / m - f''
//! ```
//!
//! G is the force of the ground's spring and damper, and of a push on the tool, which F includes too.

use crate::params::Params;
use crate::routing::Machine;

/// N over kg in mm/s^2.
pub(super) const MM_PER_M: f64 = 1000.0;

/// The frame along an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameAxis {
    /// Stiffness of the ground's hold, in N/mm.
    pub stiffness: f64,
    /// Its damping, in N s/mm.
    damping: f64,
    /// mm/s^2 per newton of G - F.
    pub mobility: f64,
}

/// The frame along x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame(pub [FrameAxis; 2]);

impl Frame {
    /// The frame of these numbers, if it is soft.
    pub(super) fn new(machine: Machine, params: &Params) -> Option<Self> {
        let stiffness = params.frame_stiffness_n_per_mm.get(0).map(|_| params.frame_stiffness_n_per_mm)?;
        let all_kg = params.frame_mass_kg + machine.carried_kg(params);
        let [x_kg, y_kg, _] = machine.masses_kg(params);
        let axis = |(index, kg): (usize, f64)| FrameAxis {
            stiffness: stiffness.of(index),
            damping: params.frame_damping_n_s_per_mm(index, all_kg),
            mobility: MM_PER_M / (all_kg - kg),
        };
        Some(Self([(0, x_kg), (1, y_kg)].map(axis)))
    }

    /// Its accelerations, from its places and speeds, the forces on the tool, and the push among these.
    pub(super) fn accelerations(&self, at: &[f64], speeds: &[f64], forces: &[f64], push_n: [f64; 2]) -> [f64; 2] {
        let of = |all: &[f64], axis: usize| all.get(axis).copied().unwrap_or(0.0);
        let axis = |axis: usize, frame: &FrameAxis, push: f64| {
            let ground = -frame.stiffness * of(at, axis) - frame.damping * of(speeds, axis);
            (ground + push - of(forces, axis)) * frame.mobility
        };
        let ([x, y], [push_x, push_y]) = (&self.0, push_n);
        [axis(0, x, push_x), axis(1, y, push_y)]
    }
}
