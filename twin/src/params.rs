//! The machine in numbers: dimensions, masses and stiffnesses, each with its source.
//!
//! \[H\] is the paper that introduced the CoreH-bot (Machines, 2022). Values without it are marked *assumed*: the
//! prototype's masses, guides, friction and damping are not published. Frequencies are proportional to the root of
//! stiffness over mass.

use serde::{Deserialize, Serialize};

/// All parameters of a machine. The default is the prototype as far as it is known; the rest is assumed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Params {
    /// Width W between the axes of motors 1 and 4. \[H\] table 2: 470.
    pub width_mm: f64,
    /// Depth D between the axes of motors 1 and 11. \[H\] table 2: 470.
    pub depth_mm: f64,
    /// Radius r of the belt's pitch line on every pulley. \[H\] table 2: 6.35. (20 teeth of 2 mm have 6.366.)
    pub pulley_radius_mm: f64,
    /// Distance d of the bar's front and back pulleys. \[H\] table 2: 52.4.
    pub bar_pulleys_mm: f64,
    /// Distance e of the head's pulleys, or of the belt's clamps on it. \[H\] table 2: 80.
    pub head_pulleys_mm: f64,
    /// Tensile stiffness of the belt (modulus times section), N per unit of strain. Assumed: 30,000 for 9 mm of GT2
    /// with glass cords. One published pull of 169 N on 500 mm gave 29,100, and steel cords give 56,000. Credible:
    /// 20,000 to 56,000.
    #[serde(rename = "belt_EA_N")]
    pub belt_ea_n: f64,
    /// Tension at rest. Assumed: 40, from Gates' 6 to 8 lbf for 6 mm of GT2, scaled to 9 mm.
    #[serde(rename = "preload_N")]
    pub preload_n: f64,
    /// Mass of a metre of belt, used only for plucked parts. Assumed: 0.0125 for 9 mm of GT2, from 8.3 g/m for 6 mm (a
    /// tension table by Benchtop Machine Shop).
    pub belt_kg_per_m: f64,
    /// Damping of the belt over its stiffness, in s. Assumed: 2e-4, which damps y by 4 % and x by 7 % at the centre.
    pub belt_damping_s: f64,
    /// Mass that moves in x. Assumed: 0.60.
    pub head_mass_kg: f64,
    /// Mass that moves in y besides the head: bar, carriages and eight pulleys. Assumed: 1.20.
    pub bar_mass_kg: f64,
    /// Inertia of an idler. Assumed: 2.5e-7.
    pub idler_inertia_kg_m2: f64,
    /// Inertia of a motor's rotor with its pulley. Assumed: 5.4e-6, a NEMA 17 of 40 mm.
    pub rotor_inertia_kg_m2: f64,
    /// Holding torque of a motor at its run current. Assumed: 0.40, a NEMA 17 of 40 mm.
    #[serde(rename = "holding_torque_Nm")]
    pub holding_torque_nm: f64,
    /// Run current of a motor, RMS of a phase, that gives the holding torque. Assumed: 1.2, with resistance and
    /// inductance of a NEMA 17 of 40 mm with 0.40 N m (KeliMotor BJ42D22-25V04, as listed by
    /// TheDevMinerTV/stepper-simulator).
    #[serde(rename = "run_current_A")]
    pub run_current_a: f64,
    /// Resistance of a phase. Assumed: 2.9, with the current.
    pub phase_resistance_ohm: f64,
    /// Inductance of a phase. Assumed: 6.0, with the current.
    #[serde(rename = "phase_inductance_mH")]
    pub phase_inductance_mh: f64,
    /// Supply of the motor drivers. Assumed: 24. Two motors in series, as \[H\] had them, have half of it each.
    #[serde(rename = "supply_V")]
    pub supply_v: f64,
    /// Pole pairs of a motor: 50 for steps of 1.8 degrees, \[H\] section 4.
    pub pole_pairs: f64,
    /// Detent torque of a motor. Assumed: 0, which leaves it out; the data sheet of a small motor (42BYG228, by Mosaic
    /// Industries) gives up to 0.022.
    #[serde(rename = "detent_torque_Nm")]
    pub detent_torque_nm: f64,
    /// Viscous friction of a rotor, N m per rad/s. Assumed: 2e-4, drag of bearings and eddy currents.
    #[serde(rename = "rotor_damping_Nm_s")]
    pub rotor_damping_nm_s: f64,
    /// Viscous friction of the guide in x. Assumed: 2.
    #[serde(rename = "guide_x_N_s_per_m")]
    pub guide_x_n_s_per_m: f64,
    /// Viscous friction of the guides in y. Assumed: 4.
    #[serde(rename = "guide_y_N_s_per_m")]
    pub guide_y_n_s_per_m: f64,
    /// Dry friction of the guide in x. Assumed: 0.5.
    #[serde(rename = "dry_friction_x_N")]
    pub dry_friction_x_n: f64,
    /// Dry friction of the guides in y. Assumed: 1.0.
    #[serde(rename = "dry_friction_y_N")]
    pub dry_friction_y_n: f64,
    /// Stiffness with which the guides hold the bar square. Assumed: 2,000.
    #[serde(rename = "bar_yaw_stiffness_Nm_per_rad")]
    pub bar_yaw_stiffness_nm_per_rad: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            width_mm: 470.0,
            depth_mm: 470.0,
            pulley_radius_mm: 6.35,
            bar_pulleys_mm: 52.4,
            head_pulleys_mm: 80.0,
            belt_ea_n: 30_000.0,
            preload_n: 40.0,
            belt_kg_per_m: 0.0125,
            belt_damping_s: 2e-4,
            head_mass_kg: 0.60,
            bar_mass_kg: 1.20,
            idler_inertia_kg_m2: 2.5e-7,
            rotor_inertia_kg_m2: 5.4e-6,
            holding_torque_nm: 0.40,
            run_current_a: 1.2,
            phase_resistance_ohm: 2.9,
            phase_inductance_mh: 6.0,
            supply_v: 24.0,
            pole_pairs: 50.0,
            detent_torque_nm: 0.0,
            rotor_damping_nm_s: 2e-4,
            guide_x_n_s_per_m: 2.0,
            guide_y_n_s_per_m: 4.0,
            dry_friction_x_n: 0.5,
            dry_friction_y_n: 1.0,
            bar_yaw_stiffness_nm_per_rad: 2000.0,
        }
    }
}

