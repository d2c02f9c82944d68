//! A case: the assumed rig with some factors, once round the square, and its errors at the corners.

use std::ops::RangeInclusive;

use super::corner::Watch;
use super::error::Error;
use super::integrator::{advance, step_for, steps};
use super::model::Model;
use super::parameters::{NOMINAL, Parameters};
use super::path::{CORNERS, Command, Corner, Piece, sides};
use super::system::{State, System};

/// Legal speeds of a case, m/s; the paper ran 0.020 to 0.079.
pub const SPEEDS: RangeInclusive<f64> = 0.001..=1.0;

/// Legal factors of a case; the paper varied from 0.5 to 2. The factor of friction may also be 0.
pub const FACTORS: RangeInclusive<f64> = 0.05..=20.0;

/// A few seconds of computing; the slowest speed on the assumed rig takes 2.1 million.
const MOST_STEPS: usize = 5_000_000;

/// A simulation on the assumed rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Speed along the square, m/s, within [`SPEEDS`].
    pub speed: f64,
    /// Detail of the model.
    pub model: Model,
    /// How the motors are commanded.
    pub command: Command,
    /// Factor of all friction, 0 or within [`FACTORS`].
    pub friction: f64,
    /// Factor of the belt's stiffness, within [`FACTORS`].
    pub stiffness: f64,
    /// Factor of all masses and moments of inertia, within [`FACTORS`].
    pub mass: f64,
}

impl Case {
    /// The full model of the unchanged rig, commanded continuously, at a speed in m/s.
    #[must_use]
    pub fn at(speed: f64) -> Case {
        Case { speed, model: Model::Full, command: Command::Continuous, friction: 1.0, stiffness: 1.0, mass: 1.0 }
    }
}

/// Contour errors by equation 17: positive where the tool cuts the corner, negative where it overshoots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corners {
    /// Turning from x to y, the second corner, mm.
    pub x_to_y_mm: f64,
    /// Turning from y to x, the third corner, mm. The first corner turns so too but does not count, because the tool
    /// comes to it from rest.
    pub y_to_x_mm: f64,
    /// Largest overshoot at the three corners in the tool's old direction, mm. Equation 17 does not show it: a lightly
    /// damped tool overshoots without cutting the corner.
    pub overshoot_mm: f64,
}

/// Simulates a case on the assumed rig ([`NOMINAL`]).
///
/// # Errors
/// A value out of range, or a tool that lags too much to turn.
pub fn run(case: &Case) -> Result<Corners, Error> {
    run_on(&NOMINAL, case)
}

/// Simulates a case on another rig.
///
/// # Errors
/// As [`run`], and illegal values of the rig.
pub fn run_on(rig: &Parameters, case: &Case) -> Result<Corners, Error> {
    let system = System::stepper(case.model, &checked(rig, case)?);
    round_the_square(&system, &sides(case.speed, case.command), step_for(&system))
}

/// The rig with the factors of the case, if all of them are legal.
fn checked(rig: &Parameters, case: &Case) -> Result<Parameters, Error> {
    if !SPEEDS.contains(&case.speed) {
        return Err(Error::Speed(case.speed));
    }
    if case.friction != 0.0 && !FACTORS.contains(&case.friction) {
        return Err(Error::Factor("friction", case.friction));
    }
    for (name, factor) in [("stiffness", case.stiffness), ("mass", case.mass)] {
        if !FACTORS.contains(&factor) {
            return Err(Error::Factor(name, factor));
        }
    }
    rig.check()?;
    Ok(rig.scaled(case.friction, case.stiffness, case.mass))
}

/// Goes round with time steps of at most `longest` s.
pub(super) fn round_the_square(system: &System, sides: &[Vec<Piece>], longest: f64) -> Result<Corners, Error> {
    let corners = corners(system, CORNERS, sides, longest)?;
    let error_mm = |i: usize| corners[i].error.map(|error| error * 1e3).ok_or(Error::NotTurned(i + 1));
    let beyond = corners.iter().map(|corner| corner.beyond).fold(0.0, f64::max);
    let [_, x_to_y_mm, y_to_x_mm] = [error_mm(0)?, error_mm(1)?, error_mm(2)?];
    Ok(Corners { x_to_y_mm, y_to_x_mm, overshoot_mm: beyond * 1e3 })
}

/// Results at each corner, which is watched on the side before and the side after it.
pub(super) fn corners(
    system: &System,
    corners: [Corner; 3],
    sides: &[Vec<Piece>],
    longest: f64,
) -> Result<[Watch; 3], Error> {
    if sides.iter().flatten().map(|piece| steps(piece, longest)).sum::<usize>() > MOST_STEPS {
        return Err(Error::TooManySteps(MOST_STEPS));
    }
    let mut corners = corners.map(Watch::new);
    let mut state = State::REST;
    for (side, pieces) in sides.iter().enumerate() {
        for piece in pieces {
            advance(system, &mut state, piece, longest, |state| {
                for (_, corner) in corners.iter_mut().enumerate().filter(|(i, _)| *i == side || i + 1 == side) {
                    corner.see(state.effector());
                }
            });
        }
    }
    Ok(corners)
}
