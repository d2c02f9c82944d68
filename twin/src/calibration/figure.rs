//! Figure: a measurable property of a machine, and the model's value of it.

use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, Freedom};
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::solve::NotHeld;
use crate::solve::balance::balance;
use crate::solve::modes::{mode_of, modes};

/// An axis of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the right.
    X,
    /// Away from the front.
    Y,
}

impl From<Direction> for Coordinate {
    fn from(direction: Direction) -> Self {
        match direction {
            Direction::X => Self::X,
            Direction::Y => Self::Y,
        }
    }
}

/// The weighed part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighed {
    /// All mass that moves in x.
    Head,
    /// All mass that moves in y besides the head.
    Bar,
    /// All mass that moves in y.
    Both,
}

/// A measurable property. The motors have power and hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Figure {
    /// Frequency in Hz of a plucked part of the belt between two pulleys, with the machine at rest.
    Pluck {
        /// Length of the part.
        length_mm: f64,
    },
    /// Mass of a metre of belt in kg.
    BeltMass,
    /// Deflection of the tool in mm along the direction of a force.
    Deflection {
        /// The tool's place.
        at: Place,
        /// Axis along which the force pulls.
        along: Direction,
        /// The force.
        force_n: f64,
    },
    /// Frequency in Hz at which an axis rings.
    Ring {
        /// The tool's place.
        at: Place,
        /// The axis.
        along: Direction,
    },
    /// Mass in kg.
    Weight(Weighed),
    /// Force in N at which a motor slips, at the end of a lever on its shaft, without belt.
    Slip {
        /// Length of the lever, from the shaft's axis.
        lever_mm: f64,
    },
}

/// A measured figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The measured property.
    pub figure: Figure,
    /// Its value in the figure's unit, above 0.
    pub measured: f64,
    /// Its relative standard uncertainty, of 1, above 0.
    pub uncertainty: f64,
}

/// mm in an m, and N mm in an N m.
const MM_PER_M: f64 = 1000.0;

/// Tension of a plucked string: T = 4 m L^2 f^2 (Mersenne), in N.
///
/// A belt's bending stiffness raises the pitch a little, more for short parts.
#[must_use]
pub fn span_tension_n(length_mm: f64, mass_kg_per_m: f64, frequency_hz: f64) -> f64 {
    4.0 * mass_kg_per_m * (length_mm / MM_PER_M * frequency_hz).powi(2)
}

impl Figure {
    /// Its value on this machine, in the figure's unit.
    ///
    /// # Errors
    /// Nothing holds the machine.
    pub fn predict(&self, machine: Machine, params: &Params) -> Result<f64, NotHeld> {
        let freedom = Freedom { idlers: true, rotors: true, ..Freedom::default() };
        Ok(match *self {
            Self::Pluck { length_mm } => {
                (params.preload_n.of(0) / span_tension_n(length_mm, params.belt_kg_per_m.of(0), 1.0)).sqrt()
            }
            Self::BeltMass => params.belt_kg_per_m.of(0),
            Self::Deflection { at, along, force_n } => {
                let elastic = Elastic::new(machine, params, at, freedom);
                let force = match along {
                    Direction::X => [force_n, 0.0, 0.0],
                    Direction::Y => [0.0, force_n, 0.0],
                };
                balance(&elastic, params, force, &[])?.of(&elastic, along.into())
            }
            Self::Ring { at, along } => {
                let modes = modes(&Elastic::new(machine, params, at, freedom))?;
                mode_of(&modes, along.into()).ok_or(NotHeld)?.frequency_hz
            }
            Self::Weight(Weighed::Head) => params.head_mass_kg,
            Self::Weight(Weighed::Bar) => params.bar_mass_kg,
            Self::Weight(Weighed::Both) => params.head_mass_kg + params.bar_mass_kg,
            Self::Slip { lever_mm } => params.holding_torque_nm * MM_PER_M / lever_mm,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn predict(figure: Figure) -> f64 {
        figure.predict(Machine::CoreHBot, &Params::default()).unwrap()
    }

    const CENTRE: Place = Place::flat(235.0, 235.0);

    /// A string of 0.4 m and 5 g under 40 N: c = sqrt(40 / 0.0125) = 56.57 m/s, f = c / 0.8 m.
    #[test]
    fn a_span_sounds_as_a_string() {
        let hz = predict(Figure::Pluck { length_mm: 400.0 });
        assert!((hz - 56.5685 / 0.8).abs() < 1e-3, "{hz}");
        assert!((span_tension_n(400.0, 0.0125, hz) - 40.0).abs() < 1e-9);
    }

    /// Stiffnesses and frequencies of an independent computation, with the motors' fields (docs/research/twin.md).
    #[test]
    fn the_model_deflects_and_rings_as_it_does_elsewhere() {
        for (along, n_per_mm, hz) in [(Direction::X, 251.2, 101.38), (Direction::Y, 244.1, 57.64)] {
            let deflection = predict(Figure::Deflection { at: CENTRE, along, force_n: 20.0 });
            assert!((deflection * n_per_mm / 20.0 - 1.0).abs() < 1e-3, "{deflection}");
            let rung = predict(Figure::Ring { at: CENTRE, along });
            assert!((rung / hz - 1.0).abs() < 5e-3, "{rung}");
        }
    }

    #[test]
    fn scales_and_levers_tell_masses_and_torque() {
        assert_eq!([Weighed::Head, Weighed::Bar].map(|w| predict(Figure::Weight(w))), [0.6, 1.2]);
        assert!((predict(Figure::Weight(Weighed::Both)) - 1.8).abs() < 1e-12);
        assert!((predict(Figure::Slip { lever_mm: 100.0 }) - 4.0).abs() < 1e-12);
    }
}
