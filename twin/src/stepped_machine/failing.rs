//! Failing: parts of a machine that break or come loose while it runs.
//!
//! A pulley that slips on its shaft, and a belt that jumps a tooth, move the belt past the rotor. The rotor and its
//! field stay as they are to each other, so the motor has not skipped.

use super::Live;
use crate::dynamics::external_forces::Screw;
use crate::dynamics::failing::Slipped;
use crate::geometry::layout;
use crate::math::tanh;
use crate::params::{Params, TOOTH_MM};
use crate::routing::{Machine, Place};

/// Friction of a belt on a pulley that does not turn. Assumed: rubber and nylon on dry smooth metal have 0.2 to 0.4.
const SLIDES: f64 = 0.3;

/// The part of the difference of two tensions that a pulley of this wrap holds without turning, in N. Their ratio is at
/// most `exp(SLIDES wrap)` (Euler and Eytelwein); their sum is twice the tension at rest.
fn slides_at_n(wrap_rad: f64, preload_n: f64) -> f64 {
    2.0 * preload_n * tanh(SLIDES * wrap_rad / 2.0)
}

/// Force in N at which the belt slides over an idler that does not turn, at a place of the tool. 0 if the stop of this
/// index is none.
#[must_use]
pub fn seized_idler_n(machine: Machine, params: &Params, tool: Place, stop: usize) -> f64 {
    let mut first = 0;
    let belts = machine.belts();
    let belt = belts.iter().position(|belt| {
        first += belt.stops.len();
        stop < first
    });
    let wraps = layout(machine, params, tool).wraps;
    let wrap = wraps.iter().find(|wrap| wrap.stop == stop).map_or(0.0, |wrap| wrap.angle_rad);
    belt.map_or(0.0, |belt| slides_at_n(wrap, params.preload_n.of(belt)))
}

/// Idlers of this number: the indices of their stops. Two belts may each have one.
#[must_use]
pub fn idlers_of(machine: Machine, number: u8) -> Vec<usize> {
    let stops = machine.stops().into_iter().enumerate();
    stops.filter(|(_, stop)| stop.number == number && stop.is_idler()).map(|(i, _)| i).collect()
}

impl Live {
    /// Lets these idlers turn by themselves, so that they can [seize](Self::seize): the stops by their indices. Before
    /// anything moves.
    #[must_use]
    pub fn with_idlers(mut self, stops: &[usize]) -> Self {
        let params = self.plant.params.clone();
        let plant = super::plant_of(self.machine, &params, self.plant.start(), stops);
        let mut state = super::State::at_rest(&plant);
        (state.sent_mm, state.outside) = (self.state.sent_mm, self.state.outside);
        state.outside.idler_brakes_n = vec![0.0; stops.len()];
        (self.plant, self.state) = (plant, state);
        self
    }

    /// Brakes an idler, by its place among those that [turn by themselves](Self::with_idlers), with this many N at the
    /// belt.
    pub fn seize(&mut self, idler: usize, force_n: f64) {
        if let Some(brake) = self.state.outside.idler_brakes_n.get_mut(idler).filter(|brake| **brake != force_n) {
            *brake = force_n;
            self.is_at_rest = false;
        }
    }

    /// The screw of a motor's pulley holds no more than this many N of the belt's pull, clockwise and
    /// counter-clockwise.
    pub fn loosen(&mut self, motor: usize, most_n: [f64; 2]) {
        self.tighten(motor);
        self.state.outside.screws.push(Screw { motor, most_n });
        self.is_at_rest = false;
    }

    /// The screw of a motor's pulley holds again, where the pulley is now.
    pub fn tighten(&mut self, motor: usize) {
        self.state.outside.screws.retain(|screw| screw.motor != motor);
    }

    /// The belt jumps over teeth of a motor's pulley: by so many it is ahead of the motor, counter-clockwise.
    pub fn jump(&mut self, motor: usize, teeth: f64) {
        self.shift(motor, teeth * TOOTH_MM);
    }

    /// Cords of a belt break: this part of its stiffness is left.
    pub fn weaken(&mut self, belt: usize, part: f64) {
        self.plant.weaken(belt, part, &self.state.sent_mm);
        self.is_at_rest = false;
    }

    /// By how much belt each pulley is ahead of its rotor in mm, counter-clockwise, since the start.
    #[must_use]
    pub fn shifted_mm(&self, motor: usize) -> f64 {
        self.shifted_mm.get(motor).copied().unwrap_or(0.0)
    }

    /// Loose pulleys stay where they have slipped to.
    pub(super) fn slip(&mut self) {
        let slipped = self.plant.slipped(&self.state.at, &self.state.outside.screws);
        for (motor, mm) in slipped.iter().flat_map(Slipped::motors) {
            self.shift(motor, mm);
        }
    }

    /// Moves the belt past a rotor.
    fn shift(&mut self, motor: usize, mm: f64) {
        let first = self.plant.first_motor();
        let state = &mut self.state;
        let all = [state.at.get_mut(first + motor), state.sent_mm.get_mut(motor), self.shifted_mm.get_mut(motor)];
        for value in all.into_iter().flatten().chain(state.outside.zeros_mm.get_mut(motor)) {
            *value += mm;
        }
        self.plant.send(&self.state.sent_mm);
        self.is_at_rest = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: half a turn at 40 N with a friction of 0.3 is 80 N times tanh(0.3 pi / 2). The ratio of 40 N more and
    /// less by half of it is exp(0.3 pi).
    #[test]
    fn a_belt_slides_over_a_seized_idler_by_the_law_of_the_capstan() {
        let params = Params::default();
        let at = Place::flat(235.0, 235.0);
        let [six] = idlers_of(Machine::CoreHBot, 6)[..] else { unreachable!() };
        let force = seized_idler_n(Machine::CoreHBot, &params, at, six);
        assert!((force - 35.14).abs() < 0.05, "{force}");
        let ratio = (40.0 + force / 2.0) / (40.0 - force / 2.0);
        assert!((ratio - (0.3 * std::f64::consts::PI).exp()).abs() < 1e-9, "{ratio}");
        // A quarter of a turn on the bar.
        let [two] = idlers_of(Machine::CoreHBot, 2)[..] else { unreachable!() };
        assert!((seized_idler_n(Machine::CoreHBot, &params, at, two) - 18.51).abs() < 0.05);
        // The back corners of a CoreXY have a pulley for each belt; motors are no idlers.
        assert_eq!((idlers_of(Machine::CoreXy, 6).len(), idlers_of(Machine::CoreXy, 4).len()), (2, 0));
    }
}
