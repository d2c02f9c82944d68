//! Stiffness, slips and modes against figures that were computed independently (two solvers, symbolic algebra), and
//! against closed forms.

use corehbot_twin::geometry::workspace;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::modes::Modes;
use corehbot_twin::queries::push::Push;
use corehbot_twin::queries::slip::{A_SLIP, Slip, SlipError};
use corehbot_twin::queries::stiffness::Stiffness;
use corehbot_twin::routing::Machine;
use corehbot_twin::solve::balance::condensed;

/// Whether two figures agree to a part of the second, or to a millionth where that is 0.
fn agree(found: f64, expected: f64, part: f64) -> bool {
    (found - expected).abs() <= (part * expected.abs()).max(1e-6)
}

fn with(setup: &Setup, freedom: Freedom) -> Setup {
    Setup { freedom, ..setup.clone() }
}

const IDLERS: Freedom = Freedom { idlers: true, rotors: false, yaw: false, free_motor: None };
const ROTORS: Freedom = Freedom { idlers: true, rotors: true, yaw: false, free_motor: None };
const ROTORS_ALONE: Freedom = Freedom { idlers: false, ..ROTORS };

#[test]
fn three_machines_are_as_stiff_as_computed_elsewhere() {
    let table = [
        (Machine::CoreHBot, 235.0, 235.0, [287.563, 278.358, 0.0], 1e-3),
        (Machine::CoreHBot, 150.0, 180.0, [300.010, 282.963, 0.0], 1e-3),
        (Machine::CoreHBot, 60.0, 31.2, [348.927, 358.471, 0.0], 1e-3),
        (Machine::HBot, 147.5, 339.4, [124.99, 200.30, 22.07], 2e-3),
        (Machine::HBot, 235.0, 235.0, [153.4, 220.0, 0.0], 2e-3),
        (Machine::CoreXy, 147.5, 339.4, [173.64, 173.64, 18.64], 2e-3),
        (Machine::CoreXy, 235.0, 235.0, [198.1, 198.1, 0.0], 2e-3),
    ];
    for (machine, x, y, [kxx, kyy, kxy], part) in table {
        for freedom in [Freedom::default(), IDLERS] {
            let found = Stiffness::new(&with(&Setup::nominal(machine, x, y), freedom)).unwrap();
            let all = agree(found.kxx, kxx, part) && agree(found.kyy, kyy, part) && agree(found.kxy.abs(), kxy, part);
            assert!(all, "{found:?}");
        }
    }
}

/// `Kxx = 4 EA (1/L_R + 1/L_L)`, `Kyy = 4 EA (1/L_lo + 1/L_up)`, nothing between.
#[test]
fn the_closed_form_of_the_corehbot_holds_everywhere() {
    let p = Params::default();
    let (x_rest, y_rest) = (
        p.depth_mm - 4.0 * p.pulley_radius_mm - p.head_pulleys_mm,
        p.width_mm - 4.0 * p.pulley_radius_mm - p.bar_pulleys_mm,
    );
    for i in 0..=10 {
        for j in 0..=10 {
            let (x, y) = (40.0 + 39.0 * f64::from(i), 26.2 + 41.76 * f64::from(j));
            let pair = |rest: f64, way: f64, length: f64| {
                4.0 * p.belt_ea_n.of(0) * (1.0 / (rest + 2.0 * (length - way)) + 1.0 / (rest + 2.0 * way))
            };
            let found = Stiffness::new(&Setup::nominal(Machine::CoreHBot, x, y)).unwrap();
            assert!(agree(found.kxx, pair(x_rest, x, p.width_mm), 1e-12), "{found:?}");
            assert!(agree(found.kyy, pair(y_rest, y, p.depth_mm), 1e-12), "{found:?}");
            assert!(found.kxy.abs() < 1e-9, "{found:?}");
        }
    }
}

/// `kA = EA/L_front + EA/L_right`, `kB = EA/L_front' + EA/L_left`: what is between a belt's two motors holds nothing.
#[test]
fn a_second_motor_on_each_belt_makes_it_stiffer() {
    let p = Params::default();
    for (x, y) in [(235.0, 235.0), (147.5, 339.4), (300.0, 90.0)] {
        let (r, half_bar, half_head) = (p.pulley_radius_mm, p.bar_pulleys_mm / 2.0, p.head_pulleys_mm / 2.0);
        let (front, back) = (y - half_bar, p.depth_mm - y - half_bar);
        let (left, right) = (x - half_head, p.width_mm - x - half_head);
        let a = p.belt_ea_n.of(0) * (1.0 / (front + left - 2.0 * r) + 1.0 / (back + right));
        let b = p.belt_ea_n.of(0) * (1.0 / (front + right - 2.0 * r) + 1.0 / (back + left));
        let found = Stiffness::new(&Setup::nominal(Machine::AwdCoreXy, x, y)).unwrap();
        assert!(agree(found.kxx, a + b, 1e-9) && agree(found.kyy, a + b, 1e-9), "{found:?}");
        assert!(agree(found.kxy, a - b, 1e-9), "{found:?}");
    }
}

