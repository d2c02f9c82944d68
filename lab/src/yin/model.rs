//! The two models of the paper: their coordinates, masses, friction and couplings.
//!
//! The full model (equations 3 to 7) has x, y and ten pulleys. The 4-DoF model (11 to 14) keeps x, y and the motors'
//! pulleys. Its springs are condensed, and an idler's inertia and friction go to the coordinate that it would follow
//! without stretch. No idler follows y, so this model loses the idlers' friction along y.

use super::belt::{self, COORDINATES, Matrix, X, Y, pulley};
use super::parameters::Parameters;

/// Detail of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// All pulleys turn separately: 12 degrees of freedom.
    Full,
    /// Idlers move with the coordinates that they follow: 4 degrees of freedom.
    FourDof,
}

/// Masses, friction and springs of a model, over the coordinates of `belt`; rows outside the model are unused.
pub(super) struct Mechanics {
    /// The model's coordinates; x and y are the first two, the motors' pulleys the next two.
    pub coordinates: Vec<usize>,
    /// kg.
    pub mass: [f64; COORDINATES],
    /// N s/m.
    pub viscous: [f64; COORDINATES],
    /// N.
    pub coulomb: [f64; COORDINATES],
    /// N/m.
    pub stiffness: Matrix,
}

impl Mechanics {
    pub fn new(model: Model, parameters: &Parameters) -> Mechanics {
        let full = full(parameters);
        match model {
            Model::Full => full,
            Model::FourDof => four(full),
        }
    }
}

/// Equations 4, 6 and 7. A pulley is a mass J/r^2 that moves as its belt, with friction B/r^2 and tau/r.
fn full(parameters: &Parameters) -> Mechanics {
    let r = parameters.pulley_radius;
    let mut mass = [parameters.pulley_inertia / (r * r); COORDINATES];
    let mut viscous = [parameters.pulley_viscous / (r * r); COORDINATES];
    let mut coulomb = [parameters.pulley_coulomb / r; COORDINATES];
    mass[X] = parameters.effector_mass;
    mass[Y] = parameters.moving_mass_y();
    [viscous[X], viscous[Y]] = parameters.guide_viscous;
    [coulomb[X], coulomb[Y]] = parameters.guide_coulomb;
    let stiffness = belt::stiffness(&parameters.stiffness);
    Mechanics { coordinates: (0..COORDINATES).collect(), mass, viscous, coulomb, stiffness }
}

/// The coordinate that each idler follows in the 4-DoF model.
///
/// Equation 12 as printed has pulleys 7 and 10 with motor 1, and 8 and 9 with motor 2. By equation 6 it is the other
/// way round: pulley 9 is on the belt of motor 1. With equal pulleys the figures are the same.
const FOLLOWS: [(usize, usize); 8] = [
    (pulley(3), X),
    (pulley(4), X),
    (pulley(5), X),
    (pulley(6), X),
    (pulley(8), pulley(1)),
    (pulley(9), pulley(1)),
    (pulley(7), pulley(2)),
    (pulley(10), pulley(2)),
];

/// Equations 12 to 14.
fn four(mut mechanics: Mechanics) -> Mechanics {
    for (idler, leader) in FOLLOWS {
        mechanics.mass[leader] += mechanics.mass[idler];
        mechanics.viscous[leader] += mechanics.viscous[idler];
        mechanics.coulomb[leader] += mechanics.coulomb[idler];
    }
    mechanics.coordinates.retain(|&coordinate| coordinate <= pulley(2));
    belt::condense(&mut mechanics.stiffness, &mut [0.0; COORDINATES]);
    mechanics
}
