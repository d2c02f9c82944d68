//! The corner errors of the assumed rig, against another solver's (LSODA on symbolically derived equations).

use super::super::integrator::step_for;
use super::super::parameters::PULSE;
use super::super::path::{Direction, Piece, SIDE};
use super::super::run::corners;
use super::super::system::System;
use super::super::*;
use super::{assert_close, errors};

/// The speeds of figure 3 of the paper, m/s.
const SPEEDS: [f64; 3] = [0.020, 0.039, 0.079];

/// Compares both errors at each speed with a table, within a relative tolerance.
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

/// An independent computation of the errors with pulses; mm, from x to y and from y to x.
const PULSED_FULL: [[f64; 2]; 3] = [[0.2557, 0.1056], [0.4238, 0.1708], [0.7811, 0.3133]];
const PULSED_FOUR: [[f64; 2]; 3] = [[0.2614, 0.0646], [0.4275, 0.1075], [0.7840, 0.2060]];

#[test]
fn pulses_give_the_independent_errors() {
    let pulses = |model| move |speed| Case { model, command: Command::Pulses, ..Case::at(speed) };
    hold_to(PULSED_FULL, 0.02, pulses(Model::Full));
    hold_to(PULSED_FOUR, 0.02, pulses(Model::FourDof));
}

/// Samples of a side for a controller's rounding: 0.5 um each.
const LOOKS: usize = 40_000;

/// The square of a controller that turns places into belt travel of motors 1 and 2.
fn square(way: Direction, speed: f64, mut made: impl FnMut([f64; 2]) -> [f64; 2]) -> Vec<Vec<Piece>> {
    let [first, second, third] = way.corners().map(|corner| corner.place);
    let places = [[0.0, 0.0], first, second, third, [0.0, 0.0]];
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

/// Errors at the three corners, mm.
fn seen(model: Model, way: Direction, speed: f64, made: impl FnMut([f64; 2]) -> [f64; 2]) -> [f64; 3] {
    let system = System::stepper(model, &NOMINAL);
    let sides = square(way, speed, made);
    corners(&system, way.corners(), &sides, step_for(&system), |_, _| ())
        .unwrap()
        .map(|corner| 1e3 * corner.error.unwrap())
}

/// x ends 0.0248 mm short of 20 mm there, a fraction of a pulse.
#[test]
fn the_first_corner_the_other_way_round_has_the_independent_errors_from_x_to_y_to_all_digits() {
    for (model, table) in [(Model::Full, PULSED_FULL), (Model::FourDof, PULSED_FOUR)] {
        for (speed, [x_to_y, _]) in SPEEDS.into_iter().zip(table) {
            let [first, ..] = seen(model, Direction::CounterClockwise, speed, |at| motors(at.map(nearest)));
            assert!((first - x_to_y).abs() < 1.5e-4, "{model:?} {speed}: {first}, {x_to_y}");
        }
    }
}

/// The table of docs/research/twin-yin.md: 4-DoF at 0.079 m/s.
#[test]
fn what_is_done_with_a_part_of_a_pulse_decides_the_errors() {
    let mut late = [0.0_f64; 2];
    let mut a_pulse_late = |at: [f64; 2]| {
        let travel = motors(at);
        late = [0, 1]
            .map(|i| late[i] + ((travel[i] - late[i]) / PULSE + 1e-9 * (travel[i] - late[i]).signum()).trunc() * PULSE);
        late
    };
    let seen = |made: &mut dyn FnMut([f64; 2]) -> [f64; 2]| seen(Model::FourDof, Direction::Clockwise, 0.079, made);
    let rows = [
        ("x and y, nearest", seen(&mut |at| motors(at.map(nearest))), [0.206, 0.785, 0.206]),
        ("x and y, down", seen(&mut |at| motors(at.map(down))), [0.206, 0.816, 0.206]),
        ("x alone, nearest", seen(&mut |[x, y]| motors([nearest(x), y])), [0.192, 0.784, 0.207]),
        ("motors, nearest", seen(&mut |at| motors(at).map(nearest)), [0.192, 0.769, 0.196]),
        ("motors, late", seen(&mut a_pulse_late), [0.192, 0.769, 0.196]),
        ("motors, down", seen(&mut |at| motors(at).map(down)), [0.168, 0.809, 0.224]),
    ];
    for (name, found, expected) in rows {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.001, "{name}: {found} {expected}");
        }
    }
}

/// A motor at its nearest pulse is ahead as often as behind.
#[test]
fn motors_at_their_nearest_pulses_leave_the_errors_where_they_are() {
    for model in [Model::Full, Model::FourDof] {
        for speed in SPEEDS {
            let continuous = errors(Case { model, ..Case::at(speed) });
            let [_, x_to_y, y_to_x] = seen(model, Direction::Clockwise, speed, |at| motors(at).map(nearest));
            assert_close(x_to_y, continuous[0], 0.01, &format!("{model:?} {speed}: x to y"));
            assert_close(y_to_x, continuous[1], 0.022, &format!("{model:?} {speed}: y to x"));
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
