//! Homing: switches found, missed, and lost again.

use super::talk::{Steps, Talk, talk, talk_to};
use corehbot::motors::{EndstopSet, prototype};
use corehbot::port::NoStorage;
use corehbot::protocol::BUSY;
use corehbot::settings::Settings;
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

#[test]
fn a_missing_switch_halts_the_machine() {
    // The machine stands farther from the switch than its axis is long.
    let mut settings = Settings::prototype();
    settings.axes.x.length = Mm::from_num(20);
    let (heard, outcome, _) = talk_to(&settings, Some([100.0, 0.0, 0.0]), &["G28 X", "G1 X5"]);
    assert!(outcome.halted);
    assert!(heard.contains(&"Error:Homing failed: X endstop not found".to_owned()), "{heard:?}");
    assert!(heard.contains(&"Error:Printer halted. kill() called! Send M999 or reset".to_owned()), "{heard:?}");
    assert!(!heard.iter().any(|l| l.starts_with("ok")));
}

/// A move that watches for an input which the board does not have would be ended by nothing.
#[test]
fn an_endstop_that_is_not_connected_is_refused_before_anything_moves() {
    let (mut host, mut steps) = (Talk::new(&["G28 X", "M114", "G28 Z", "G1 X5"]), Steps::default());
    let mut desk = Desk::new(1);
    desk.endstops = EndstopSet::X.with(EndstopSet::Y);
    let settings = Settings::prototype();
    let outcome = run_at(&mut desk, &settings, None, NoStorage, &Drivers::new(), &mut [&mut host], &mut steps).unwrap();
    assert!(outcome.halted && steps.count > 0);
    assert!(host.heard.contains(&"Error:Homing failed: Z endstop not on this board".to_owned()), "{:?}", host.heard);
    // x was homed, z has not moved.
    assert_eq!(outcome.counts[prototype::Z1.index()..=prototype::E0.index()], [0; 3]);
    assert_eq!(host.heard.iter().filter(|line| line.starts_with("ok")).count(), 2, "{:?}", host.heard);
}

#[test]
fn motors_without_power_do_not_know_where_they_are() {
    let (heard, ..) = talk(&["G1 X500 F12000", "M84", "G1 X600", "M400", "M114"]);
    // The first target is clamped; after M84 the axis has no known edge.
    assert!(heard.iter().any(|l| l.starts_with("X:600.00")), "{heard:?}");
}
