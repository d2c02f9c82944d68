//! Mechanisms side by side, and limits, against figures that were computed independently.

use corehbot_lab::queries::compare::{Compare, common};
use corehbot_twin::geometry::Workspace;
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::limits::Limits;
use corehbot_twin::routing::Machine;

const AREA: Workspace = Workspace { x: [60.0, 410.0], y: [31.0, 439.0], z: [0.0, 0.0] };

fn agree(found: f64, expected: f64, part: f64) -> bool {
    (found - expected).abs() <= part * expected.abs()
}

#[test]
fn the_corehbot_is_stiffest_and_most_even() {
    let params = Params::default();
    let idlers = Freedom { idlers: true, ..Freedom::default() };
    let fixed = Compare::new(&params, idlers, Some(AREA), [9, 9], 5.0).unwrap();
    // The stiffest places of the others are corners where a segment nearly ends; their figures hang on the grid.
    for (machine, (softest, mode)) in fixed.machines.iter().zip([(279.6, 62.0), (99.5, 49.7), (140.1, 46.3)]) {
        assert!(agree(machine.softest_n_per_mm[0], softest, 5e-3), "{machine:?}");
        assert!(agree(machine.first_mode_hz[0], mode, 5e-3), "{machine:?}");
    }
    let rise = |[low, high]: [f64; 2]| high / low;
    let rises: Vec<f64> = fixed.machines.iter().map(|machine| rise(machine.first_mode_hz)).collect();
    assert!(agree(rises[0], 1.13, 5e-3) && rises[1] > 1.44 && rises[2] > 1.5, "{rises:?}");
    let rotors = Freedom { idlers: true, rotors: true, ..Freedom::default() };
    let rotors = Compare::new(&params, rotors, Some(AREA), [5, 5], 5.0).unwrap();
    for (machine, mode) in rotors.machines.iter().zip([57.7, 45.9, 43.0]) {
        assert!(agree(machine.first_mode_hz[0], mode, 5e-3), "{machine:?}");
    }
    for (machine, um) in fixed.machines.iter().zip([17.9, 50.2, 35.7]) {
        assert!(agree(machine.deflection_um, um, 0.005), "{machine:?}");
    }
    let yaw: Vec<f64> = fixed.machines.iter().map(|m| m.belt_yaw_stiffness_nm_per_rad).collect();
    assert!(yaw[0].abs() < 1e-6 && yaw[1].abs() < 1e-3 && agree(yaw[2], 7640.0, 2e-3), "{yaw:?}");
}

/// At x = 60 of 470 mm the head (0.6 kg) yaws a bar on guides of 2,000 N m/rad by m a (W/2 - x)^2 / k. No belt of a
/// CoreH-bot helps or hinders. Along x nothing yaws the bar. On an H-bot half of the force along x acts on W - 4r + d
/// of lever.
#[test]
fn racking_is_what_inertia_does_to_the_bar() {
    let guides = Compare::new(&Params::default(), Freedom::default(), Some(AREA), [3, 3], 5.0).unwrap();
    let [core, hbot, corexy] = &guides.machines[..] else { panic!() };
    assert!(agree(core.racking_y_um_per_m_s2, 0.6 * 0.175 * 0.175 / 2000.0 * 1e6, 1e-6), "{core:?}");
    assert!(core.racking_x_um_per_m_s2 < 1e-6, "{core:?}");
    let yaw = 0.3 * (470.0 - 4.0 * 6.35 + 52.4) / 1000.0 / 2000.0;
    assert!(
        hbot.racking_x_um_per_m_s2 > yaw * 0.175 * 1e6 && corexy.racking_x_um_per_m_s2 < 5.0,
        "{hbot:?} {corexy:?}"
    );
}

#[test]
fn the_common_area_is_that_of_the_narrowest() {
    let area = common(&Params::default());
    assert!(agree(area.x[0], 52.7, 1e-9) && agree(area.x[1], 417.3, 1e-9));
}

/// Part of the load along an axis that each motor of the worse pair bears, of 1. The pairs stand at both ends of the
/// axis, and move by u and w of their fields' springs k. The spans a and b across the axis pull the tool twice each,
/// and those along it, s together, hold the pairs apart. With S = a + b:
/// `2 k (u + w) = F`, and `(2 (4 a b / S + s) + 2 k) (u - w) = F (a - b) / S`.
fn worst_share([a, b]: [f64; 2], s: f64) -> f64 {
    let k = 20_000.0 / (6.35 * 6.35);
    0.25 * (1.0 + (a - b).abs() / (a + b) * k / (k + s + 4.0 * a * b / (a + b)))
}

#[test]
fn limits_are_those_of_newton_and_of_the_spring() {
    let found = Limits::new(&Setup::nominal(Machine::CoreHBot, 235.0, 235.0), 0.025, 1.0).unwrap();
    // Motors of 63 N each on 0.6 or 1.8 kg and their friction, and on a rotor of 0.134 kg. At the end of an axis one
    // pair bears `worst_share` of the load and not a quarter.
    let (force, rotor) = (400.0 / 6.35, 0.133_920);
    let (span_x, span_y) = (|x: f64| 30_000.0 / (364.6 + 2.0 * x), |y: f64| 30_000.0 / (392.2 + 2.0 * y));
    let share_x = worst_share([span_x(40.0), span_x(430.0)], 2.0 * span_y(235.0));
    let share_y = worst_share([span_y(26.2), span_y(443.8)], 2.0 * span_x(235.0));
    for (axis, share, mass, dry) in [(found.x, share_x, 0.6, 0.5), (found.y, share_y, 1.8, 1.0)] {
        let expected = (force - share * dry) / (share * mass + rotor) * 1e3;
        assert!(agree(axis.torque_acceleration_mm_s2, expected, 1e-4), "{axis:?} {expected}");
    }
    // 25 um by the slowest frequencies, 110.18 and 62.59 Hz.
    assert!(agree(found.x.speed_jump_mm_s, 17.3, 2e-3) && agree(found.y.speed_jump_mm_s, 9.83, 2e-3), "{found:?}");
    // A quarter of the force on each span in the middle, up to 0.38 of it in a corner.
    assert!(found.x.slack_acceleration_mm_s2 > 150e3 && found.x.slack_acceleration_mm_s2 < 267e3, "{found:?}");
    assert!(
        found.yaw_error_um_per_m_s2.is_some_and(|um| agree(um, 0.6 * 0.195 * 0.195 / 2000.0 * 1e6, 1e-9)),
        "{found:?}"
    );
    let loose = Params { bar_yaw_stiffness_nm_per_rad: 0.0, ..Params::default() };
    let setup = Setup { params: loose, ..Setup::nominal(Machine::CoreHBot, 235.0, 235.0) };
    let text = Limits::new(&setup, 0.025, 1.0).unwrap().to_string();
    assert!(text.contains("not held by its guides") && !text.contains("inf"), "{text}");
}
