//! The paper's equations of motion, corrected and written out, against the equations that the room derives from
//! equation 6.

use super::super::belt::{X, Y, pulley};
use super::super::damping::following;
use super::super::*;
use super::IDLE;

const MOTOR: DcMotor = DcMotor { torque_per_volt: 0.02, back_torque: 1e-3, rotor_inertia: 3e-7 };
const RIG: Parameters = Parameters { motor: MOTOR, ..NOMINAL };
const VOLTS: [f64; 2] = [3.0, -5.0];

/// A state without any symmetry.
fn some_state() -> State {
    let mut state = State::REST;
    for i in 0..state.place.len() {
        state.place[i] = 1e-3 * (1.7 * i as f64 + 0.3).sin();
        state.speed[i] = 2e-3 * (2.9 * i as f64 + 1.1).cos();
    }
    state
}

fn sgn(speed: f64) -> f64 {
    (speed / 1e-3).tanh()
}

/// Positions under the paper's names: angles in rad.
struct Named {
    x: f64,
    y: f64,
    /// The angle of pulley 1 is `phi[1]`.
    phi: [f64; 11],
}

impl Named {
    fn new(of: &[f64; 12]) -> Named {
        let mut phi = [0.0; 11];
        for number in 1..=10 {
            phi[number] = of[pulley(number)] / NOMINAL.pulley_radius;
        }
        Named { x: of[X], y: of[Y], phi }
    }
}

/// Equations 8 and 10, corrected: second derivatives of x, y and the ten angles.
fn full(state: &State) -> [f64; 12] {
    let Parameters { stiffness: [k1, k2, k3, k4, k5], pulley_radius: r, pulley_inertia, .. } = NOMINAL;
    let (q, v) = (Named::new(&state.place), Named::new(&state.speed));
    let Named { x, y, phi } = q;
    let r2 = r * r;
    let springs = [
        -4.0 * k1 * x + r * k1 * (phi[5] + phi[6] - phi[3] - phi[4]),
        -2.0 * (k2 + k5) * y
            + r * k2 * (phi[1] + phi[3] - phi[2] - phi[4])
            + r * k5 * (phi[5] + phi[8] - phi[6] - phi[7]),
        -(k2 + k3) * r2 * phi[1] + r * k2 * y + r2 * (k3 * phi[9] - k2 * phi[3]),
        -(k2 + k3) * r2 * phi[2] - r * k2 * y + r2 * (k3 * phi[10] - k2 * phi[4]),
        -(k1 + k2) * r2 * phi[3] - k1 * r * x + k2 * r * y - k2 * r2 * phi[1],
        -(k1 + k2) * r2 * phi[4] - k1 * r * x - k2 * r * y - k2 * r2 * phi[2],
        -(k1 + k5) * r2 * phi[5] + k1 * r * x + k5 * r * y + k5 * r2 * phi[7],
        -(k1 + k5) * r2 * phi[6] + k1 * r * x - k5 * r * y + k5 * r2 * phi[8],
        -(k4 + k5) * r2 * phi[7] - k5 * r * y + k4 * r2 * phi[10] + k5 * r2 * phi[5],
        -(k4 + k5) * r2 * phi[8] + k5 * r * y + k4 * r2 * phi[9] + k5 * r2 * phi[6],
        -(k3 + k4) * r2 * phi[9] + k3 * r2 * phi[1] + k4 * r2 * phi[8],
        -(k3 + k4) * r2 * phi[10] + k3 * r2 * phi[2] + k4 * r2 * phi[7],
    ];
    let [b1, b2] = NOMINAL.guide_viscous;
    let [f1, f2] = NOMINAL.guide_coulomb;
    let mut change = [0.0; 12];
    change[0] = (springs[0] - b1 * v.x - f1 * sgn(v.x)) / NOMINAL.effector_mass;
    change[1] = (springs[1] - b2 * v.y - f2 * sgn(v.y)) / 0.20;
    for number in 1..=10 {
        let speed = v.phi[number];
        let friction = NOMINAL.pulley_viscous * speed + NOMINAL.pulley_coulomb * sgn(r * speed);
        let rotor = if number <= 2 { MOTOR.rotor_inertia } else { 0.0 };
        change[number + 1] = (springs[number + 1] - friction + torque(number, speed)) / (pulley_inertia + rotor);
    }
    change
}

/// Torque of the motors on pulleys 1 and 2, equation 7.
fn torque(number: usize, speed: f64) -> f64 {
    VOLTS.get(number - 1).map_or(0.0, |volts| MOTOR.torque_per_volt * volts - MOTOR.back_torque * speed)
}

