//! The machine in numbers: dimensions, masses and stiffnesses.
//!
//! [`ROWS`] has a row for each: key, nominal value, meaning and source. A machine file has them in its table
//! `[twin]`. Frequencies are proportional to the root of stiffness over mass.

mod per_part;
mod row;
mod rows;
mod serial;
mod unit;

pub use per_part::{Each, MOST_PARTS};
pub use row::{Field, Parts, Range, Row};
pub use rows::ROWS;
pub use unit::split_unit;

use crate::math::square;

/// All numbers of a machine. The default is the prototype as far as it is known; the rest is assumed.
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Width W between the axes of motors 1 and 4.
    pub width_mm: f64,
    /// Depth D between the axes of motors 1 and 11.
    pub depth_mm: f64,
    /// Height over which belts lift the tool, on a machine where belts do.
    pub height_mm: f64,
    /// Radius r of the belt's pitch line on every pulley.
    pub pulley_radius_mm: f64,
    /// The same on each motor, in the order of the motors' numbers, where pulleys differ (\[H\] equation 8); the belt's
    /// lines stay as they are.
    pub motor_radius_mm: Each,
    /// Distance d of the bar's front and back pulleys.
    pub bar_pulleys_mm: f64,
    /// Distance e of the head's pulleys, or of the belt's clamps on it.
    pub head_pulleys_mm: f64,
    /// Free belt of each span outside the rectangle of W and D, in the order of the spans of `corehbot twin geometry`.
    pub outside_mm: Each,
    /// Tensile stiffness of each belt (modulus times section), N per unit of strain.
    pub belt_ea_n: Each,
    /// Tension of each belt at rest.
    pub preload_n: Each,
    /// Mass of a metre of each belt, used for plucked parts.
    pub belt_kg_per_m: Each,
    /// Damping of the belt over its stiffness.
    pub belt_damping_s: f64,
    /// Mass of the head, which moves in x.
    pub head_mass_kg: f64,
    /// Mass of the bar that carries the head, with carriages and pulleys.
    pub bar_mass_kg: f64,
    /// Mass of the gantry that carries the bar, where belts lift all three.
    pub gantry_mass_kg: f64,
    /// Mass of the bed, where a belt moves the bed in y.
    pub bed_mass_kg: f64,
    /// Inertia of the bar about its middle, without the head.
    pub bar_yaw_inertia_kg_m2: Option<f64>,
    /// Stiffness with which the guides hold the bar square.
    pub bar_yaw_stiffness_nm_per_rad: f64,
    /// Stiffness with which the guides in z hold the gantry level, where belts lift it.
    pub gantry_tilt_stiffness_nm_per_rad: f64,
    /// Mass of the frame, where it has a stiffness.
    pub frame_mass_kg: f64,
    /// Stiffness with which the ground holds the frame in x and in y; none if the frame is rigid.
    pub frame_stiffness_n_per_mm: Each,
    /// Damping ratio of the frame on the ground, with all that it carries.
    pub frame_damping_ratio: f64,
    /// Inertia of an idler.
    pub idler_inertia_kg_m2: f64,
    /// Inertia of a motor's rotor with its pulley.
    pub rotor_inertia_kg_m2: f64,
    /// Holding torque of a motor at its run current.
    pub holding_torque_nm: f64,
    /// Run current of a motor, RMS of a phase, that gives the holding torque.
    pub run_current_a: f64,
    /// Resistance of a phase.
    pub phase_resistance_ohm: f64,
    /// Inductance of a phase.
    pub phase_inductance_mh: f64,
    /// Supply of the motor drivers.
    pub supply_v: f64,
    /// Motors in series on a driver of the belts, which share its supply.
    pub motors_in_series: f64,
    /// Pole pairs of a motor: 50 for steps of 1.8 degrees.
    pub pole_pairs: f64,
    /// Detent torque of a motor; 0 leaves it out, and without it only [`crate::ripple`] assumes one.
    pub detent_torque_nm: Option<f64>,
    /// Amplitude of the error of a motor's field once a full step, in percent of a full step.
    pub full_step_error_percent: f64,
    /// The same twice an electrical turn.
    pub half_turn_error_percent: f64,
    /// The same once an electrical turn.
    pub electrical_turn_error_percent: f64,
    /// Amplitude of the error of belt and pulley from tooth to tooth.
    pub tooth_error_um: f64,
    /// Distance of a pulley's circle from its axis.
    pub pulley_eccentricity_um: f64,
    /// Viscous friction of a rotor.
    pub rotor_damping_nm_s: f64,
    /// Viscous friction of the guide in x.
    pub guide_x_n_s_per_m: f64,
    /// Viscous friction of the guides in y.
    pub guide_y_n_s_per_m: f64,
    /// Viscous friction of the guides in z, where belts lift the tool.
    pub guide_z_n_s_per_m: f64,
    /// Dry friction of the guide in x.
    pub dry_friction_x_n: f64,
    /// Dry friction of the guides in y.
    pub dry_friction_y_n: f64,
    /// Dry friction of the guides in z, where belts lift the tool.
    pub dry_friction_z_n: f64,
}