#[test]
fn motors_that_give_way_make_it_softer() {
    for (machine, kxx, kyy) in
        [(Machine::CoreHBot, 251.2, 244.1), (Machine::HBot, 132.9, 180.1), (Machine::CoreXy, 165.1, 165.1)]
    {
        let found = Stiffness::new(&with(&Setup::nominal(machine, 235.0, 235.0), ROTORS_ALONE)).unwrap();
        assert!(agree(found.kxx, kxx, 1e-3) && agree(found.kyy, kyy, 1e-3), "{found:?}");
    }
}

/// Springs in series: spans are what is left of segments when the idlers have given way.
#[test]
fn spans_are_segments_with_the_idlers_condensed() {
    for machine in Machine::ALL {
        let reach = workspace(machine, &Params::default());
        for [u, v] in [[0.5, 0.5], [0.2, 0.8], [0.9, 0.1]] {
            let [x, y] = [(reach.x, u), (reach.y, v)].map(|([low, high], part)| low + part * (high - low));
            let setup = Setup::nominal(machine, x, y);
            let [spans, segments] = [ROTORS_ALONE, ROTORS]
                .map(|freedom| Elastic::new(machine, &setup.params, setup.tool, freedom))
                .map(|elastic| {
                    let is_kept = |c: &&Coordinate| matches!(c, Coordinate::X | Coordinate::Y | Coordinate::Motor(_));
                    let kept = elastic.links.coordinates.iter().filter(is_kept);
                    let kept: Vec<usize> = kept.map(|c| elastic.links.index(*c).unwrap()).collect();
                    condensed(&elastic, &kept).unwrap()
                });
            assert!((&spans - &segments).amax() < 1e-9 * spans.amax(), "{machine:?}");
        }
    }
}

#[test]
fn the_natural_frequencies_are_those_computed_elsewhere() {
    let table = [
        (Freedom::default(), 235.0, 235.0, 62.587, 110.182, 1e-3),
        (Freedom::default(), 60.0, 31.2, 71.02, 121.37, 1e-3),
        (IDLERS, 235.0, 235.0, 61.832, 109.535, 5e-3),
        (IDLERS, 60.0, 31.2, 70.04, 118.65, 5e-3),
        (IDLERS, 150.0, 180.0, 62.34, 111.72, 5e-3),
        (ROTORS, 235.0, 235.0, 57.64, 101.38, 5e-3),
    ];
    for (freedom, x, y, first, second, part) in table {
        let found = Modes::new(&with(&Setup::nominal(Machine::CoreHBot, x, y), freedom)).unwrap();
        let [a, b] = [found.frequencies_hz[0], found.frequencies_hz[1]];
        assert!(agree(a, first, part) && agree(b, second, part), "{found:?}");
        assert_eq!(found.of[..2], ["y", "x"]);
    }
}

#[test]
fn belt_and_rotor_modes_are_far_above() {
    let idlers = Modes::new(&with(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), IDLERS)).unwrap();
    assert_eq!(idlers.frequencies_hz.len(), 12);
    for (found, expected) in idlers.frequencies_hz[2..].iter().zip([573.0, 579.0, 766.0, 766.0]) {
        assert!(agree(*found, expected, 5e-3), "{idlers:?}");
    }
    assert!(agree(idlers.frequencies_hz[11], 1452.0, 5e-3), "{idlers:?}");
    let rotors = Modes::new(&with(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), ROTORS)).unwrap();
    for (found, expected) in rotors.frequencies_hz[2..].iter().zip([286.0, 312.0, 320.0, 343.0, 596.0]) {
        assert!(agree(*found, expected, 5e-3), "{rotors:?}");
    }
}

#[test]
fn a_slip_strains_the_belt_as_computed_elsewhere() {
    let slip = Slip::new(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), 1, A_SLIP).unwrap().strain;
    assert!(agree(slip.dx_mm, -0.19949, 5e-3) && agree(slip.dy_mm, 0.19949, 5e-3), "{slip:?}");
    assert!(agree(slip.residual_mm.unwrap(), 0.79797, 5e-3), "{slip:?}");
    for (span, change) in [("lo", -13.88), ("R", 14.34), ("up", -13.88), ("L", 14.34)] {
        assert!(agree(slip.tension_change_n[span], change, 5e-3), "{slip:?}");
    }
    for (torque, expected) in slip.motor_torque_mnm.iter().zip([179.2, -179.2, 179.2, -179.2]) {
        assert!(agree(*torque, expected, 5e-3), "{slip:?}");
    }
    let slip = Slip::new(&Setup::nominal(Machine::CoreHBot, 60.0, 400.0), 1, A_SLIP).unwrap().strain;
    assert!(agree(slip.dx_mm, -0.28315, 5e-3) && agree(slip.dy_mm, 0.12314, 5e-3), "{slip:?}");
}

