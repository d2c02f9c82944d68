//! A case: a rig with some factors, once round the square, and its errors at the corners.

use std::ops::RangeInclusive;

use super::belt::pulley;
use super::corner::Watch;
use super::error::Error;
use super::integrator::{advance, step_for, steps};
use super::model::Model;
use super::parameters::{NOMINAL, Parameters};
use super::path::{Command, Corner, Direction, Piece, sides};
use super::system::{Drive, State, System};

/// Legal speeds of a case, m/s; the paper ran 0.020 to 0.079.
pub const SPEEDS: RangeInclusive<f64> = 0.001..=1.0;

/// Legal factors of a case; the paper varied from 0.5 to 2. The factor of friction may also be 0.
pub const FACTORS: RangeInclusive<f64> = 0.05..=20.0;

/// Legal gains of the position control of DC motors, V/rad.
pub const GAINS: RangeInclusive<f64> = 1.0..=10_000.0;

/// A few seconds of computing; the slowest speed on the assumed rig takes 2.1 million.
const MOST_STEPS: usize = 5_000_000;

/// A simulation on the assumed rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Speed along the square, m/s, within [`SPEEDS`].
    pub speed: f64,
    /// Detail of the model.
    pub model: Model,
    /// The motors; a gain of DC motors is within [`GAINS`].
    pub drive: Drive,
    /// How the motors are commanded.
    pub command: Command,
    /// The way round the square.
    pub direction: Direction,
    /// Factor of all friction, 0 or within [`FACTORS`].
    pub friction: f64,
    /// Factor of the belt's stiffness, within [`FACTORS`].
    pub stiffness: f64,
    /// Factor of all masses and moments of inertia, within [`FACTORS`].
    pub mass: f64,
}

impl Case {
    /// The full model of the unchanged rig with steppers, commanded continuously and clockwise, at a speed in m/s.
    #[must_use]
    pub const fn at(speed: f64) -> Case {
        Case {
            speed,
            model: Model::Full,
            drive: Drive::Stepper,
            command: Command::Continuous,
            direction: Direction::Clockwise,
            friction: 1.0,
            stiffness: 1.0,
            mass: 1.0,
        }
    }
}

/// Contour errors by equation 17: positive where the tool cuts the corner, negative where it overshoots. The first
/// corner does not count, because the tool comes to it from rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corners {
    /// Turning from x to y, mm: the second corner clockwise, the third counter-clockwise.
    pub x_to_y_mm: f64,
    /// Turning from y to x, mm: the third corner clockwise, the second counter-clockwise.
    pub y_to_x_mm: f64,
    /// Largest overshoot at the three corners in the tool's old direction, mm. Equation 17 does not show it: a lightly
    /// damped tool overshoots without cutting the corner.
    pub overshoot_mm: f64,
    /// Largest voltage of a DC motor, V.
    pub most_volts: Option<f64>,
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
    let rig = checked(rig, case)?;
    let system = System::commanded(case.model, &rig, case.drive);
    let mut lag = 0.0_f64;
    let watch = |state: &State, travel: [f64; 2]| {
        let behind = [0, 1].map(|motor| (travel[motor] - state.place[pulley(motor + 1)]).abs());
        lag = behind.into_iter().fold(lag, f64::max);
    };
    let sides = sides(case.speed, case.command, case.direction);
    let corners = round_the_square(&system, case.direction, &sides, step_for(&system), watch)?;
    let most_volts = match case.drive {
        Drive::Stepper => None,
        Drive::Dc(gain) => Some(gain * lag / rig.pulley_radius),
    };
    Ok(Corners { most_volts, ..corners })
}

/// The tool's places on a rig once round the square, mm, one for each 0.1 mm of the path.
///
/// # Errors
/// As [`run_on`].
pub fn trajectory(rig: &Parameters, case: &Case) -> Result<Vec<[f64; 2]>, Error> {
    /// m.
    const APART: f64 = 1e-4;
    let system = System::commanded(case.model, &checked(rig, case)?, case.drive);
    let sides = sides(case.speed, case.command, case.direction);
    let longest = step_for(&system);
    let every = (APART / case.speed / longest).ceil() as usize;
    let mut places = vec![[0.0; 2]];
    let mut count = 0;
    corners(&system, case.direction.corners(), &sides, longest, |state, _| {
        count += 1;
        if count % every == 0 {
            places.push(state.effector().map(|place| place * 1e3));
        }
    })?;
    Ok(places)
}

/// The rig with the factors of the case, if all of them are legal.
fn checked(rig: &Parameters, case: &Case) -> Result<Parameters, Error> {
    if !SPEEDS.contains(&case.speed) {
        return Err(Error::Speed(case.speed));
    }
    if let Drive::Dc(gain) = case.drive
        && !GAINS.contains(&gain)
    {
        return Err(Error::Gain(gain));
    }
    scaled(rig, case)
}

/// The rig with the factors of the case, without its speed and drive.
///
/// # Errors
/// A factor out of range, or illegal values of the rig.
pub fn scaled(rig: &Parameters, case: &Case) -> Result<Parameters, Error> {
    if case.friction != 0.0 && !FACTORS.contains(&case.friction) {
        return Err(Error::Factor("friction", case.friction));
    }
    for (name, factor) in [("stiffness", case.stiffness), ("mass", case.mass)] {
        if !FACTORS.contains(&factor) {
            return Err(Error::Factor(name, factor));
        }
    }
    rig.check()?;
    let scaled = rig.scaled(case.friction, case.stiffness, case.mass);
    scaled.check()?;
    Ok(scaled)
}

/// Goes round with time steps of at most `longest` s and shows every state with its inputs.
pub(super) fn round_the_square(
    system: &System,
    direction: Direction,
    sides: &[Vec<Piece>],
    longest: f64,
    show: impl FnMut(&State, [f64; 2]),
) -> Result<Corners, Error> {
    let corners = corners(system, direction.corners(), sides, longest, show)?;
    let error_mm = |i: usize| corners[i].error.map(|error| error * 1e3).ok_or(Error::NotTurned(i + 1));
    let beyond = corners.iter().map(|corner| corner.beyond).fold(0.0, f64::max);
    error_mm(0)?;
    let [x_to_y, y_to_x] = direction.turns().map(error_mm);
    Ok(Corners { x_to_y_mm: x_to_y?, y_to_x_mm: y_to_x?, overshoot_mm: beyond * 1e3, most_volts: None })
}

/// Results at each corner, which is watched on the side before and the side after it.
pub(super) fn corners(
    system: &System,
    corners: [Corner; 3],
    sides: &[Vec<Piece>],
    longest: f64,
    mut show: impl FnMut(&State, [f64; 2]),
) -> Result<[Watch; 3], Error> {
    // Absurd numbers need more steps than there are numbers for.
    let all = sides.iter().flatten().map(|piece| steps(piece, longest)).fold(0, usize::saturating_add);
    if all > MOST_STEPS {
        return Err(Error::TooManySteps(MOST_STEPS));
    }
    let mut corners = corners.map(Watch::new);
    let mut state = State::REST;
    for (side, pieces) in sides.iter().enumerate() {
        for piece in pieces {
            advance(system, &mut state, piece, longest, |state, input| {
                for (_, corner) in corners.iter_mut().enumerate().filter(|(i, _)| *i == side || i + 1 == side) {
                    corner.see(state.effector());
                }
                show(state, input);
            });
        }
    }
    Ok(corners)
}