/// No number yet: the rows give them all.
const EMPTY: Params = Params {
    width_mm: 0.0,
    depth_mm: 0.0,
    height_mm: 0.0,
    pulley_radius_mm: 0.0,
    motor_radius_mm: Each::NONE,
    bar_pulleys_mm: 0.0,
    head_pulleys_mm: 0.0,
    outside_mm: Each::NONE,
    belt_ea_n: Each::NONE,
    preload_n: Each::NONE,
    belt_kg_per_m: Each::NONE,
    belt_damping_s: 0.0,
    head_mass_kg: 0.0,
    bar_mass_kg: 0.0,
    gantry_mass_kg: 0.0,
    bed_mass_kg: 0.0,
    bar_yaw_inertia_kg_m2: None,
    bar_yaw_stiffness_nm_per_rad: 0.0,
    gantry_tilt_stiffness_nm_per_rad: 0.0,
    frame_mass_kg: 0.0,
    frame_stiffness_n_per_mm: Each::NONE,
    frame_damping_ratio: 0.0,
    idler_inertia_kg_m2: 0.0,
    rotor_inertia_kg_m2: 0.0,
    holding_torque_nm: 0.0,
    run_current_a: 0.0,
    phase_resistance_ohm: 0.0,
    phase_inductance_mh: 0.0,
    supply_v: 0.0,
    motors_in_series: 0.0,
    pole_pairs: 0.0,
    detent_torque_nm: None,
    full_step_error_percent: 0.0,
    half_turn_error_percent: 0.0,
    electrical_turn_error_percent: 0.0,
    tooth_error_um: 0.0,
    pulley_eccentricity_um: 0.0,
    rotor_damping_nm_s: 0.0,
    guide_x_n_s_per_m: 0.0,
    guide_y_n_s_per_m: 0.0,
    guide_z_n_s_per_m: 0.0,
    dry_friction_x_n: 0.0,
    dry_friction_y_n: 0.0,
    dry_friction_z_n: 0.0,
};

impl Default for Params {
    fn default() -> Self {
        let mut params = EMPTY;
        for row in &ROWS {
            (row.field)(&mut params).set(row.default.map_or(Each::NONE, Each::all));
        }
        params
    }
}

/// Pitch of the belt's teeth: GT2, \[H\] table 2.
pub const TOOTH_MM: f64 = 2.0;

/// Millimetres in a metre.
const MM_PER_M: f64 = 1000.0;

