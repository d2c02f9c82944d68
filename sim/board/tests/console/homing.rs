//! Homing: switches found, missed, and lost again.

use super::talk::{Steps, Talk, talk, talk_to};
use corehbot::motors::{EndstopSet, prototype};
use corehbot::port::NoStorage;
use corehbot::protocol::BUSY;
use corehbot::settings::{AxisEnd, Settings};
use corehbot::units::Mm;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, run_at};

#[test]
fn homing_finds_the_switches_through_the_belt() {
    let (heard, outcome, steps) = talk_to(&Settings::prototype(), None, &["G28", "M114", "M119"]);
    assert!(heard.contains(&"X:0.00 Y:0.00 Z:0.00 E:0.00 C:0.00 Count A:0 B:0 Z:0".to_owned()), "{heard:?}");
    for line in ["Reporting endstop status", "x_min: TRIGGERED", "y_min: TRIGGERED", "z_min: TRIGGERED"] {
        assert!(heard.contains(&line.to_owned()), "{line}: {heard:?}");
    }
    // It takes seconds, so the host gets busy messages.
    assert!(heard.iter().filter(|l| *l == BUSY).count() >= 3, "{heard:?}");
    assert!(steps.count > 10_000 && !outcome.halted);
    let [n1, n4, n8, n11, ..] = outcome.counts;
    assert_eq!((n1, n4), (-n8, -n11));
}

#[test]
fn one_axis_is_homed_alone_and_keeps_the_others() {
    let (heard, ..) = talk(&["G1 X30 Y40 Z5 F6000", "G28 Y", "M114", "M119"]);
    assert!(heard.iter().any(|l| l.starts_with("X:30.00 Y:0.00 Z:5.00")), "{heard:?}");
    assert!(heard.contains(&"x_min: open".to_owned()) && heard.contains(&"y_min: TRIGGERED".to_owned()));
}

/// A machine that stands 100 mm from the switch of an axis of 20 mm: each search ends 30 mm nearer.
fn far_from_its_switch() -> Settings {
    let mut settings = Settings::prototype();
    settings.axes.x.length = Mm::from_num(20);
    settings
}

const FAR: Option<[f64; 3]> = Some([100.0, 0.0, 0.0]);

fn count(heard: &[String], text: &str) -> usize {
    heard.iter().filter(|line| line.contains(text)).count()
}

#[test]
fn a_missing_switch_ends_the_job_and_not_the_machine() {
    let lines = ["M104 S200", "G28 X", "G1 X5 F6000", "M104 S200", "G1 Z5", "M105", "M114"];
    let (heard, outcome, _) = talk_to(&far_from_its_switch(), FAR, &lines);
    assert!(!outcome.halted);
    let why = "homing failed: X endstop was not met within 30 mm. Check its switch, its plug and its wire";
    assert!(heard.contains(&format!("echo:print ended, heaters are off: {why}")), "{heard:?}");
    assert_eq!([count(&heard, "//action:cancel"), count(&heard, "Error:"), count(&heard, "!!")], [1, 0, 0]);
    // A host that ignores the action gets one message, and moves nothing.
    assert_eq!(count(&heard, "echo:the print was ended"), 1, "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:70.00 Y:0.00 Z:0.00")), "{heard:?}");
    assert_eq!(heard.iter().filter(|line| line.starts_with("ok")).count(), lines.len(), "{heard:?}");
}

#[test]
fn the_axis_does_not_move_until_it_is_homed_and_homes_once_it_can() {
    let refused = "echo:move ignored: home its axes first (G28)";
    let (heard, outcome, _) = talk_to(
        &far_from_its_switch(),
        FAR,
        // y shares its motors with x, which may have skipped; z has motors of its own.
        &[
            "G28 X",
            "M108",
            "G1 X1 F6000",
            "G1 Y1",
            "G1 Z5",
            "M114",
            "G28 X",
            "G28 X",
            "G28 X",
            "G1 X7",
            "G1 Y1",
            "M114",
        ],
    );
    assert!(!outcome.halted);
    assert_eq!(count(&heard, "X endstop was not met"), 3, "{heard:?}");
    assert_eq!(count(&heard, refused), 3, "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:70.00 Y:0.00 Z:5.00")), "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:7.00 Y:0.00 Z:5.00")), "{heard:?}");
}

/// Hands may move an axis without power. Jogs count then as before the first homing, and a print is held.
#[test]
fn motors_without_power_end_the_refusal_of_jogs_but_not_of_prints() {
    let lines = ["G28 X", "M108", "G1 X71 F6000", "M84", "G1 X72", "M400", "M114", "G1 X75 E5", "!M108", "M114"];
    let (heard, outcome, _) = talk_to(&far_from_its_switch(), FAR, &lines);
    assert!(!outcome.halted);
    assert_eq!(count(&heard, "echo:move ignored"), 1, "{heard:?}");
    assert_eq!(count(&heard, "//action:pause"), 1, "{heard:?}");
    assert_eq!(heard.iter().filter(|line| line.starts_with("X:72.00")).count(), 2, "{heard:?}");
}

