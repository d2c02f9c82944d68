//! An axis of the tool as one mass on one spring with one friction.
//!
//! While the machine runs evenly along x or y, every idler brakes its belt. The belt passes a share of this on to the
//! tool; the rest goes to the motors. This gives the tool's lag. The damping ratio tells whether the tool creeps round
//! a corner (above 1) or overshoots it (far below).

use super::belt::{self, COORDINATES, X, Y, pulley};
use super::model::{Mechanics, Model};
use super::parameters::Parameters;
use corehbot_twin::math::{ln, square};

/// One axis with the motors held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Stiffness of the belts at the tool, N/m.
    pub stiffness: f64,
    /// Mass that moves with the tool, including idlers but not the motors' pulleys, kg.
    pub mass: f64,
    /// Viscous friction with the idlers' share, N s/m.
    pub viscous: f64,
    /// Coulomb friction with the idlers' share, N.
    pub coulomb: f64,
}

impl Axis {
    /// Natural frequency, rad/s.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        (self.stiffness / self.mass).sqrt()
    }

    /// Time after which a step has settled to 5 %, by the slower pole of viscous friction alone, s.
    #[must_use]
    pub fn settling_time(&self) -> f64 {
        let ratio = self.damping_ratio();
        let beyond = (ratio * ratio - 1.0).max(0.0).sqrt();
        ln(20.0) / (self.frequency() * (ratio - beyond))
    }

    /// Damping ratio of viscous friction alone: 1 is critical.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        self.viscous / (2.0 * (self.stiffness * self.mass).sqrt())
    }
}

/// The axes x and y of a model.
#[must_use]
pub fn axes(model: Model, rig: &Parameters) -> [Axis; 2] {
    let mechanics = Mechanics::new(model, rig);
    [axis(&mechanics, X, [1.0, 0.0]), axis(&mechanics, Y, [0.0, 1.0])]
}

fn axis(mechanics: &Mechanics, tool: usize, direction: [f64; 2]) -> Axis {
    let speed = following(direction);
    let (viscous, stiffness) = at_tool(mechanics, tool, |i| mechanics.viscous[i] * speed[i]);
    let (coulomb, _) = at_tool(mechanics, tool, |i| mechanics.coulomb[i] * speed[i]);
    let moving = mechanics.coordinates.iter().filter(|&&i| i != pulley(1) && i != pulley(2));
    let mass = moving.map(|&i| mechanics.mass[i] * square(speed[i])).sum();
    Axis { stiffness, mass, viscous, coulomb }
}

/// Part of forces on all coordinates of a model that reaches the tool, and the stiffness there.
fn at_tool(mechanics: &Mechanics, tool: usize, of: impl Fn(usize) -> f64) -> (f64, f64) {
    let mut force = [0.0; COORDINATES];
    mechanics.coordinates.iter().for_each(|&i| force[i] = of(i));
    let mut stiffness = mechanics.stiffness;
    // The 4-DoF model is condensed already.
    if mechanics.coordinates.len() == COORDINATES {
        belt::condense(&mut stiffness, &mut force);
    }
    (force[tool], stiffness[tool][tool])
}

/// Every coordinate while the tool moves by x, y and no belt stretches: all sums of equation 6 are zero.
pub(super) fn following([x, y]: [f64; 2]) -> [f64; COORDINATES] {
    let mut all = [0.0; COORDINATES];
    (all[X], all[Y]) = (x, y);
    let pulleys: [(&[usize], f64); 4] = [(&[1, 8, 9], x + y), (&[2, 7, 10], x - y), (&[3, 4], -x), (&[5, 6], x)];
    for (numbers, travel) in pulleys {
        numbers.iter().for_each(|&number| all[pulley(number)] = travel);
    }
    all
}
