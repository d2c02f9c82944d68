//! Positions: ends of moves, and M114's report of them.

use super::talk::{talk, talk_to};
use corehbot::settings::Settings;
use corehbot::units::StepsPerMm;

#[test]
fn the_position_is_reported_as_asked_and_as_it_is() {
    let (heard, ..) = talk(&["G1 X10 Y20.004 Z1 E2 F6000", "M400", "M114", "M114 R", "G92 X0 E0", "M114"]);
    let told: Vec<_> = heard.iter().filter(|l| l.starts_with("X:")).collect();
    assert_eq!(told[0], "X:10.00 Y:20.00 Z:1.00 E:2.00 C:0.00 Count A:2400 B:-800 Z:800");
    assert_eq!(told[1], told[0]);
    assert_eq!(told[2], "X:0.00 Y:20.00 Z:1.00 E:0.00 C:0.00 Count A:2400 B:-800 Z:800");
}

#[test]
fn real_position_lags_while_moving() {
    let (heard, ..) = talk(&["G1 X100 F600", "M114", "M114 R", "M400", "M114 R"]);
    let told: Vec<_> = heard.iter().filter(|l| l.starts_with("X:")).collect();
    assert!(told[0].starts_with("X:100.00 "));
    assert!(!told[1].starts_with("X:100.00 "), "{told:?}");
    assert!(told[2].starts_with("X:100.00 "));
}

#[test]
fn a_target_beyond_the_edge_is_reported_once_a_print() {
    let lines = ["G1 X500 F12000", "G1 X600", "G1 Y-5", "M400", "M114", "G28 X", "G1 X500", "M400"];
    let (heard, ..) = talk(&lines);
    assert_eq!(heard.iter().filter(|l| l.contains("target out of reach")).count(), 2, "{heard:?}");
    assert!(heard.iter().any(|l| l.starts_with("X:390.00 Y:0.00")), "{heard:?}");
    let (heard, ..) = talk(&["M211", "M211 S0", "G1 X400 F12000", "M400", "M114 R"]);
    assert!(heard[0].starts_with("Soft endstops: ON  Min:  X0.00 Y0.00 Z0.00   Max:  X390.00 Y417.60 Z335.00"));
    assert!(heard.iter().any(|l| l.starts_with("X:400.00")), "{heard:?}");
}

#[test]
fn a_feed_rate_alone_moves_nothing_and_homing_counts_only_the_way_made() {
    let (_, outcome, _) = talk(&["G1 F3000", "M400"]);
    assert_eq!((outcome.moves, outcome.path_um), (0, 0));
    let (_, outcome, steps) = talk(&["G28"]);
    let way = outcome.path_um as f64 / 1000.0;
    assert!((20.0..30.0).contains(&way), "{way} mm in {} events", steps.count);
}

/// Reproducer: the Console rounded half a step away from zero, the generator upwards, so a machine that began at
/// v = -1/2 was one step off from then on.
#[test]
fn a_machine_that_begins_on_half_a_step_is_not_a_step_off() {
    let mut settings = Settings::prototype();
    settings.axes.x.steps_per_mm = StepsPerMm::from_num(64);
    settings.axes.y.steps_per_mm = StepsPerMm::from_num(64);
    let start = Some([0.0, 0.5 / 64.0, 0.0]);
    let (heard, ..) = talk_to(&settings, start, &["G1 X10 Y10 F6000", "M400", "M114 R"]);
    assert!(heard.contains(&"X:10.00 Y:10.00 Z:0.00 E:0.00 C:0.00 Count A:1280 B:0 Z:0".to_owned()), "{heard:?}");
}

#[test]
fn inches_relative_moves_and_overrides_mean_what_they_say() {
    let lines = [
        "G20",
        "G1 X1 F100",
        "G21",
        "G91",
        "G1 X1 E1 F6000",
        "G90",
        "M83",
        "M400",
        "M221 S200",
        "G1 E1",
        "M400",
        "M114",
    ];
    let (heard, outcome, _) = talk(&lines);
    assert!(heard.iter().any(|l| l.starts_with("X:26.40 Y:0.00 Z:0.00 E:2.00")), "{heard:?}");
    assert_eq!(outcome.counts[6], 400 + 800, "flow of 200 % for the second millimetre of filament");
    let (heard, ..) = talk(&["M220 S50", "M220", "M220 B", "M220 S120", "M220 R", "M220", "M221"]);
    assert_eq!(heard.iter().filter(|l| *l == "FR:50%").count(), 2, "{heard:?}");
    assert!(heard.contains(&"echo:E0 Flow: 100%".to_owned()));
}

#[test]
fn bad_arcs_move_nothing() {
    let (heard, outcome, _) = talk(&["G2 X10 Y0", "G2 X50 R5", "G3 I0 J0", "M400"]);
    assert_eq!(heard.iter().filter(|l| l.starts_with("echo:arc ignored")).count(), 3, "{heard:?}");
    assert_eq!(outcome.moves, 0);
}

#[test]
fn a_helix_with_turns_ends_where_it_should() {
    let (heard, outcome, _) = talk(&["G1 X50 Y50 F9000", "G3 I10 J0 Z3 P3 E6 F3000", "M400", "M114 R"]);
    assert!(heard.iter().any(|l| l.starts_with("X:50.00 Y:50.00 Z:3.00 E:6.00")), "{heard:?}");
    let path = outcome.path_um as f64 / 1000.0;
    let exact = 50.0 * 2f64.sqrt() + (3.0 * std::f64::consts::TAU * 10.0).hypot(3.0);
    assert!((path - exact).abs() < 0.2, "{path} {exact}");
}

#[test]
fn too_much_filament_in_one_move_is_left_out() {
    let (heard, outcome, _) = talk(&["G1 X10 E99999 F6000", "G1 E100001", "M400"]);
    assert!(heard.contains(&"echo:E left out: more than 1000 mm of filament in one move".to_owned()), "{heard:?}");
    assert_eq!((outcome.counts[3], outcome.counts[6]), (800, 800));
}
