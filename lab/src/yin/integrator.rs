//! The fourth-order Runge-Kutta method with fixed steps: no tolerance, no random number, the same figures every time.

use super::belt::COORDINATES;
use super::path::Piece;
use super::system::{State, System};

/// Step in time constants of the fastest decay. The method is stable to 2.78 and follows a decay of 0.9 to 0.5 %. The
/// fastest decay is a pulley that just reverses, and the rest of its error is gone a few steps later.
const STEP_DECAY: f64 = 0.9;

/// Step in radians of the fastest oscillation: its amplitude then errs by 0.2^6 / 144 a step, less than a millionth.
const STEP_ANGLE: f64 = 0.2;

/// A short enough time step for this system, s: 38 us for the assumed rig. A test halves it.
pub(super) fn step_for(system: &System) -> f64 {
    let (decay, oscillation) = system.rates();
    (STEP_DECAY / decay).min(STEP_ANGLE / oscillation)
}

/// Number of steps of at most `longest` s in a piece. Pieces end at the edges of the command, so no step crosses one.
pub(super) fn steps(piece: &Piece, longest: f64) -> usize {
    (piece.duration / longest).ceil().max(1.0) as usize
}

/// Integrates a piece and shows every state, with the inputs at its time.
pub(super) fn advance(
    system: &System,
    state: &mut State,
    piece: &Piece,
    longest: f64,
    mut show: impl FnMut(&State, [f64; 2]),
) {
    let count = steps(piece, longest);
    let step = piece.duration / count as f64;
    for i in 0..count {
        let input = |part: f64| piece.at((i as f64 + part) / count as f64);
        *state = runge_kutta(system, state, step, [input(0.0), input(0.5), input(1.0)]);
        show(state, input(1.0));
    }
}

/// The state after a time in s with constant inputs.
#[must_use]
pub fn hold(system: &System, state: &State, input: [f64; 2], duration: f64) -> State {
    let mut after = *state;
    advance(system, &mut after, &Piece { duration, from: input, to: input }, step_for(system), |_, _| {});
    after
}

/// One step, with the input at its start, middle and end.
fn runge_kutta(system: &System, state: &State, step: f64, [start, middle, end]: [[f64; 2]; 3]) -> State {
    let k1 = system.derivative(state, start);
    let k2 = system.derivative(&moved(state, &k1, step / 2.0), middle);
    let k3 = system.derivative(&moved(state, &k2, step / 2.0), middle);
    let k4 = system.derivative(&moved(state, &k3, step), end);
    let mut mean = State::REST;
    for i in 0..COORDINATES {
        mean.place[i] = (k1.place[i] + 2.0 * (k2.place[i] + k3.place[i]) + k4.place[i]) / 6.0;
        mean.speed[i] = (k1.speed[i] + 2.0 * (k2.speed[i] + k3.speed[i]) + k4.speed[i]) / 6.0;
    }
    moved(state, &mean, step)
}

/// The state after a time with this change per second.
fn moved(state: &State, change: &State, time: f64) -> State {
    let mut to = *state;
    for i in 0..COORDINATES {
        to.place[i] += time * change.place[i];
        to.speed[i] += time * change.speed[i];
    }
    to
}
