//! Failing: belts and pulleys of a plant that are not what they were.

use super::external_forces::Screw;
use super::plant::{Plant, Spring};

impl Plant {
    /// Cords of a belt have broken: this part of its stiffness is left. Its stretch stays, so its tension at rest falls
    /// by the same part.
    pub fn weaken(&mut self, belt: usize, part: f64, sent_mm: &[f64]) {
        for spring in self.springs.iter_mut().filter(|spring| spring.belt == belt) {
            spring.ea_n *= part;
            spring.preload_n *= part;
        }
        self.send(sent_mm);
    }

    /// Elastic force of the belt on a motor's pulley in N, positive counter-clockwise, and by how much it falls in N
    /// for a millimetre that the pulley gives way.
    #[must_use]
    pub fn pull_on_pulley(&self, motor: usize, at: &[f64]) -> (f64, f64) {
        let coordinate = self.first_motor() + motor;
        let (mut force, mut stiffness) = (0.0, 0.0);
        for spring in &self.springs {
            let own: f64 = spring.row.iter().filter(|(i, _)| *i == coordinate).map(|(_, c)| c).sum();
            force -= own * self.tension(spring, at);
            stiffness += own * own * spring.stiffness;
        }
        (force, stiffness)
    }

    /// Whether a spring runs to a loose pulley.
    pub(super) fn is_loose(&self, spring: &Spring, screws: &[Screw]) -> bool {
        let first = self.first_motor();
        spring.row.iter().any(|(i, _)| screws.iter().any(|screw| first + screw.motor == *i))
    }

    /// The positions after loose pulleys have slipped until their screws hold the belt; `None` if none slips.
    pub(crate) fn slipped(&self, at: &[f64], screws: &[Screw]) -> Option<Slipped> {
        let mut slipped: Option<Slipped> = None;
        for Screw { motor, most_n: [clockwise, counter] } in screws {
            let now = slipped.as_ref().map_or(at, |slipped| &slipped.at);
            let (force, stiffness) = self.pull_on_pulley(*motor, now);
            let beyond = force - force.clamp(-clockwise, *counter);
            if beyond == 0.0 || stiffness == 0.0 {
                continue;
            }
            let Slipped { at, pulleys } =
                slipped.get_or_insert_with(|| Slipped { at: at.to_vec(), pulleys: Vec::new() });
            let coordinate = self.first_motor() + motor;
            if let Some(at) = at.get_mut(coordinate) {
                *at += beyond / stiffness;
                pulleys.push((*motor, beyond / stiffness));
            }
        }
        slipped
    }
}

/// Positions of which some pulleys have slipped.
#[derive(Clone, Debug)]
pub(crate) struct Slipped {
    /// All positions.
    pub(super) at: Vec<f64>,
    /// The motor of each pulley that slipped, and how far, in mm.
    pulleys: Vec<(usize, f64)>,
}

impl Slipped {
    /// The motors, and how far the belt moved past each.
    pub(crate) fn motors(&self) -> impl Iterator<Item = (usize, f64)> {
        self.pulleys.iter().copied()
    }
}