/// Equations 15 and 16 with corrected 12 to 14: second derivatives of x, y, phi1, phi2.
fn four(state: &State) -> [f64; 4] {
    let Parameters { stiffness: [k1, k2, k3, k4, k5], pulley_radius: r, .. } = NOMINAL;
    let ke = k1 * k2 / (k1 + k2) + k1 * k3 * k4 * k5 / (k1 * k3 * k4 + k1 * k3 * k5 + k1 * k4 * k5 + k3 * k4 * k5);
    let (Named { x, y, phi }, v) = (Named::new(&state.place), Named::new(&state.speed));
    let (bp, tau_f) = (NOMINAL.pulley_viscous, NOMINAL.pulley_coulomb);
    let b1e = NOMINAL.guide_viscous[0] + 4.0 * bp / (r * r);
    let f1e = NOMINAL.guide_coulomb[0] + 4.0 * tau_f / r;
    let mxe = NOMINAL.effector_mass + 4.0 * NOMINAL.pulley_inertia / (r * r);
    let motor = |number: usize, sign: f64| {
        let speed = v.phi[number];
        let springs = -ke * r * r * phi[number] + r * ke * (x + sign * y);
        let friction = 3.0 * bp * speed + 3.0 * tau_f * sgn(r * speed);
        (springs - friction + torque(number, speed)) / (3.0 * NOMINAL.pulley_inertia + MOTOR.rotor_inertia)
    };
    [
        (-b1e * v.x - 2.0 * ke * x + r * ke * (phi[1] + phi[2]) - f1e * sgn(v.x)) / mxe,
        (-NOMINAL.guide_viscous[1] * v.y - 2.0 * ke * y + r * ke * (phi[1] - phi[2])
            - NOMINAL.guide_coulomb[1] * sgn(v.y))
            / 0.20,
        motor(1, 1.0),
        motor(2, -1.0),
    ]
}

/// Compares accelerations (angles in rad/s2) with a system's (belt travel in m/s2), in the order of the coordinates.
fn assert_same(system: &System, input: [f64; 2], expected: &[(usize, f64)]) {
    let found = system.derivative(&some_state(), input);
    for &(coordinate, acceleration) in expected {
        let unit = if coordinate < 2 { 1.0 } else { NOMINAL.pulley_radius };
        let (found, expected) = (found.speed[coordinate], acceleration * unit);
        assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{coordinate}: {found}, not {expected}");
    }
}

#[test]
fn the_full_model_has_equations_8_and_10_with_either_drive() {
    let all: Vec<_> = full(&some_state()).into_iter().enumerate().collect();
    assert_same(&System::dc(Model::Full, &RIG), VOLTS, &all);
    let driven = [pulley(1), pulley(2)];
    let free: Vec<_> = all.into_iter().filter(|(coordinate, _)| !driven.contains(coordinate)).collect();
    assert_same(&System::stepper(Model::Full, &NOMINAL), driven.map(|p| some_state().place[p]), &free);
}

#[test]
fn the_condensed_model_has_equations_15_and_16_with_either_drive() {
    let all: Vec<_> = four(&some_state()).into_iter().enumerate().collect();
    assert_same(&System::dc(Model::FourDof, &RIG), VOLTS, &all);
    let driven = [pulley(1), pulley(2)].map(|p| some_state().place[p]);
    assert_same(&System::stepper(Model::FourDof, &NOMINAL), driven, &all[..2]);
}

/// The springs' torque on pulleys 3 to 10 by equation 8 as printed, N m.
fn printed(number: usize, state: &State) -> f64 {
    let k = |i: usize| NOMINAL.stiffness[i - 1];
    let r = NOMINAL.pulley_radius;
    let Named { x, y, phi } = Named::new(&state.place);
    let (m, n, s, t) = match number {
        3 | 4 => (1, 2, number - 2, 0),
        5 | 6 => (5, 1, number + 2, 0),
        7 | 8 => (4, 5, 17 - number, number - 2),
        _ => (3, 4, number - 8, 17 - number),
    };
    let own = -(k(m) + k(n)) * r * r * phi[number];
    match number {
        3..=6 => own - r * k(m) * x + r * k(n) * y - r * r * k(m) * phi[s],
        _ => own - r * k(n) * y + r * r * (k(n) * phi[s] - k(m) * phi[t]),
    }
}

#[test]
fn a_machine_that_follows_rigidly_feels_no_force_but_by_equation_8_as_printed_it_would() {
    let state = State { place: following([0.003, 0.007]), ..State::REST };
    for model in [Model::Full, Model::FourDof] {
        let change = System::dc(model, &IDLE).derivative(&state, [0.0; 2]);
        assert!(change.speed.iter().all(|acceleration| acceleration.abs() < 1e-9), "{:?}", change.speed);
    }
    for number in 3..=10 {
        assert!(printed(number, &state).abs() > 1e-3, "pulley {number}: {} N m", printed(number, &state));
    }
}