/// Millimetres in a metre.
const MM_PER_M: f64 = 1000.0;

impl Params {
    /// The same without any loss of energy.
    #[must_use]
    pub fn undamped(self) -> Self {
        Self {
            belt_damping_s: 0.0,
            rotor_damping_nm_s: 0.0,
            guide_x_n_s_per_m: 0.0,
            guide_y_n_s_per_m: 0.0,
            dry_friction_x_n: 0.0,
            dry_friction_y_n: 0.0,
            ..self
        }
    }

    /// Equivalent mass of an idler at the belt: its inertia over the square of its radius, in kg.
    #[must_use]
    pub fn idler_mass_kg(&self) -> f64 {
        self.idler_inertia_kg_m2 * (MM_PER_M / self.pulley_radius_mm).powi(2)
    }

    /// Equivalent mass of a rotor at the belt, in kg.
    #[must_use]
    pub fn rotor_mass_kg(&self) -> f64 {
        self.rotor_inertia_kg_m2 * (MM_PER_M / self.pulley_radius_mm).powi(2)
    }

    /// Maximum force of a motor's field at the belt, in N.
    #[must_use]
    pub fn holding_force_n(&self) -> f64 {
        self.holding_torque_nm * MM_PER_M / self.pulley_radius_mm
    }

    /// Maximum force of the detent at the belt, in N.
    #[must_use]
    pub fn detent_force_n(&self) -> f64 {
        self.detent_torque_nm * MM_PER_M / self.pulley_radius_mm
    }

    /// Belt in mm per electrical radian of a motor.
    #[must_use]
    pub fn electrical_radian_mm(&self) -> f64 {
        self.pulley_radius_mm / self.pole_pairs
    }

