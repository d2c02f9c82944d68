//! PAUSE, RESUME and CLEAR_PAUSE: M25, M24 and the end of a paused print.

use super::{MINUTE, heated, live, place};
use crate::common::life::Life;

fn print(life: &mut Life<'_>) {
    for line in ["START_PRINT EXTRUDER_TEMP=200 BED_TEMP=40", "G92 E0", "G1 X150 Y150 Z0.2 F6000", "G1 X100 E5 F3000"] {
        life.say(line);
    }
}

/// *Reproducer*: PAUSE was unknown, and the print went on.
#[test]
fn a_print_pauses_for_half_an_hour_and_goes_on_where_it_was() {
    live(&heated(), 1, |life| {
        print(life);
        life.say("PAUSE");
        assert_eq!(place(life, "M114 R"), [10.0, 10.0, 10.2]);
        life.rest(31 * MINUTE);
        assert_eq!(life.targets(), [0.0, 0.0], "heat goes off in a long pause");
        assert!(life.has_power());
        life.say("RESUME");
        assert_eq!(life.targets(), [200.0, 40.0]);
        assert!(life.celsius() > 195.0);
        assert_eq!(place(life, "M114 R"), [100.0, 150.0, 0.2]);
        let (paused, resumed) = (life.count("//action:paused action:pause"), life.count("//action:resumed"));
        assert_eq!((paused, resumed), (1, 1));
        life.say("G1 X50 E8");
        life.say("M400");
        // 2 mm back and forth.
        assert_eq!(life.extruder_steps(), 8 * 400);
    });
}

/// The line of M600 waits for its ok, and its host sends RESUME all the same.
#[test]
fn resume_acts_as_it_arrives() {
    live(&heated(), 1, |life| {
        print(life);
        life.put(0, "M600");
        life.rest(5000);
        life.put(0, "RESUME");
        life.await_ok();
        life.await_ok();
        assert_eq!(life.count("//action:resumed"), 1, "{:#?}", life.heard);
        assert_eq!(place(life, "M114 R"), [100.0, 150.0, 0.2]);
    });
}

#[test]
fn a_paused_print_that_is_cleared_does_not_go_on() {
    live(&heated(), 1, |life| {
        print(life);
        for line in ["PAUSE", "CLEAR_PAUSE", "RESUME"] {
            life.say(line);
        }
        assert_eq!(life.count("//action:resumed"), 0);
        assert_eq!(place(life, "M114 R"), [10.0, 10.0, 10.2], "it stays where it is");
        print(life);
        life.say("END_PRINT");
        life.say("M400");
        assert_eq!(place(life, "M114"), [10.0, 10.0, 10.2]);
    });
}

/// OctoPrint's scripts park too.
#[test]
fn a_host_that_parks_by_itself_leaves_the_place_of_the_print() {
    live(&heated(), 1, |life| {
        print(life);
        for line in ["PAUSE", "G91", "G1 E-2 F1800", "G1 Z10 F600", "G90", "G1 X10 Y10 F6000"] {
            life.say(line);
        }
        assert_eq!(place(life, "M114 R"), [10.0, 10.0, 10.2], "once up, and not twice");
        for line in ["G91", "G1 E2 F1800", "G90", "RESUME", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life, "M114 R"), [100.0, 150.0, 0.2]);
        assert_eq!(life.extruder_steps(), 5 * 400);
    });
}

#[test]
fn a_wait_of_bambu_is_a_pause() {
    live(&heated(), 2, |life| {
        print(life);
        life.put(0, "M400 U1");
        life.rest(MINUTE);
        assert!(life.count("echo:busy: paused for user") > 0);
        life.switch_to(1);
        life.say("RESUME");
        life.switch_to(0);
        life.await_ok();
        assert_eq!(place(life, "M114 R"), [100.0, 150.0, 0.2]);
    });
}

#[test]
fn filament_goes_in_and_out_by_its_lengths_if_the_hotend_is_hot() {
    live(&heated(), 1, |life| {
        life.say("M701");
        assert_eq!((life.extruder_steps(), life.count("echo:filament is not moved: the hotend is too cold")), (0, 1));
        for (line, mm) in [("M109 S200", 0), ("M701 L30", 30), ("M702 U20", 10), ("M603 L300 U5", 10), ("M701", 310)] {
            life.say(line);
            assert_eq!(life.extruder_steps(), mm * 400, "{line}");
        }
        life.say("M702");
        assert_eq!(life.extruder_steps(), 305 * 400);
        // The program counts none of it.
        assert!(life.ask("M114", "X:").contains(" E:0.00"));
    });
}
