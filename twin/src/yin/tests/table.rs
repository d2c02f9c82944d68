//! The corner errors of the assumed rig, against another solver's (LSODA on symbolically derived equations).

use super::super::*;
use super::{assert_close, errors};

/// The speeds of figure 3 of the paper, m/s.
const SPEEDS: [f64; 3] = [0.020, 0.039, 0.079];

/// Holds both errors at each speed to a table, within a part.
fn hold_to(table: [[f64; 2]; 3], part: f64, case: impl Fn(f64) -> Case) {
    for (speed, expected) in SPEEDS.into_iter().zip(table) {
        let case = case(speed);
        let found = errors(case);
        for (found, expected) in found.into_iter().zip(expected) {
            assert_close(found, expected, part, &format!("{case:?}"));
        }
    }
}

#[test]
fn a_continuous_command_gives_the_independent_errors() {
    let full = [[0.2414, 0.0994], [0.4097, 0.1638], [0.7669, 0.3063]];
    hold_to(full, 0.002, Case::at);
    let four = [[0.2432, 0.0586], [0.4114, 0.0994], [0.7690, 0.1962]];
    hold_to(four, 0.002, |speed| Case { model: Model::FourDof, ..Case::at(speed) });
}

#[test]
fn pulses_leave_the_errors_where_they_are() {
    for model in [Model::Full, Model::FourDof] {
        for speed in SPEEDS {
            let continuous = errors(Case { model, ..Case::at(speed) });
            let pulses = errors(Case { model, command: Command::Pulses, ..Case::at(speed) });
            assert_close(pulses[0], continuous[0], 0.01, &format!("{model:?} {speed}: x to y"));
            assert_close(pulses[1], continuous[1], 0.022, &format!("{model:?} {speed}: y to x"));
        }
    }
}

#[test]
fn without_coulomb_friction_the_errors_are_proportional_to_the_speed() {
    let viscous = Parameters { guide_coulomb: [0.0; 2], pulley_coulomb: 0.0, ..NOMINAL };
    let expected = [(0.020, 0.17929, 0.07157), (0.039, 0.34961, 0.13957), (0.079, 0.70818, 0.28272)];
    for (speed, x_to_y, y_to_x) in expected {
        let found = run_on(&viscous, &Case::at(speed)).unwrap();
        assert_close(found.x_to_y_mm, x_to_y, 0.001, "x to y");
        assert_close(found.y_to_x_mm, y_to_x, 0.001, "y to x");
        assert_close(found.x_to_y_mm / speed, 8.9643, 0.001, "x to y per speed");
    }
    let four = run_on(&viscous, &Case { model: Model::FourDof, ..Case::at(0.079) }).unwrap();
    assert_close(four.x_to_y_mm, 0.7088, 0.001, "x to y, 4 DoF");
    assert_close(four.y_to_x_mm, 0.18888, 0.001, "y to x, 4 DoF");
}
