//! DC motors (equations 7, 10 and 16) with position control, and the matrices of equation 9.

use super::super::integrator::{advance, step_for};
use super::super::path::Piece;
use super::super::state_space::{Input, StateSpace};
use super::super::*;
use super::assert_close;

/// Another program's figures: equations 10 and 16 written out by hand from equation 6, Runge-Kutta with steps of 4 us,
/// a gain of 100 V/rad. Speed in m/s; mm from x to y and from y to x; V.
const FULL: [(f64, [f64; 2], f64); 3] =
    [(0.020, [0.26058, 0.10789], 0.8998), (0.039, [0.44222, 0.17807], 1.6000), (0.079, [0.82814, 0.33330], 3.0761)];
const FOUR: [(f64, [f64; 2], f64); 3] =
    [(0.020, [0.25977, 0.06421], 0.8977), (0.039, [0.43974, 0.10837], 1.5994), (0.079, [0.82211, 0.21309], 3.0777)];

#[test]
fn dc_motors_give_the_independent_errors_in_both_directions() {
    for (model, table) in [(Model::Full, FULL), (Model::FourDof, FOUR)] {
        for (speed, errors, volts) in table {
            for direction in [Direction::Clockwise, Direction::CounterClockwise] {
                let case = Case { model, direction, drive: Drive::Dc(100.0), ..Case::at(speed) };
                let found = run(&case).unwrap();
                assert_close(found.x_to_y_mm, errors[0], 0.001, &format!("{case:?}"));
                assert_close(found.y_to_x_mm, errors[1], 0.001, &format!("{case:?}"));
                assert_close(found.most_volts.unwrap(), volts, 0.002, &format!("{case:?}"));
            }
        }
    }
}

/// A motor lags by its torque over K1 gain, and the tool by its friction over the belts' stiffness: both in mm of belt.
#[test]
fn a_servo_lags_by_the_torque_of_all_that_turns() {
    let rig = Parameters { guide_coulomb: [0.0; 2], pulley_coulomb: 0.0, ..NOMINAL };
    let (speed, r2) = (0.05, rig.pulley_radius.powi(2));
    let DcMotor { torque_per_volt: k1, back_torque: k2, .. } = rig.motor;
    // Along x all ten pulleys turn as fast as the tool moves, and each motor bears a half.
    let all = rig.guide_viscous[0] + (10.0 * rig.pulley_viscous + 2.0 * k2) / r2;
    for gain in [50.0, 200.0] {
        let system = System::servo(Model::Full, &rig, gain);
        let piece = Piece { duration: 0.5, from: [0.0; 2], to: [0.5 * speed; 2] };
        let mut state = State::REST;
        advance(&system, &mut state, &piece, step_for(&system), |_, _| {});
        let expected = speed * (all / 2.0 / (k1 * gain / r2) + 159.67 / 9494.94);
        assert_close(0.5 * speed - state.effector()[0], expected, 1e-3, "lag, m");
    }
}

#[test]
fn a_stiff_servo_is_a_stepper() {
    let stiff = run(&Case { drive: Drive::Dc(10_000.0), ..Case::at(0.079) }).unwrap();
    assert_close(stiff.x_to_y_mm, 0.7669, 0.002, "x to y");
    assert_close(stiff.y_to_x_mm, 0.3063, 0.002, "y to x");
    for gain in [0.0, 20_000.0, f64::NAN] {
        assert!(matches!(run(&Case { drive: Drive::Dc(gain), ..Case::at(0.079) }), Err(Error::Gain(_))));
    }
}

/// Rows of equations 8 and 10 as matrices: rad of the pulleys, V of the motors.
#[test]
fn equation_9_has_the_coefficients_of_equations_8_and_10() {
    let Parameters { stiffness: [k1, k2, k3, ..], pulley_radius: r, pulley_inertia: j, motor, .. } = NOMINAL;
    let space = StateSpace::new(Model::Full, &NOMINAL, Input::Angles);
    assert_eq!(space.states.len(), 20);
    assert_eq!(&space.states[..6], ["x_m", "x'_m_s", "y_m", "y'_m_s", "phi3_rad", "phi3'_rad_s"]);
    let near = |found: f64, expected: f64| assert_close(found, expected, 1e-12, "coefficient");
    // x'' = (-b1 x' - 4 k1 x + r k1 (phi5 + phi6 - phi3 - phi4)) / m_x.
    near(space.a[1][0], -4.0 * k1 / 0.08);
    near(space.a[1][1], -110.0 / 0.08);
    near(space.a[1][4], -r * k1 / 0.08);
    near(space.a[1][8], r * k1 / 0.08);
    // y'' has r k2 (phi1 - phi2) / M, and J phi3'' has -k2 r^2 phi1.
    near(space.b[3][0], r * k2 / 0.20);
    near(space.b[3][1], -r * k2 / 0.20);
    near(space.b[5][0], -k2 * r * r / j);
    assert_eq!((space.c[0][0], space.c[1][2], space.c[1][0]), (1.0, 1.0, 0.0));
    let dc = StateSpace::new(Model::Full, &NOMINAL, Input::Volts);
    assert_eq!((dc.states.len(), &dc.states[4][..], dc.inputs), (24, "phi1_rad", ["V1_V", "V2_V"]));
    let own = j + motor.rotor_inertia;
    near(dc.a[5][4], -(k2 + k3) * r * r / own);
    near(dc.a[5][5], -(NOMINAL.pulley_viscous + motor.back_torque) / own);
    near(dc.a[5][2], r * k2 / own);
    near(dc.b[5][0], motor.torque_per_volt / own);
    assert_eq!(dc.b[5][1], 0.0);
}

/// The condensed model has two masses on springs: m s^2 + b s + 2 k_e = 0 for each axis.
#[test]
fn poles_of_the_condensed_model_are_those_of_two_masses() {
    let r2 = NOMINAL.pulley_radius.powi(2);
    let mut expected: Vec<f64> = [(0.08 + 4.0e-7 / r2, 110.0 + 4.0 * 2.7e-4 / r2), (0.20, 75.0)]
        .into_iter()
        .flat_map(|(m, b): (f64, f64)| {
            let k = 2.0 * 4_747.474_747;
            // Without overdamping the real part alone.
            let root = (b * b - 4.0 * m * k).max(0.0).sqrt();
            [(-b + root) / (2.0 * m), (-b - root) / (2.0 * m)]
        })
        .collect();
    expected.sort_by(|a, b| b.total_cmp(a));
    let space = StateSpace::new(Model::FourDof, &NOMINAL, Input::Angles);
    for (pole, expected) in space.poles_per_s.iter().zip(&expected) {
        assert_close(pole[0], *expected, 1e-6, "pole");
    }
    // The sum of all poles is the trace, and nothing grows.
    let full = StateSpace::new(Model::Full, &NOMINAL, Input::Volts);
    let trace: f64 = (0..24).map(|i| full.a[i][i]).sum();
    assert_close(full.poles_per_s.iter().map(|pole| pole[0]).sum(), trace, 1e-9, "trace");
    assert!(full.poles_per_s.iter().all(|pole| pole[0] < 1e-3), "{:?}", full.poles_per_s);
}
