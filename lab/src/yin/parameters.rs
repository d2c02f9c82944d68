//! The rig's numbers: belt, masses and friction, in SI units.
//!
//! The values of the paper's Table I are not available. `NOMINAL` is assumed. It has the values in the text (MXL
//! pulleys and belt, E = 160 MPa, steppers of 1.8 degrees) and sizes of such a rig. Its friction gives corner errors
//! with the reported trends. A file (`examples/twin/yin.toml`) may have other values, under the paper's names.

use super::error::Error;
use serde::{Deserialize, Serialize};

/// A CoreXY as in figure 1 of the paper, in SI units (m, kg, s, N).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Parameters {
    /// Stiffness of the belt sections k1 to k5, N/m. Each is used on both sides of the machine.
    #[serde(rename = "k_N_per_m")]
    pub stiffness: [f64; 5],
    /// Radius of all pulleys, m.
    #[serde(rename = "r_m")]
    pub pulley_radius: f64,
    /// End-effector with its part of the belt, kg: m_x.
    #[serde(rename = "m_x_kg")]
    pub effector_mass: f64,
    /// The y-frame without end-effector and pulleys, kg: m_y.
    #[serde(rename = "m_y_kg")]
    pub frame_mass: f64,
    /// One pulley, kg: m_p. Four of them ride on the y-frame.
    #[serde(rename = "m_p_kg")]
    pub pulley_mass: f64,
    /// One pulley about its axis, kg m2: J_p.
    #[serde(rename = "J_p_kg_m2")]
    pub pulley_inertia: f64,
    /// Viscous friction of end-effector and y-frame on their guides, N s/m: b1, b2.
    #[serde(rename = "b_N_s_per_m")]
    pub guide_viscous: [f64; 2],
    /// Coulomb friction of end-effector and y-frame on their guides, N: f1, f2.
    #[serde(rename = "f_N")]
    pub guide_coulomb: [f64; 2],
    /// Viscous friction of one pulley, N m s: B_p.
    #[serde(rename = "B_p_N_m_s")]
    pub pulley_viscous: f64,
    /// Coulomb friction of one pulley, N m: tau_f.
    #[serde(rename = "tau_f_N_m")]
    pub pulley_coulomb: f64,
    /// The motors of a rig with DC motors.
    pub motor: DcMotor,
}

/// The assumed rig.
impl Default for Parameters {
    fn default() -> Parameters {
        NOMINAL
    }
}

/// A DC motor on each driving pulley: tau = K1 V - K2 phi' (equation 7).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DcMotor {
    /// K1, N m/V.
    #[serde(rename = "K_1_N_m_per_V")]
    pub torque_per_volt: f64,
    /// K2, N m s.
    #[serde(rename = "K_2_N_m_s")]
    pub back_torque: f64,
    /// Its rotor, kg m2: what the J_p of pulleys 1 and 2 has more than the others'.
    #[serde(rename = "rotor_kg_m2")]
    pub rotor_inertia: f64,
}

/// The assumed motor.
impl Default for DcMotor {
    fn default() -> DcMotor {
        NOMINAL.motor
    }
}

/// Young's modulus of the belt from the paper, 160 MPa (section III), times an assumed section of 5 mm2: N.
const BELT_EA: f64 = 160e6 * 5e-6;

/// Belt travel of a motor per pulse, m: 16 teeth of 2.032 mm (MXL) and 400 half steps a revolution are 0.0813 mm. The
/// figures in the tests were computed with 0.0812.
pub(super) const PULSE: f64 = 0.0812e-3;

/// The assumed rig (see the head of this file).
pub const NOMINAL: Parameters = Parameters {
    // EA / l with sections of 0.10, 0.12, 0.26, 0.24 and 0.12 m, assumed.
    stiffness: [BELT_EA / 0.10, BELT_EA / 0.12, BELT_EA / 0.26, BELT_EA / 0.24, BELT_EA / 0.12],
    // 16 teeth of 2.032 mm have a circumference of 32.5 mm.
    pulley_radius: 5.174e-3,
    effector_mass: 0.08,
    frame_mass: 0.10,
    pulley_mass: 0.005,
    pulley_inertia: 1.0e-7,
    guide_viscous: [110.0, 75.0],
    guide_coulomb: [0.4, 0.3],
    pulley_viscous: 2.7e-4,
    pulley_coulomb: 4e-4,
    // A brushed motor of 0.05 N m/A and 2.5 ohm, assumed: K1 = k/R, K2 = k^2/R.
    motor: DcMotor { torque_per_volt: 0.02, back_torque: 1e-3, rotor_inertia: 2e-6 },
};

impl Parameters {
    /// The same rig with all friction times `friction`, and so on, as section III B of the paper varies its parameters.
    #[must_use]
    pub fn scaled(&self, friction: f64, stiffness: f64, mass: f64) -> Parameters {
        Parameters {
            stiffness: self.stiffness.map(|k| k * stiffness),
            pulley_radius: self.pulley_radius,
            effector_mass: self.effector_mass * mass,
            frame_mass: self.frame_mass * mass,
            pulley_mass: self.pulley_mass * mass,
            pulley_inertia: self.pulley_inertia * mass,
            guide_viscous: self.guide_viscous.map(|b| b * friction),
            guide_coulomb: self.guide_coulomb.map(|f| f * friction),
            pulley_viscous: self.pulley_viscous * friction,
            pulley_coulomb: self.pulley_coulomb * friction,
            motor: DcMotor { rotor_inertia: self.motor.rotor_inertia * mass, ..self.motor },
        }
    }

    /// Mass that moves along y, kg: M of equation 4 (with m_x for its m_1).
    #[must_use]
    pub fn moving_mass_y(&self) -> f64 {
        self.frame_mass + self.effector_mass + 4.0 * self.pulley_mass
    }

    /// Refuses an impossible rig: springs and masses must be positive, friction must not be negative.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the wrong value.
    pub fn check(&self) -> Result<(), Error> {
        let masses = [self.effector_mass, self.frame_mass, self.pulley_mass, self.pulley_inertia];
        let pulleys = [self.pulley_viscous, self.pulley_coulomb];
        let friction = [self.guide_viscous, self.guide_coulomb, pulleys];
        let motor = [self.motor.back_torque, self.motor.rotor_inertia];
        let is_positive = |v: &f64| v.is_finite() && *v > 0.0;
        let is_friction = |v: &f64| v.is_finite() && *v >= 0.0;
        let checks = [
            ("stiffness", self.stiffness.iter().all(is_positive)),
            ("pulley radius", is_positive(&self.pulley_radius)),
            ("mass", masses.iter().all(is_positive)),
            ("friction", friction.as_flattened().iter().all(is_friction)),
            ("DC motor", is_positive(&self.motor.torque_per_volt) && motor.iter().all(is_friction)),
        ];
        match checks.into_iter().find(|(_, is_legal)| !is_legal) {
            Some((what, _)) => Err(Error::Parameter(what)),
            None => Ok(()),
        }
    }
}