    /// Stiffness of a motor's field at the belt about its rest position, in N/mm: the slope of a sine.
    #[must_use]
    pub fn field_stiffness_n_per_mm(&self) -> f64 {
        self.holding_force_n() / self.electrical_radian_mm()
    }

    /// Viscous friction of a rotor at the belt, in N s/mm.
    #[must_use]
    pub fn rotor_damping_n_s_per_mm(&self) -> f64 {
        self.rotor_damping_nm_s * MM_PER_M / self.pulley_radius_mm.powi(2)
    }

    /// Belt in mm per full step of a motor: a quarter of an electrical turn.
    #[must_use]
    pub fn full_step_mm(&self) -> f64 {
        std::f64::consts::FRAC_PI_2 * self.electrical_radian_mm()
    }

    /// Whether these parameters are possible.
    ///
    /// # Errors
    /// The first impossible parameter, by its key.
    pub fn check(&self) -> Result<(), ParamsError> {
        let positive = [
            ("width_mm", self.width_mm),
            ("depth_mm", self.depth_mm),
            ("pulley_radius_mm", self.pulley_radius_mm),
            ("belt_EA_N", self.belt_ea_n),
            ("head_mass_kg", self.head_mass_kg),
            ("idler_inertia_kg_m2", self.idler_inertia_kg_m2),
            ("rotor_inertia_kg_m2", self.rotor_inertia_kg_m2),
            ("holding_torque_Nm", self.holding_torque_nm),
            ("run_current_A", self.run_current_a),
            ("phase_resistance_ohm", self.phase_resistance_ohm),
            ("phase_inductance_mH", self.phase_inductance_mh),
            ("supply_V", self.supply_v),
            ("pole_pairs", self.pole_pairs),
        ];
        let not_negative = [
            ("bar_pulleys_mm", self.bar_pulleys_mm),
            ("head_pulleys_mm", self.head_pulleys_mm),
            ("preload_N", self.preload_n),
            ("belt_damping_s", self.belt_damping_s),
            ("bar_mass_kg", self.bar_mass_kg),
            ("detent_torque_Nm", self.detent_torque_nm),
            ("rotor_damping_Nm_s", self.rotor_damping_nm_s),
            ("guide_x_N_s_per_m", self.guide_x_n_s_per_m),
            ("guide_y_N_s_per_m", self.guide_y_n_s_per_m),
            ("dry_friction_x_N", self.dry_friction_x_n),
            ("dry_friction_y_N", self.dry_friction_y_n),
            ("bar_yaw_stiffness_Nm_per_rad", self.bar_yaw_stiffness_nm_per_rad),
        ];
        // Written so that NaN fails too.
        let bad = positive.into_iter().find(|(_, v)| !(v.is_finite() && *v > 0.0));
        if let Some((key, value)) = bad {
            return Err(ParamsError { key, value, wanted: "must be above 0" });
        }
        let bad = not_negative.into_iter().find(|(_, v)| !(v.is_finite() && *v >= 0.0));
        bad.map_or(Ok(()), |(key, value)| Err(ParamsError { key, value, wanted: "must not be below 0" }))
    }
}

/// An impossible parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamsError {
    /// Its key.
    pub key: &'static str,
    /// The given value.
    pub value: f64,
    /// The legal values.
    pub wanted: &'static str,
}

impl std::fmt::Display for ParamsError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} = {} {}", self.key, self.value, self.wanted)
    }
}

impl std::error::Error for ParamsError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nominal_machine_is_one_and_no_number_may_be_missing() {
        assert_eq!(Params::default().check(), Ok(()));
        let bad = Params { belt_ea_n: f64::NAN, ..Params::default() }.check().unwrap_err();
        assert_eq!(bad.key, "belt_EA_N");
        assert!(Params { preload_n: -1.0, ..Params::default() }.check().is_err());
    }

    #[test]
    fn a_motor_of_0_4_nm_is_a_spring_of_496_n_per_mm_at_the_belt() {
        let params = Params::default();
        assert!((params.field_stiffness_n_per_mm() - 496.0).abs() < 0.05);
        assert!((4.0 * params.full_step_mm() - 0.797_97).abs() < 1e-5);
    }
}