impl Params {
    /// The same without any loss of energy.
    #[must_use]
    pub fn undamped(self) -> Self {
        Self {
            belt_damping_s: 0.0,
            frame_damping_ratio: 0.0,
            rotor_damping_nm_s: 0.0,
            guide_x_n_s_per_m: 0.0,
            guide_y_n_s_per_m: 0.0,
            guide_z_n_s_per_m: 0.0,
            dry_friction_x_n: 0.0,
            dry_friction_y_n: 0.0,
            dry_friction_z_n: 0.0,
            ..self
        }
    }

    /// Equivalent mass of an idler at the belt: its inertia over the square of its radius, in kg.
    #[must_use]
    pub fn idler_mass_kg(&self) -> f64 {
        self.idler_inertia_kg_m2 * square(MM_PER_M / self.pulley_radius_mm)
    }

    /// Radius of the belt's pitch line on a motor, by its place in the order of the motors' numbers, as in all that
    /// follows.
    #[must_use]
    pub fn radius_mm(&self, motor: usize) -> f64 {
        self.motor_radius_mm.get(motor).unwrap_or(self.pulley_radius_mm)
    }

    /// Equivalent mass of a rotor at the belt, in kg.
    #[must_use]
    pub fn rotor_mass_kg(&self, motor: usize) -> f64 {
        self.rotor_inertia_kg_m2 * square(MM_PER_M / self.radius_mm(motor))
    }

    /// Maximum force of a motor's field at the belt, in N.
    #[must_use]
    pub fn holding_force_n(&self, motor: usize) -> f64 {
        self.holding_torque_nm * MM_PER_M / self.radius_mm(motor)
    }

    /// Maximum force of the detent at the belt, in N.
    #[must_use]
    pub fn detent_force_n(&self, motor: usize) -> f64 {
        self.detent_torque_nm.unwrap_or(0.0) * MM_PER_M / self.radius_mm(motor)
    }

    /// Belt in mm per electrical radian of a motor.
    #[must_use]
    pub fn electrical_radian_mm(&self, motor: usize) -> f64 {
        self.radius_mm(motor) / self.pole_pairs
    }

    /// Stiffness of a motor's field at the belt about its rest position, in N/mm: the slope of a sine.
    #[must_use]
    pub fn field_stiffness_n_per_mm(&self, motor: usize) -> f64 {
        self.holding_force_n(motor) / self.electrical_radian_mm(motor)
    }

    /// Viscous friction of a rotor at the belt, in N s/mm.
    #[must_use]
    pub fn rotor_damping_n_s_per_mm(&self, motor: usize) -> f64 {
        self.rotor_damping_nm_s * MM_PER_M / square(self.radius_mm(motor))
    }

    /// Damping of the frame along x (0) or y (1), in N s/mm, with this mass of the frame and all on it.
    #[must_use]
    pub fn frame_damping_n_s_per_mm(&self, axis: usize, kg: f64) -> f64 {
        // 2 z (k m)^(1/2); a kg is N s^2/mm through 1000.
        2.0 * self.frame_damping_ratio * (self.frame_stiffness_n_per_mm.of(axis) * kg / MM_PER_M).sqrt()
    }

    /// Belt in mm per full step of a motor: a quarter of an electrical turn.
    #[must_use]
    pub fn full_step_mm(&self, motor: usize) -> f64 {
        std::f64::consts::FRAC_PI_2 * self.electrical_radian_mm(motor)
    }

    /// Viscous (N s/m) and dry friction (N) of the guides in x, y and z.
    #[must_use]
    pub const fn guides(&self) -> [(f64, f64); 3] {
        [
            (self.guide_x_n_s_per_m, self.dry_friction_x_n),
            (self.guide_y_n_s_per_m, self.dry_friction_y_n),
            (self.guide_z_n_s_per_m, self.dry_friction_z_n),
        ]
    }

    /// Inertia of the bar about its middle, in kg mm^2.
    #[must_use]
    pub fn bar_yaw_inertia_kg_mm2(&self) -> f64 {
        let given = self.bar_yaw_inertia_kg_m2.map(|inertia| inertia * MM_PER_M * MM_PER_M);
        given.unwrap_or_else(|| self.bar_mass_kg * square(self.width_mm) / 12.0)
    }

