//! Parameter: a number of the machine that measurements may determine.
//!
//! An [`Unknown`] is a parameter of one part: each belt has a stiffness and a tension of its own. Before any
//! measurement a number is its nominal one within a factor; [`Unknown::expected`] says of which factor, and which
//! numbers go together.

use crate::params::{Each, Params, Row};
use crate::routing::Machine;
use serde::{Deserialize, Serialize};

/// A fitted parameter, by its key in the table `[twin]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Parameter {
    /// Tensile stiffness of a belt.
    #[serde(rename = "belt_EA_N")]
    BeltStiffness,
    /// Tension of a belt at rest.
    #[serde(rename = "preload_N")]
    Preload,
    /// Mass of a metre of belt.
    #[serde(rename = "belt_kg_per_m")]
    BeltMass,
    /// Mass that moves in x.
    #[serde(rename = "head_mass_kg")]
    HeadMass,
    /// Mass that moves in y besides the head.
    #[serde(rename = "bar_mass_kg")]
    BarMass,
    /// Holding torque of a motor.
    #[serde(rename = "holding_torque_Nm")]
    HoldingTorque,
    /// Mass of the gantry, where belts lift it.
    #[serde(rename = "gantry_mass_kg")]
    GantryMass,
    /// Mass of a bed that moves in y.
    #[serde(rename = "bed_mass_kg")]
    BedMass,
    /// Inertia of the bar about its middle.
    #[serde(rename = "bar_yaw_inertia_kg_m2")]
    YawInertia,
    /// Stiffness with which the guides hold the bar square.
    #[serde(rename = "bar_yaw_stiffness_Nm_per_rad")]
    YawStiffness,
    /// Damping of the belts.
    #[serde(rename = "belt_damping_s")]
    BeltDamping,
    /// Viscous friction in x.
    #[serde(rename = "guide_x_N_s_per_m")]
    GuideX,
    /// Viscous friction in y.
    #[serde(rename = "guide_y_N_s_per_m")]
    GuideY,
}

/// A nominal value is right within a factor of two, in one standard uncertainty. Assumed: belts of 20 to 56 kN are
/// sold. A NEMA 17 holds 0.2 to 0.6 N m, by its length and current. A belt is tightened by feel. Heads weigh 0.3 to 1.2
/// kg. Nothing is published of guides, friction and damping.
const GUESSED: f64 = std::f64::consts::LN_2;

/// Uncertainty of a belt's mass that was not weighed. Assumed: 10 %. FarmBot's bill of materials lets GT2 of 5.8 mm
/// differ by 0.1 of 1.25 mm in thickness and by 0.2 mm in width, 9 % together.
const BELT_MASS: f64 = 0.1;

/// Belts of one machine are of one kind: their stiffnesses have the nominal proportion within this part (assumed).
const ALIKE_BELTS: f64 = 0.3;

/// A bar's inertia has the nominal proportion to its mass within this part (assumed): carriages at its ends may make a
/// slender bar's inertia half as large again.
const ALIKE_INERTIA: f64 = 0.4;

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::BeltStiffness,
        Self::Preload,
        Self::BeltMass,
        Self::HeadMass,
        Self::BarMass,
        Self::HoldingTorque,
        Self::GantryMass,
        Self::BedMass,
        Self::YawInertia,
        Self::YawStiffness,
        Self::BeltDamping,
        Self::GuideX,
        Self::GuideY,
    ];

    /// Its key.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::BeltStiffness => "belt_EA_N",
            Self::Preload => "preload_N",
            Self::BeltMass => "belt_kg_per_m",
            Self::HeadMass => "head_mass_kg",
            Self::BarMass => "bar_mass_kg",
            Self::HoldingTorque => "holding_torque_Nm",
            Self::GantryMass => "gantry_mass_kg",
            Self::BedMass => "bed_mass_kg",
            Self::YawInertia => "bar_yaw_inertia_kg_m2",
            Self::YawStiffness => "bar_yaw_stiffness_Nm_per_rad",
            Self::BeltDamping => "belt_damping_s",
            Self::GuideX => "guide_x_N_s_per_m",
            Self::GuideY => "guide_y_N_s_per_m",
        }
    }

    /// How many parts of this machine have one each; 0 if it has none.
    pub(super) fn parts(self, machine: Machine) -> usize {
        let has_moving_bed = matches!(machine, Machine::Own(own) if own.has_moving_bed);
        match self {
            Self::BeltStiffness | Self::Preload => machine.belts().len(),
            Self::GantryMass => usize::from(machine.lifts() && !has_moving_bed),
            Self::BedMass => usize::from(has_moving_bed),
            _ => 1,
        }
    }
}

