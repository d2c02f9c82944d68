//! How speed, friction, stiffness and mass change the errors, and what the 4-DoF model loses.

use super::super::fit::{exponent, line};
use super::super::*;
use super::errors;

/// Factors as in figure 5 of the paper: a half to two.
const FACTORS: [f64; 5] = [0.5, std::f64::consts::FRAC_1_SQRT_2, 1.0, std::f64::consts::SQRT_2, 2.0];

/// Exponents of both errors over a factor, at the speed of figure 5.
fn exponents(case: impl Fn(f64) -> Case) -> [f64; 2] {
    let found = FACTORS.map(|factor| (factor, errors(case(factor))));
    [0, 1].map(|turn| exponent(&found.map(|(factor, errors)| (factor, errors[turn]))))
}

fn assert_exponents(found: [f64; 2], expected: [f64; 2]) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() <= 0.02, "exponent {found}, expected {expected}");
    }
}

#[test]
fn the_errors_grow_a_little_faster_than_friction_and_fall_with_stiffness_but_hardly_with_mass() {
    assert_exponents(exponents(|friction| Case { friction, ..Case::at(0.079) }), [1.20, 1.57]);
    assert_exponents(exponents(|stiffness| Case { stiffness, ..Case::at(0.079) }), [-1.08, -1.27]);
    assert_exponents(exponents(|mass| Case { mass, ..Case::at(0.079) }), [-0.08, -0.25]);
}

#[test]
fn the_errors_are_linear_in_speed_with_what_coulomb_friction_leaves_at_rest() {
    let found = [0.010, 0.020, 0.039, 0.060, 0.079].map(|speed| (speed, errors(Case::at(speed))));
    let expected = [(8.885, 0.064, 0.99998), (3.459, 0.031, 0.9995)];
    for (turn, (slope, intercept, r_squared)) in expected.into_iter().enumerate() {
        let fit = line(&found.map(|(speed, errors)| (speed, errors[turn])));
        assert!((fit.slope / slope - 1.0).abs() < 0.002, "{fit:?}");
        assert!((fit.intercept - intercept).abs() < 0.001, "{fit:?}");
        assert!(fit.r_squared > r_squared, "{fit:?}");
    }
}

#[test]
fn the_four_dof_model_makes_the_turn_from_y_too_sharp_and_the_turn_from_x_right() {
    let full = errors(Case::at(0.079));
    let four = errors(Case { model: Model::FourDof, ..Case::at(0.079) });
    assert!((four[1] / full[1] - 0.64).abs() <= 0.02, "y to x: {}", four[1] / full[1]);
    assert!((four[0] / full[0] - 1.003).abs() <= 0.002, "x to y: {}", four[0] / full[0]);
}
