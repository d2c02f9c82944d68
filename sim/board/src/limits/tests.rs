//! Tests of limits.

use super::*;

#[test]
fn the_settings_are_the_limits() {
    let limits = Limits::new(&Settings::prototype(), None, "G1 X5 ; M203 X900\n");
    let x = &limits.of[0];
    assert_eq!((x.step, x.speed, x.acceleration, x.hard_stop), (0.0125, 300.0, 5000.0, 0.0));
    assert!((x.jump - (8.0 * 5000.0 * 0.013f64).sqrt()).abs() < 0.01);
    assert_eq!(limits.of[3].jump, 5.0);
}

#[test]
fn a_print_may_widen_its_limits_and_homing_may_stop_hard() {
    let limits = Limits::new(&Settings::prototype(), None, "M203 X400 Y10\nG20\nM201Z10 E1000\nG28\n");
    assert_eq!(limits.of[0].speed, 400.0);
    assert_eq!(limits.of[1].speed, 300.0);
    assert_eq!(limits.of[2].acceleration, 254.0);
    assert_eq!(limits.of[2].hard_stop, 8.0);
    assert!(limits.is_judged);
    let squares = ["M205 X40\n", "SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=40\n"];
    let [marlin, klipper] = squares.map(|gcode| Limits::new(&Settings::prototype(), None, gcode).of);
    assert!(marlin == klipper && marlin[0].jump > 70.0);
}

#[test]
fn pressure_advance_has_no_limits_of_its_own_and_jumps_as_often_as_it_enters_and_leaves_a_window() {
    let limits = |gcode| Limits::new(&Settings::prototype(), None, gcode).of;
    let (plain, advanced) = (limits(""), limits("M900 K.02 ; M900 K1\n"));
    let e = &advanced[3];
    assert_eq!((e.speed, e.acceleration, e.jump), (80.0, 5000.0, 15.0));
    assert_eq!(plain[..3], advanced[..3]);
    assert_eq!(plain[4..], advanced[4..]);
    assert_eq!(limits("M900 K0\nM572 W.02\n"), plain);
    // A line that the firmware leaves alone allows nothing.
    assert_eq!(limits("M900 K30\nM572 S9 W.02\nM203 E9999 X900\nM201 E0 X90000"), plain);
}

#[test]
fn stored_settings_widen_the_limits_and_are_not_judged_in_other_steps() {
    let made = Settings::prototype();
    let mut stored = made;
    stored.axes.x.max_speed = corehbot::units::MmPerSec::from_num(350);
    stored.axes.y.max_speed = corehbot::units::MmPerSec::from_num(50);
    stored.extruder_jerk = corehbot::units::MmPerSec::from_num(8);
    let limits = Limits::new(&made, Some(&stored), "");
    assert_eq!((limits.of[0].speed, limits.of[1].speed, limits.of[3].jump), (350.0, 300.0, 8.0));
    assert!(limits.is_judged);
    stored.axes.e.steps_per_mm += corehbot::units::StepsPerMm::ONE;
    assert!(!Limits::new(&made, Some(&stored), "").is_judged);
}

/// The bound that the text derives, by trying corners.
#[test]
fn no_corner_jumps_by_more_than_the_square_root_of_8_a_d() {
    let (a, d) = (3000.0f64, 0.013);
    for i in 1..1000 {
        let half = f64::from(i) * std::f64::consts::FRAC_PI_2 / 1000.0;
        let s = half.sin();
        let jump = 2.0 * (a * d * s / (1.0 - s)).sqrt() * half.cos();
        assert!(jump <= (8.0 * a * d).sqrt());
    }
}

/// A right-angled corner of w gives each axis w times the root of its part of the commanded acceleration; flat corners
/// give up to `sqrt(8 (sqrt 2 - 1))` times as much.
#[test]
fn slow_axes_jump_by_what_their_own_acceleration_explains() {
    let limits = |gcode: &str| Limits::new(&Settings::prototype(), None, gcode).of;
    let flat = (8.0 * (2f64.sqrt() - 1.0)).sqrt();
    let block = "M204 P1250 T1250\nM205 X8 Y9\n";
    let square = limits(&format!("{block}G28\n"));
    assert!((square[2].jump - flat * 8.0 * (200.0f64 / 1250.0).sqrt()).abs() < 0.01, "{}", square[2].jump);
    assert!((square[0].jump - flat * 8.0).abs() < 0.01, "x bears what is commanded");
    // Something moved under the rule of the settings before.
    let widest = limits("M204 P1250 T1250\nG1 X5\nM205 X1\nG1 X6\n");
    assert!((widest[2].jump - (8.0 * 200.0 * 0.013f64).sqrt()).abs() < 0.01);
    // The jerk of z, and 0.02 of what x and y jump by, on a mesh.
    let capped = limits(&format!("{block}M205 Z0.4 E4.5\nG28\n"));
    assert!((capped[2].jump - (0.4 + 0.02 * 2.0 * flat * 8.0)).abs() < 0.01, "{}", capped[2].jump);
    assert_eq!(capped[3].jump, 4.5);
    // Y alone lowers, a line with an illegal value does nothing.
    assert_eq!(limits("M205 X8\nM205 Y12\nG28"), limits("M205 X8\nG28"));
    assert_eq!(limits("M205 X8\nM205 X2 E0\nG28"), limits("M205 X8\nG28"));
    // Homing passes no corner, and has the accelerations of its time.
    let block = "M201 Y300\nM204 P3000 T3000\nM205 X20\n";
    assert_eq!(limits(&format!("{block}G28\nG1 X5"))[1].acceleration, 300.0);
    let homed = limits(&format!("G28\n{block}G1 X5"));
    assert_eq!(homed[1].acceleration, 5000.0);
    assert!((homed[1].jump - flat * 20.0 * 0.1f64.sqrt()).abs() < 0.01, "{}", homed[1].jump);
}

/// START_PRINT homes, and so may the owner's texts.
#[test]
fn what_a_word_of_the_file_carries_out_has_its_limits() {
    let (s, rest) = (Settings::prototype(), "\nG1 X5");
    let limits = |first: &str| Limits::new(&s, None, &format!("{first}{rest}"));
    assert!(limits("START_PRINT BED_TEMP=60") == limits("G28") && limits("print_start") == limits("G28"));
    assert!(limits("G28") != limits(""));
    let lines = ["G28", "M203 X{FAST:400}", "M204 P{NONE} T9000"].map(str::to_owned).to_vec();
    let mut with_texts = Widening::new(&s, None);
    with_texts.texts(&[NamedText { name: "BEGIN".to_owned(), lines }]);
    ["BEGIN", "G1 X5"].into_iter().for_each(|line| with_texts.command(line));
    assert_eq!(with_texts.finish(), limits("G28\nM203 X400\nM204 T9000"));
}