#[test]
fn rotors_that_give_way_take_a_part_of_a_slip() {
    let setup = with(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), ROTORS_ALONE);
    let slip = Slip::new(&setup, 1, A_SLIP).unwrap().strain;
    assert!(agree(slip.residual_mm.unwrap(), 0.618, 5e-3), "{slip:?}");
    assert!(agree(slip.motor_torque_mnm[0], 139.0, 5e-3), "{slip:?}");
}

/// Signs of (x, y, residual) tell which motor slipped, and which way.
#[test]
fn every_single_slip_has_a_pattern_of_its_own() {
    let setup = Setup::nominal(Machine::CoreHBot, 150.0, 300.0);
    let mut patterns = Vec::new();
    for motor in [1, 4, 8, 11] {
        for steps in [A_SLIP, -A_SLIP] {
            let slip = Slip::new(&setup, motor, steps).unwrap().strain;
            patterns.push([slip.dx_mm, slip.dy_mm, slip.residual_mm.unwrap()].map(|v| v > 0.0));
        }
    }
    patterns.sort_unstable();
    patterns.dedup();
    assert_eq!(patterns.len(), 8);
}

#[test]
fn a_motor_without_power_leaves_the_machine_held_but_couples_its_axes() {
    for (motor, kxy) in [(1, 70.721), (8, 70.721), (4, -70.721), (11, -70.721)] {
        let free = Freedom { free_motor: Some(motor), ..Freedom::default() };
        let setup = with(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), free);
        let found = Stiffness::new(&setup).unwrap();
        let all = agree(found.kxx, 214.503, 1e-4) && agree(found.kyy, 209.900, 1e-4) && agree(found.kxy, kxy, 1e-4);
        assert!(all, "motor {motor}: {found:?}");
        let modes = Modes::new(&setup).unwrap();
        assert!(agree(modes.frequencies_hz[0], 50.0, 2e-3) && agree(modes.frequencies_hz[1], 97.5, 2e-3), "{modes:?}");
    }
}

#[test]
fn a_push_goes_where_the_stiffness_says_and_the_motors_hold_it() {
    let setup = Setup::nominal(Machine::HBot, 147.5, 339.4);
    let k = Stiffness::new(&setup).unwrap();
    let push = Push::new(&setup, [3.0, -2.0]).unwrap().strain;
    let back = [k.kxx * push.dx_mm + k.kxy * push.dy_mm, k.kxy * push.dx_mm + k.kyy * push.dy_mm];
    assert!(agree(back[0], 3.0, 1e-9) && agree(back[1], -2.0, 1e-9), "{push:?}");
    // Virtual work: r F = torques times ways, (x + y) and (x - y).
    let r = setup.params.pulley_radius_mm;
    let [one, four] = [push.motor_torque_mnm[0], push.motor_torque_mnm[1]];
    assert!(agree(one + four, -3.0 * r, 1e-9) && agree(one - four, 2.0 * r, 1e-9), "{push:?}");
}

/// Belts hold the bar of a CoreXY square, those of the others do not.
#[test]
fn only_the_corexys_belts_resist_yaw() {
    let yaw = Freedom { yaw: true, ..Freedom::default() };
    for (machine, expected) in [(Machine::CoreHBot, 0.0), (Machine::HBot, 0.0), (Machine::CoreXy, 7640.0)] {
        let params = Params { bar_yaw_stiffness_nm_per_rad: 0.0, ..Params::default() };
        let setup = Setup { params, freedom: yaw, ..Setup::nominal(machine, 150.0, 300.0) };
        let elastic = Elastic::new(machine, &setup.params, setup.tool, yaw);
        let at = elastic.links.index(Coordinate::Yaw).unwrap();
        let found = condensed(&elastic, &[at]).unwrap()[(0, 0)] / 1000.0;
        assert!((found - expected).abs() < 0.002 * expected + 1e-3, "{machine:?}: {found}");
    }
}

/// On guides of 2,000 N m/rad. The head beside the middle adds to what yaws; on the others x and yaw couple.
#[test]
fn the_bar_yaws_on_its_guides() {
    let yaw = Freedom { yaw: true, ..IDLERS };
    let table = [
        (Machine::CoreHBot, 235.0, "yaw of the bar", 44.6),
        (Machine::CoreHBot, 60.0, "yaw of the bar", 33.1),
        (Machine::HBot, 235.0, "x", 29.2),
        (Machine::CoreXy, 235.0, "x", 70.8),
    ];
    for (machine, x, of, expected) in table {
        let found = Modes::new(&with(&Setup::nominal(machine, x, 235.0), yaw)).unwrap();
        let index = found.of.iter().position(|name| name == of).unwrap();
        assert!(agree(found.frequencies_hz[index], expected, 5e-3), "{machine:?}: {found:?}");
    }
}

#[test]
fn a_motor_that_is_not_there_is_an_error() {
    let error = Slip::new(&Setup::nominal(Machine::HBot, 235.0, 235.0), 8, A_SLIP).unwrap_err();
    assert_eq!(error, SlipError::NoMotor(8, vec![1, 4]));
    assert_eq!(error.to_string(), "there is no motor 8; the machine has 1, 4");
}
