//! Parameter: a number of the machine that measurements may determine.

use crate::params::Params;
use serde::{Deserialize, Serialize};

/// A fitted parameter, by its key in parameter files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Parameter {
    /// Tensile stiffness of the belt.
    #[serde(rename = "belt_EA_N")]
    BeltStiffness,
    /// Tension at rest.
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
}

/// A nominal value is right within a factor of two, in one standard uncertainty. Assumed: belts of 20 to 56 kN are
/// sold; a NEMA 17 holds 0.2 to 0.6 N m by its length and current; a belt is tightened by feel; heads weigh 0.3 to 1.2
/// kg.
const GUESSED: f64 = std::f64::consts::LN_2;

/// Uncertainty of a belt's mass that was not weighed. Assumed: 10 %. FarmBot's bill of materials lets GT2 of 5.8 mm
/// differ by 0.1 of 1.25 mm in thickness and by 0.2 mm in width, 9 % together.
const BELT_MASS: f64 = 0.1;

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::BeltStiffness, Self::Preload, Self::BeltMass, Self::HeadMass, Self::BarMass, Self::HoldingTorque];

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
        }
    }

    /// Standard uncertainty of its nominal value, of the logarithm. The nominal belt is the usual one. For a weighed
    /// belt the scale determines the mass.
    #[must_use]
    pub const fn assumed_uncertainty(self, is_belt_weighed: bool) -> f64 {
        match self {
            Self::BeltMass if !is_belt_weighed => BELT_MASS,
            Self::BeltMass => GUESSED,
            Self::BeltStiffness | Self::Preload | Self::HeadMass | Self::BarMass | Self::HoldingTorque => GUESSED,
        }
    }

    /// Its value on a machine; of numbers for each belt, the first.
    #[must_use]
    pub fn of(self, params: &Params) -> f64 {
        match self {
            Self::BeltStiffness => params.belt_ea_n.of(0),
            Self::Preload => params.preload_n.of(0),
            Self::BeltMass => params.belt_kg_per_m.of(0),
            Self::HeadMass => params.head_mass_kg,
            Self::BarMass => params.bar_mass_kg,
            Self::HoldingTorque => params.holding_torque_nm,
        }
    }

    /// The machine with another value of it; numbers of several belts keep their proportions.
    #[must_use]
    pub fn with(self, value: f64, params: &Params) -> Params {
        let mut params = params.clone();
        match self {
            Self::BeltStiffness => params.belt_ea_n = params.belt_ea_n.with_first(value),
            Self::Preload => params.preload_n = params.preload_n.with_first(value),
            Self::BeltMass => params.belt_kg_per_m = params.belt_kg_per_m.with_first(value),
            Self::HeadMass => params.head_mass_kg = value,
            Self::BarMass => params.bar_mass_kg = value,
            Self::HoldingTorque => params.holding_torque_nm = value,
        }
        params
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_is_that_of_its_key() {
        for parameter in Parameter::ALL {
            let other = parameter.with(7.5, &Params::default());
            assert_eq!(parameter.of(&other), 7.5);
            assert_eq!(parameter.with(parameter.of(&Params::default()), &other), Params::default());
        }
    }
}