    /// Whether these parameters are possible.
    ///
    /// # Errors
    /// The first impossible parameter, by its key.
    pub fn check(&self) -> Result<(), ParamsError> {
        for row in &ROWS {
            // Written so that NaN fails too.
            if let Some(value) = row.values(self).values().iter().find(|value| !row.allows(**value)) {
                return Err(ParamsError { key: row.key, value: *value, wanted: row.wanted(*value) });
            }
        }
        Ok(())
    }
}

/// An impossible parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamsError {
    /// Its key.
    pub key: &'static str,
    /// The given value.
    pub value: f64,
    /// What it must be.
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
        let bad = Params { belt_ea_n: f64::NAN.into(), ..Params::default() }.check().unwrap_err();
        assert_eq!(bad.key, "belt_EA_N");
        assert!(Params { preload_n: Each::all(-1.0), ..Params::default() }.check().is_err());
    }

    /// Reproducer: half a pole pair was one.
    #[test]
    fn motors_in_series_and_pole_pairs_are_whole() {
        for key in ["motors_in_series", "pole_pairs"] {
            let row = Row::of(key).unwrap();
            let checked = |value: f64| {
                let mut params = Params::default();
                (row.field)(&mut params).set(Each::all(value));
                params.check()
            };
            for legal in [1.0, 2.0, 100.0] {
                assert_eq!(checked(legal), Ok(()), "{key} = {legal}");
            }
            for bad in [0.0, 0.5, 1.5, 50.000_001, -1.0, 1_000_001.0, f64::INFINITY] {
                assert_eq!(checked(bad).unwrap_err().key, key, "{bad}");
            }
        }
    }

    #[test]
    fn every_number_has_one_row_and_is_read_back() {
        let keys: std::collections::BTreeSet<_> = ROWS.iter().map(|row| row.key).collect();
        assert_eq!(keys.len(), ROWS.len());
        for (index, row) in ROWS.iter().enumerate() {
            let mut params = Params::default();
            (row.field)(&mut params).set(Each::all(7.0 + index as f64));
            assert_eq!(row.values(&params), Each::all(7.0 + index as f64), "{}", row.key);
            // No other row has this place.
            let changed = ROWS.iter().filter(|other| other.values(&params) != other.values(&Params::default()));
            assert_eq!(changed.count(), 1, "{}", row.key);
        }
    }

    #[test]
    fn a_list_has_a_number_for_each_part_and_a_number_is_for_all() {
        let two = Each::listed(&[30_000.0, 45_000.0]).unwrap();
        assert_eq!([0, 1, 2].map(|belt| two.of(belt)), [30_000.0, 45_000.0, 45_000.0]);
        assert_eq!(two.with_first(20_000.0), Each::listed(&[20_000.0, 30_000.0]).unwrap());
        assert_eq!([0, 5].map(|belt| Each::all(2.0).of(belt)), [2.0, 2.0]);
        assert_eq!(Each::all(2.0).with_part(1, 3.0, 3), Each::listed(&[2.0, 3.0, 2.0]).unwrap());
        assert_eq!(Each::all(2.0).with_part(0, 3.0, 1), Each::all(3.0));
        let params = Params { motor_radius_mm: Each::listed(&[6.35, 5.08]).unwrap(), ..Params::default() };
        assert!((params.holding_force_n(1) / params.holding_force_n(0) - 1.25).abs() < 1e-12);
    }

    #[test]
    fn a_motor_of_0_4_nm_is_a_spring_of_496_n_per_mm_at_the_belt() {
        let params = Params::default();
        assert!((params.field_stiffness_n_per_mm(0) - 496.0).abs() < 0.05);
        assert!((4.0 * params.full_step_mm(0) - 0.797_97).abs() < 1e-5);
    }
}
