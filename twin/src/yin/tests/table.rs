//! The corner errors of the assumed rig, against another solver's (LSODA on symbolically derived equations).

use super::super::integrator::step_for;
use super::super::parameters::PULSE;
use super::super::path::{CORNERS, Piece, SIDE};
use super::super::run::corners;
use super::super::system::System;
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

/// Parts of a side at which it is seen what a controller makes of it: 0.5 um each.
const LOOKS: usize = 40_000;

/// The square as a controller has it that makes belt travel of motors 1 and 2 of a place.
fn square(speed: f64, mut made: impl FnMut([f64; 2]) -> [f64; 2]) -> Vec<Vec<Piece>> {
    let places = [[0.0, 0.0], CORNERS[0].place, CORNERS[1].place, CORNERS[2].place, [0.0, 0.0]];
    let mut side = |pair: &[[f64; 2]]| {
        let mut pieces: Vec<Piece> = Vec::new();
        for look in 0..LOOKS {
            let part = (look as f64 + 0.5) / LOOKS as f64;
            let at = made([0, 1].map(|i| pair[0][i] + part * (pair[1][i] - pair[0][i])));
            let duration = SIDE / speed / LOOKS as f64;
            match pieces.last_mut().filter(|piece| piece.from == at) {
                Some(piece) => piece.duration += duration,
                None => pieces.push(Piece { duration, from: at, to: at }),
            }
        }
        pieces
    };
    places.windows(2).map(&mut side).collect()
}

const fn motors([x, y]: [f64; 2]) -> [f64; 2] {
    [x + y, x - y]
}

fn nearest(travel: f64) -> f64 {
    (travel / PULSE).round() * PULSE
}

fn down(travel: f64) -> f64 {
    (travel / PULSE + 1e-9).floor() * PULSE
}

/// y goes on without pulses as far as looks are fine enough.
fn x_alone([x, y]: [f64; 2]) -> [f64; 2] {
    motors([nearest(x), y])
}

/// Errors at the three corners, mm.
fn seen(model: Model, square: &[Vec<Piece>]) -> [f64; 3] {
    let system = System::stepper(model, &NOMINAL);
    corners(&system, square, step_for(&system)).unwrap().map(|corner| 1e3 * corner.error.unwrap())
}

/// An independent computation has larger errors with pulses. All twelve come out to 1.2 % (x to y) and 3 % (y to x) if x alone is in
/// pulses and the first corner alone counts from x to y: of a square whose x ends short, not of motors in pulses.
#[test]
fn the_independent_figures_with_pulses_are_those_of_x_alone_in_pulses_at_the_first_corner() {
    let full = [[0.2557, 0.1056], [0.4238, 0.1708], [0.7811, 0.3133]];
    let four = [[0.2614, 0.0646], [0.4275, 0.1075], [0.7840, 0.2060]];
    for (model, table) in [(Model::Full, full), (Model::FourDof, four)] {
        for (speed, [x_to_y, y_to_x]) in SPEEDS.into_iter().zip(table) {
            let [first, second, _] = seen(model, &square(speed, x_alone));
            assert_close(first, x_to_y, 0.012, &format!("{model:?} {speed}: first corner"));
            assert_close(second, y_to_x, 0.03, &format!("{model:?} {speed}: second corner"));
        }
    }
}

/// The table of docs/twin-yin.md: 4-DoF at 0.079 m/s; first, third and second corner.
#[test]
fn what_is_done_with_a_part_of_a_pulse_decides_the_errors() {
    let mut late = [0.0_f64; 2];
    let a_pulse_late = |at: [f64; 2]| {
        let travel = motors(at);
        late = [0, 1]
            .map(|i| late[i] + ((travel[i] - late[i]) / PULSE + 1e-9 * (travel[i] - late[i]).signum()).trunc() * PULSE);
        late
    };
    let rows = [
        ("motors, nearest", square(0.079, |at| motors(at).map(nearest)), [0.769, 0.769, 0.196]),
        ("motors, late", square(0.079, a_pulse_late), [0.769, 0.769, 0.197]),
        ("motors, down", square(0.079, |at| motors(at).map(down)), [0.809, 0.730, 0.224]),
        ("x and y, nearest", square(0.079, |at| motors(at.map(nearest))), [0.784, 0.770, 0.219]),
        ("x and y, down", square(0.079, |at| motors(at.map(down))), [0.784, 0.770, 0.240]),
        ("x alone", square(0.079, x_alone), [0.784, 0.769, 0.207]),
    ];
    for (name, square, [first, third, second]) in rows {
        let found = seen(Model::FourDof, &square);
        for (found, expected) in found.into_iter().zip([first, second, third]) {
            assert!((found - expected).abs() < 0.001, "{name}: {found} {expected}");
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