/// A parameter of one part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// The parameter.
    pub parameter: Parameter,
    /// The part, in the order of the machine's belts; 0 for the machine.
    pub part: usize,
    /// How many parts there are.
    pub parts: usize,
}

impl Unknown {
    /// All numbers of a machine except the `fixed` ones.
    #[must_use]
    pub fn of_machine(machine: Machine, fixed: &[Parameter]) -> Vec<Self> {
        let sought = Parameter::ALL.into_iter().filter(|parameter| !fixed.contains(parameter));
        let each = |parameter: Parameter| {
            let parts = parameter.parts(machine);
            (0..parts).map(move |part| Self { parameter, part, parts })
        };
        sought.flat_map(each).collect()
    }

    /// Its value on a machine.
    #[must_use]
    pub fn of(self, params: &Params) -> f64 {
        match self.parameter {
            // Without a number it follows the bar's mass.
            Parameter::YawInertia => params.bar_yaw_inertia_kg_mm2() * 1e-6,
            other => Row::of(other.key()).map_or(0.0, |row| row.values(params).of(self.part)),
        }
    }

    /// The machine with another value of it. One number for all belts stays one: a list keeps its proportions.
    #[must_use]
    pub fn with(self, value: f64, params: &Params) -> Params {
        let mut params = params.clone();
        let Some(row) = Row::of(self.parameter.key()) else { return params };
        let values = row.values(&params);
        let values = match self.parameter {
            Parameter::BeltMass => values.with_first(value),
            _ if row.is_list() => values.with_part(self.part, value, self.parts),
            _ => Each::all(value),
        };
        (row.field)(&mut params).set(values);
        params
    }

    /// What is expected of it before any measurement: the number that it goes with, if any, and the standard
    /// uncertainty of its logarithm, or of its logarithm's distance from the other. The nominal belt is the usual one;
    /// for a weighed belt the scale determines the mass.
    #[must_use]
    pub fn expected(self, is_belt_weighed: bool) -> (Option<Self>, f64) {
        let first = Self { part: 0, ..self };
        match self.parameter {
            Parameter::BeltStiffness if self.part > 0 => (Some(first), ALIKE_BELTS),
            Parameter::YawInertia => (Some(Self { parameter: Parameter::BarMass, part: 0, parts: 1 }), ALIKE_INERTIA),
            Parameter::BeltMass if !is_belt_weighed => (None, BELT_MASS),
            _ => (None, GUESSED),
        }
    }
}

impl std::fmt::Display for Unknown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.parameter.key())?;
        if self.parts > 1 { write!(f, " of belt {}", self.part + 1) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_is_the_number_of_its_key_and_part() {
        for machine in Machine::ALL {
            for unknown in Unknown::of_machine(machine, &[]) {
                let other = unknown.with(7.5, &Params::default());
                assert_eq!(unknown.of(&other), 7.5);
                // A bar's inertia follows its mass.
                let others = Unknown::of_machine(machine, &[unknown.parameter, Parameter::YawInertia]);
                assert!(others.iter().all(|o| o.of(&other) == o.of(&Params::default())), "{unknown}");
                let twin = Unknown { part: unknown.part + 1, ..unknown };
                let is_list = unknown.part + 1 < unknown.parts;
                assert!(!is_list || twin.of(&other) == twin.of(&Params::default()), "{unknown}");
            }
        }
    }

    #[test]
    fn each_machine_has_the_numbers_of_its_belts_and_masses() {
        let number = |machine, parameter: Parameter| {
            Unknown::of_machine(machine, &[]).iter().filter(|unknown| unknown.parameter == parameter).count()
        };
        assert_eq!([Machine::CoreHBot, Machine::CoreXy].map(|m| number(m, Parameter::BeltStiffness)), [1, 2]);
        assert_eq!([Machine::HBot, Machine::CoreXyz].map(|m| number(m, Parameter::GantryMass)), [0, 1]);
        assert!(
            !Unknown::of_machine(Machine::HBot, &[Parameter::Preload]).iter().any(|u| u.parameter.key() == "preload_N")
        );
    }
}
