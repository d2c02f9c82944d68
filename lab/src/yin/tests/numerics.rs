//! Properties that hold for any figures: energy, time steps, steady states.

use super::super::integrator::{advance, step_for};
use super::super::path::{Piece, sides};
use super::super::run::round_the_square;
use super::super::*;
use super::{IDLE, assert_close};

#[test]
fn half_the_time_step_changes_no_error_by_a_tenth_of_a_percent() {
    let cases = [
        Case::at(0.020),
        Case { command: Command::Pulses, ..Case::at(0.039) },
        Case { model: Model::FourDof, ..Case::at(0.079) },
        Case { friction: 2.0, ..Case::at(0.079) },
        Case { friction: 0.5, ..Case::at(0.079) },
        Case { stiffness: 2.0, ..Case::at(0.079) },
        Case { mass: 0.5, ..Case::at(0.079) },
    ];
    for case in cases {
        let system = System::stepper(case.model, &NOMINAL.scaled(case.friction, case.stiffness, case.mass));
        let sides = sides(case.speed, case.command, case.direction);
        let step = step_for(&system);
        let [coarse, fine] =
            [step, step / 2.0].map(|step| round_the_square(&system, case.direction, &sides, step, |_, _| ()).unwrap());
        assert_close(coarse.x_to_y_mm, fine.x_to_y_mm, 0.001, &format!("{case:?}"));
        assert_close(coarse.y_to_x_mm, fine.y_to_x_mm, 0.001, &format!("{case:?}"));
    }
}

#[test]
fn energy_is_kept_without_damping_and_friction() {
    for model in [Model::Full, Model::FourDof] {
        let system = System::dc(model, &IDLE.scaled(0.0, 1.0, 1.0));
        let mut state = State::REST;
        for (i, place) in state.place.iter_mut().enumerate() {
            *place = 1e-3 * (i as f64).sin();
        }
        let before = system.energy(&state);
        let piece = Piece { duration: 0.1, from: [0.0; 2], to: [0.0; 2] };
        advance(&system, &mut state, &piece, step_for(&system) / 6.0, |state, _| {
            assert_close(system.energy(state), before, 1e-6, "energy");
        });
    }
}

/// Lag of the tool in a motion along x or y, m.
fn lag(model: Model, rig: &Parameters, [x, y]: [f64; 2], speed: f64) -> f64 {
    let system = System::stepper(model, rig);
    let length = 0.5 * speed;
    let piece = Piece { duration: 0.5, from: [0.0; 2], to: [length * (x + y), length * (x - y)] };
    let mut state = State::REST;
    advance(&system, &mut state, &piece, step_for(&system), |_, _| {});
    let [at_x, at_y] = state.effector();
    (length * x - at_x).hypot(length * y - at_y)
}

#[test]
fn the_four_dof_model_has_no_idler_friction_along_y() {
    let viscous = Parameters { guide_coulomb: [0.0; 2], pulley_coulomb: 0.0, ..NOMINAL };
    // N s/m, by the share of each idler's friction that reaches the tool.
    let expected = [(Model::Full, [159.67, 96.29]), (Model::FourDof, [110.0 + 4.0 * 10.0861, 75.0])];
    for (model, damping) in expected {
        for (i, direction) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            let axis = axes(model, &viscous)[i];
            assert_close(axis.stiffness, 2.0 * 4747.47, 1e-5, "2 k_e");
            assert_close(axis.viscous, damping[i], 1e-4, "damping");
            let lag = lag(model, &viscous, direction, 0.05);
            assert_close(lag, axis.viscous * 0.05 / axis.stiffness, 1e-4, "lag");
        }
    }
}

#[test]
fn the_assumed_rig_is_overdamped() {
    let [x, y] = axes(Model::Full, &NOMINAL);
    assert_close(x.damping_ratio(), 2.47, 0.01, "x");
    assert_close(y.damping_ratio(), 1.07, 0.01, "y");
    assert_close(x.coulomb, 0.781, 0.001, "x, N");
    assert_close(y.coulomb, 0.463, 0.001, "y, N");
}

#[test]
fn two_dc_motors_bring_the_tool_to_the_speed_at_which_friction_takes_their_torque() {
    let motor = NOMINAL.motor;
    let volts = 6.0;
    let r = NOMINAL.pulley_radius;
    // Along x all ten pulleys turn as fast as the tool moves.
    let drive = 2.0 * motor.torque_per_volt * volts / r - NOMINAL.guide_coulomb[0] - 10.0 * NOMINAL.pulley_coulomb / r;
    let damping = NOMINAL.guide_viscous[0] + (10.0 * NOMINAL.pulley_viscous + 2.0 * motor.back_torque) / (r * r);
    for model in [Model::Full, Model::FourDof] {
        let state = hold(&System::dc(model, &NOMINAL), &State::REST, [volts; 2], 0.5);
        assert_close(state.speed[0], drive / damping, 1e-3, "speed along x");
        assert!(state.speed[1].abs() < 1e-6, "speed along y: {}", state.speed[1]);
    }
}

/// Overshoot of a mass on a spring beyond the place where its lagging support stops, m.
fn swing(axis: &Axis, speed: f64) -> f64 {
    let (omega, zeta) = (axis.frequency(), axis.damping_ratio());
    let decay = zeta * omega;
    let swinging = omega * (1.0 - zeta * zeta).sqrt();
    let lag = -2.0 * zeta * speed / omega;
    let place = |t: f64| {
        let (sin, cos) = (swinging * t).sin_cos();
        (-decay * t).exp() * (lag * cos + (speed + decay * lag) / swinging * sin)
    };
    (0..1000).map(|i| place(f64::from(i) * 0.01 / omega)).fold(0.0, f64::max)
}

#[test]
fn a_lightly_damped_tool_overshoots_as_a_mass_on_a_spring_does() {
    let rig = Parameters { guide_coulomb: [0.0; 2], pulley_coulomb: 0.0, ..NOMINAL }.scaled(0.1, 1.0, 1.0);
    let corners = run_on(&rig, &Case::at(0.079)).unwrap();
    let [x, y] = axes(Model::Full, &rig).map(|axis| 1e3 * swing(&axis, 0.079));
    assert_close(corners.overshoot_mm, x.max(y), 0.02, "overshoot, mm");
    assert!(corners.y_to_x_mm.abs() < 0.05 * y, "equation 17 sees {} of {y} mm", corners.y_to_x_mm);
}
