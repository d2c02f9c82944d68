//! Field: the magnetic pull of a motor on its rotor.

use crate::math::sin;
use crate::params::Params;

/// Field and rotor of a motor, at the belt.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Field {
    /// Its maximum force, in N.
    pub(super) holding_n: f64,
    /// The detent's, in N.
    pub(super) detent_n: f64,
    /// Belt in mm per electrical radian.
    pub(super) radian_mm: f64,
    /// Its stiffness at rest, in N/mm.
    pub(super) stiffness: f64,
    /// Viscous friction of its rotor, in N s/mm.
    pub(super) damping: f64,
}

impl Field {
    /// That of a motor, by its place among the machine's motors.
    pub(super) fn of(params: &Params, motor: usize) -> Self {
        Self {
            holding_n: params.holding_force_n(motor),
            detent_n: params.detent_force_n(motor),
            radian_mm: params.electrical_radian_mm(motor),
            stiffness: params.field_stiffness_n_per_mm(motor),
            damping: params.rotor_damping_n_s_per_mm(motor),
        }
    }

    /// Force of a full-strength field on a rotor, in N at the belt.
    pub(super) fn holding_n(&self, at_mm: f64, sent_mm: f64) -> f64 {
        self.holding_n * sin((sent_mm - at_mm) / self.radian_mm)
    }

    /// Detent force on a rotor at this distance from a detent position, in N at the belt.
    pub(super) fn detent_n(&self, off_mm: f64) -> f64 {
        if self.detent_n == 0.0 {
            return 0.0;
        }
        // Four detents an electrical turn: one a full step.
        -self.detent_n * sin(4.0 * off_mm / self.radian_mm)
    }
}
