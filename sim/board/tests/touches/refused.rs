//! A line that is refused before anything moves changes nothing.

use crate::common::life::Life;
use crate::touches::machine::{begin, begin_with, machine};
use corehbot::motors::EndstopSet;
use corehbot::settings::ProbeKind;

/// `line` is refused with these words; the bed stays warm, no step is made, and moves and heaters obey as before.
fn changes_nothing(life: &mut Life<'_>, line: &str, why: &str) {
    life.say("M140 S60");
    let (steps, told) = (life.counts(), life.count(&format!("echo:homing failed: {why}")));
    life.say(line);
    assert_eq!(life.count(&format!("echo:homing failed: {why}")), told + 1, "{line}: {:?}", life.heard);
    assert_eq!(life.count("//action:cancel"), 0, "{:?}", life.heard);
    assert_eq!((life.counts(), life.targets()[1]), (steps, 60.0), "{line}");
    for line in ["G91", "G1 X5 F6000", "G90", "M400"] {
        life.say(line);
    }
    assert_ne!(life.counts(), steps, "moves are obeyed after {line}: {:?}", life.heard);
    life.say("M140 S65");
    assert_eq!(life.targets()[1], 65.0);
}

/// Reproducer: it switched all heaters off and locked moves, with no print under way.
#[test]
fn z_alone_is_not_homed_by_the_probe_and_heat_and_moves_stay() {
    begin(&machine(ProbeKind::Switch), |life| {
        let why = "Z is homed at a place in X and Y, and one of them is not homed. Home them too (G28)";
        for line in ["G28 Z", "G28 Z0 X", "G28 Y Z R5", "G28 Z"] {
            changes_nothing(life, line, why);
        }
        life.say("G28 O");
        life.say("G28 Z");
        assert_eq!(life.count("echo:homing failed"), 4, "{:?}", life.heard);
    });
}

#[test]
fn an_axis_without_an_input_is_refused_before_any_axis_moves() {
    let mut s = machine(ProbeKind::Switch);
    begin_with(&s, EndstopSet::X, |life| changes_nothing(life, "G28", "Y has no endstop on this board"));
    s.probe.homes_z = false;
    begin_with(&s, EndstopSet::X.with(EndstopSet::Y), |life| {
        changes_nothing(life, "G28", "Z has no endstop on this board");
        life.say("G28 X Y");
        assert_eq!(life.count("echo:homing failed"), 1, "{:?}", life.heard);
    });
}

/// Reproducer: a file whose first line is a G28 that is refused went on unhomed.
#[test]
fn a_file_whose_first_line_is_refused_ends() {
    begin(&machine(ProbeKind::Switch), |life| {
        for line in ["N0 M110 N0*125", "M140 S60", "N1 G28 Z*104"] {
            life.say(line);
        }
        assert_eq!(life.count("//action:cancel"), 1, "{:?}", life.heard);
        let steps = life.counts();
        for line in ["N2 G1 X50 F6000*55", "N3 M140 S60*80", "M400"] {
            life.say(line);
        }
        assert_eq!((life.counts(), life.targets()[1]), (steps, 0.0), "{:?}", life.heard);
    });
    // Without numbers it may be a button's: what prints then is held.
    begin(&machine(ProbeKind::Switch), |life| {
        for line in ["G28 Z", "M302 P1", "G91", "G1 X5 F6000", "G90", "M400"] {
            life.say(line);
        }
        let steps = life.counts();
        life.put(0, "G1 X50 E1");
        life.rest(2000);
        assert_eq!(life.count("echo:print held: axes are no longer homed"), 1, "{:?}", life.heard);
        assert_eq!(life.counts(), steps);
    });
}

#[test]
fn a_print_does_not_go_on_with_z_at_no_known_height() {
    begin(&machine(ProbeKind::Switch), |life| {
        for line in ["M75", "M140 S60", "G28 Z"] {
            life.say(line);
        }
        assert_eq!(life.count("//action:cancel"), 1, "{:?}", life.heard);
        assert_eq!(life.targets()[1], 0.0);
        // The refused G28 has not begun another print: the stream that still comes moves nothing.
        let steps = life.counts();
        for line in ["G28 Z", "G1 X150 F6000", "M400"] {
            life.say(line);
        }
        assert_eq!(life.counts(), steps, "{:?}", life.heard);
        life.say("G28");
        life.say("G1 X150 F6000");
        life.say("M400");
        assert!((life.nozzle()[0] - 150.0).abs() < 0.01, "{:?}", life.heard);
    });
}
