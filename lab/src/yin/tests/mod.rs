//! The room against independently computed figures (symbolic derivation, another solver), against the equations of the
//! paper, and against physics that any model must obey.
mod dc;
mod equations;
mod figures;
mod numerics;
mod refusals;
mod table;
mod trends;

use super::*;

/// Motors that turn freely.
const IDLE: Parameters =
    Parameters { motor: DcMotor { torque_per_volt: 0.0, back_torque: 0.0, rotor_inertia: 0.0 }, ..NOMINAL };

/// The corner errors of a case that must run: x to y, then y to x, mm.
fn errors(case: Case) -> [f64; 2] {
    let corners = run(&case).unwrap_or_else(|error| panic!("{case:?}: {error}"));
    [corners.x_to_y_mm, corners.y_to_x_mm]
}

/// Fails unless `value` is within a relative tolerance of `expected`.
fn assert_close(value: f64, expected: f64, part: f64, what: &str) {
    assert!((value / expected - 1.0).abs() <= part, "{what}: {value}, expected {expected} within {part}");
}