/// A move that watches for an input which the board does not have would be ended by nothing.
#[test]
fn an_endstop_that_is_not_connected_is_refused_before_anything_moves() {
    let (mut host, mut steps) = (Talk::new(&["G28 X", "M114", "G28 Z", "G1 X5"]), Steps::default());
    let mut desk = Desk::new(1);
    desk.endstops = EndstopSet::X.with(EndstopSet::Y);
    let settings = Settings::prototype();
    let outcome = run_at(&mut desk, &settings, None, NoStorage, &Drivers::new(), &mut [&mut host], &mut steps).unwrap();
    assert!(!outcome.halted && steps.count > 0);
    // Without a print, a refusal ends nothing.
    assert_eq!(count(&host.heard, "echo:homing failed: Z has no endstop on this board"), 1);
    assert_eq!(count(&host.heard, "//action:cancel"), 0);
    // x was homed, z has not moved.
    assert_eq!(outcome.counts[prototype::Z1.index()..=prototype::E0.index()], [0; 3]);
    assert_eq!(host.heard.iter().filter(|line| line.starts_with("ok")).count(), 4, "{:?}", host.heard);
}

#[test]
fn motors_without_power_do_not_know_where_they_are() {
    let (heard, ..) = talk(&["G1 X500 F12000", "M84", "G1 X600", "M400", "M114"]);
    // The first target is clamped; after M84 the axis has no known edge.
    assert!(heard.iter().any(|l| l.starts_with("X:600.00")), "{heard:?}");
}

#[test]
fn axes_that_are_homed_stay_where_they_are_with_o() {
    let (heard, ..) = talk(&["G28", "G1 X30 Y40 Z5 F6000", "G28 O", "M114", "G28 O Z", "M114"]);
    assert_eq!(heard.iter().filter(|line| line.starts_with("X:30.00 Y:40.00 Z:5.00")).count(), 2, "{heard:?}");
    // After M84 of one axis of a belt both are lost; z is not.
    let (heard, ..) = talk(&["G28", "G1 X30 Y40 Z5 F6000", "M84 X", "G28 O", "M114", "M84", "G28 O", "M114"]);
    assert!(heard.iter().any(|line| line.starts_with("X:0.00 Y:0.00 Z:5.00")), "{heard:?}");
    assert!(heard.iter().any(|line| line.starts_with("X:0.00 Y:0.00 Z:0.00")), "{heard:?}");
}

#[test]
fn z_rises_first_with_r() {
    let place = |lines: &[&str]| {
        let (heard, outcome, _) = talk(lines);
        assert!(!outcome.halted && !heard.iter().any(|line| line.contains("Error")), "{heard:?}");
        heard.iter().find(|line| line.starts_with("X:")).unwrap().clone()
    };
    assert!(place(&["G28", "G1 X30 Z5 F6000", "G28 X R5", "M114"]).starts_with("X:0.00 Y:0.00 Z:10.00"));
    assert!(place(&["G28", "G20", "G28 X R1", "G21", "M114"]).starts_with("X:0.00 Y:0.00 Z:25.40"));
    // As far as it can, and not at all.
    let top = Settings::prototype().axes.z.length;
    assert!(place(&["G28", "G28 X R5000", "M114"]).contains(&format!("Z:{top:.2}")));
    assert!(place(&["G28", "G1 Z5", "G28 X R0", "M114"]).contains("Z:5.00"));
    // The place of z is not known: it rises from where it is.
    assert!(place(&["G28 X Y R5", "M114"]).contains("Z:5.00"));
}

/// A switch at the upper end stops a rise from a place that is not known.
#[test]
fn a_blind_rise_ends_at_the_switch_above() {
    let mut settings = Settings::prototype();
    settings.endstops.z.end = AxisEnd::Max;
    settings.endstops.z.position = settings.axes.z.length;
    let begin = [0.0, 0.0, settings.axes.z.length.to_num::<f64>() - 3.0];
    let lines = ["G92 Z0", "G28 X Y R50", "M119", "G28 Z", "M114"];
    let (heard, outcome, _) = talk_to(&settings, Some(begin), &lines);
    assert!(!outcome.halted, "{heard:?}");
    assert!(heard.contains(&"z_max: TRIGGERED".to_owned()), "{heard:?}");
    assert!(heard.iter().any(|line| line.contains(&format!("Z:{:.2}", settings.axes.z.length))), "{heard:?}");
}
