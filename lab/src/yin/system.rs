//! The equations of motion of a driven model: forces of springs, friction and drive, divided by masses.
//!
//! Equation 2 for every free coordinate q: m q'' = -K q - c q' - f sgn(q') + B u. Pulses prescribe the pulley of a
//! stepper, so u is the belt travel of pulleys 1 and 2, and B their springs (equations 8 and 15). A DC motor turns with
//! the torque K1 V - K2 phi' (equation 7), so u is the voltage, and the pulleys are free (equations 10 and 16). The
//! paper has no controller for them. Ours is proportional, V = gain (commanded angle - angle), so its torque is the
//! torque of a spring, and u is the commanded belt travel.

use super::belt::{COORDINATES, X, Y, pulley};
use super::model::{Mechanics, Model};
use super::parameters::Parameters;
use corehbot_twin::math::{square, tanh};

/// Speed scale of the smoothing of sgn(v) to tanh(v / `SMOOTH_SPEED`), m/s: far below the running speeds, so that it
/// blurs only rest.
const SMOOTH_SPEED: f64 = 1e-3;

/// The motors of pulleys 1 and 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// Steppers, which turn as commanded.
    Stepper,
    /// DC motors with position control of this gain, V/rad.
    Dc(f64),
}

/// Places and speeds of the coordinates, m and m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// x, y and the belt travel r phi of pulleys 1 to 10, as far as they are free.
    pub place: [f64; COORDINATES],
    /// Their derivatives.
    pub speed: [f64; COORDINATES],
}

impl State {
    /// Everything at rest at the origin, belts without stretch.
    pub const REST: State = State { place: [0.0; COORDINATES], speed: [0.0; COORDINATES] };

    /// The end-effector, m.
    #[must_use]
    pub fn effector(&self) -> [f64; 2] {
        [self.place[X], self.place[Y]]
    }
}

/// One free coordinate.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub coordinate: usize,
    pub mass: f64,
    pub viscous: f64,
    coulomb: f64,
    /// Free coordinates and their stiffness to this one.
    pub springs: Vec<(usize, f64)>,
    /// Force per unit of each input.
    pub drive: [f64; 2],
}

/// A model with its drive.
#[derive(Debug, Clone)]
pub struct System {
    pub(super) rows: Vec<Row>,
}

/// The coordinates of the motors.
const MOTORS: [usize; 2] = [pulley(1), pulley(2)];

impl System {
    /// Driven by steppers: the inputs are the belt travels of pulleys 1 and 2, m.
    #[must_use]
    pub fn stepper(model: Model, parameters: &Parameters) -> System {
        let mechanics = Mechanics::new(model, parameters);
        let is_free = |coordinate: &usize| !MOTORS.contains(coordinate);
        let rows = rows(&mechanics, is_free, |coordinate| MOTORS.map(|m| -mechanics.stiffness[coordinate][m]));
        System { rows }
    }

    /// Driven by DC motors: the inputs are the voltages of motors 1 and 2.
    #[must_use]
    pub fn dc(model: Model, parameters: &Parameters) -> System {
        let force = parameters.motor.torque_per_volt / parameters.pulley_radius;
        turned(with_rotors(model, parameters), force)
    }

    /// Driven by DC motors with position control of this gain in V/rad: the inputs are the commanded belt travels, m.
    #[must_use]
    pub fn servo(model: Model, parameters: &Parameters, gain: f64) -> System {
        let mut mechanics = with_rotors(model, parameters);
        let spring = parameters.motor.torque_per_volt * gain / square(parameters.pulley_radius);
        for m in MOTORS {
            mechanics.stiffness[m][m] += spring;
        }
        turned(mechanics, spring)
    }

    /// With this drive: the inputs are the commanded belt travels, m.
    #[must_use]
    pub fn commanded(model: Model, parameters: &Parameters, drive: Drive) -> System {
        match drive {
            Drive::Stepper => System::stepper(model, parameters),
            Drive::Dc(gain) => System::servo(model, parameters, gain),
        }
    }

    /// Speeds and accelerations at a state, for an integrator.
    #[must_use]
    pub fn derivative(&self, state: &State, input: [f64; 2]) -> State {
        let mut change = State::REST;
        for row in &self.rows {
            let speed = state.speed[row.coordinate];
            let springs: f64 = row.springs.iter().map(|&(other, k)| k * state.place[other]).sum();
            let drive = row.drive[0] * input[0] + row.drive[1] * input[1];
            let friction = row.viscous * speed + row.coulomb * tanh(speed / SMOOTH_SPEED);
            change.place[row.coordinate] = speed;
            change.speed[row.coordinate] = (drive - springs - friction) / row.mass;
        }
        change
    }

    /// Kinetic energy, and energy of the belts with inputs of 0, J.
    #[must_use]
    pub fn energy(&self, state: &State) -> f64 {
        let of = |row: &Row| {
            let springs: f64 = row.springs.iter().map(|&(other, k)| k * state.place[other]).sum();
            row.mass * square(state.speed[row.coordinate]) / 2.0 + springs * state.place[row.coordinate] / 2.0
        };
        self.rows.iter().map(of).sum()
    }

    /// Upper bounds of the fastest decay and of the fastest undamped oscillation, 1/s (Gershgorin's circles).
    #[must_use]
    pub fn rates(&self) -> (f64, f64) {
        let decay = |row: &Row| (row.viscous + row.coulomb / SMOOTH_SPEED) / row.mass;
        let square = |row: &Row| row.springs.iter().map(|(_, k)| k.abs()).sum::<f64>() / row.mass;
        let most = |of: &dyn Fn(&Row) -> f64| self.rows.iter().map(of).fold(0.0, f64::max);
        (most(&decay), most(&square).sqrt())
    }
}

/// A model with the rotors of its DC motors, and what they lose by turning.
fn with_rotors(model: Model, parameters: &Parameters) -> Mechanics {
    let mut mechanics = Mechanics::new(model, parameters);
    let square = square(parameters.pulley_radius);
    for m in MOTORS {
        mechanics.mass[m] += parameters.motor.rotor_inertia / square;
        mechanics.viscous[m] += parameters.motor.back_torque / square;
    }
    mechanics
}

/// All coordinates are free, and each input pulls on its motor's pulley with this force per unit.
fn turned(mechanics: Mechanics, force: f64) -> System {
    System { rows: rows(&mechanics, |_| true, |c| MOTORS.map(|m| if m == c { force } else { 0.0 })) }
}

fn rows(mechanics: &Mechanics, is_free: impl Fn(&usize) -> bool, drive: impl Fn(usize) -> [f64; 2]) -> Vec<Row> {
    let free: Vec<usize> = mechanics.coordinates.iter().copied().filter(is_free).collect();
    let row = |&coordinate: &usize| Row {
        coordinate,
        mass: mechanics.mass[coordinate],
        viscous: mechanics.viscous[coordinate],
        coulomb: mechanics.coulomb[coordinate],
        springs: free
            .iter()
            .map(|&other| (other, mechanics.stiffness[coordinate][other]))
            .filter(|&(_, k)| k != 0.0)
            .collect(),
        drive: drive(coordinate),
    };
    free.iter().map(row).collect()
}
