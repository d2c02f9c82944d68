//! Places that lines go back to: G27, G60 and G61, SAVE_GCODE_STATE and RESTORE_GCODE_STATE.

use super::{live, place};
use crate::common::life::{Life, live_at};
use corehbot::settings::Settings;

/// Whether a line moves a screw of z before the motor that follows x + y.
fn goes_up_first(life: &mut Life<'_>, line: &str) -> bool {
    life.say("M400");
    life.mark();
    life.say(line);
    life.say("M400");
    let events = life.events();
    let first = |motor: usize| events.iter().position(|(_, steps, _)| steps & 1 << motor != 0);
    let (z, x) = (first(4).expect("z moves"), first(1).expect("x and y move"));
    z < x
}

#[test]
fn the_tool_goes_back_to_a_saved_place_and_over_what_is_between() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["G1 X200 Y150 Z20 F12000", "G60", "G1 X50 Y60 Z80", "G60 S1"] {
            life.say(line);
        }
        assert!(!goes_up_first(life, "G61 F6000"), "down comes last");
        assert_eq!(place(life, "M114 R"), [200.0, 150.0, 20.0]);
        assert!(goes_up_first(life, "G61 S1"), "up comes first");
        assert_eq!(place(life, "M114 R"), [50.0, 60.0, 80.0]);
        life.say("G61 X5");
        assert_eq!(place(life, "M114 R"), [205.0, 60.0, 80.0], "an axis, and more");
        life.say("G60 D");
        life.say("G61");
        assert_eq!(life.count("echo:ignored: nothing is saved by that name"), 1);
    });
}

#[test]
fn g27_parks_once_it_is_homed() {
    live(&Settings::prototype(), 1, |life| {
        assert!(goes_up_first(life, "G27"));
        assert_eq!(place(life, "M114"), [10.0, 10.0, 60.0]);
        for (line, at) in [("G27 P3", [10.0, 10.0, 70.0]), ("G27 P4", [10.0, 10.0, 70.0])] {
            life.say(line);
            assert_eq!(place(life, "M114"), at);
        }
        life.say("G1 X100 Y100 Z330 F12000");
        life.say("G27");
        assert_eq!(place(life, "M114"), [10.0, 10.0, 335.0], "no higher than its axis");
    });
    live_at(&Settings::prototype(), None, 1, |life| {
        life.say("G27");
        assert_eq!(life.count("echo:move ignored: home its axes first (G28)"), 1);
        assert_eq!(life.counts(), [0; corehbot::motors::MOTORS]);
    });
}

#[test]
fn a_saved_state_has_modes_and_zeros_and_its_place_if_that_is_wanted() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["M83", "G92 X0 Y0 E3", "G1 F1200", "SAVE_GCODE_STATE NAME=here"] {
            life.say(line);
        }
        for line in ["G91", "M82", "G20", "G1 X1 Y1 F9000", "G92 X7 Y7 Z7 E9", "RESTORE_GCODE_STATE NAME=HERE"] {
            life.say(line);
        }
        // Absolute again, in mm, by the zero before.
        assert_eq!(place(life, "M114"), [25.4, 25.4, 50.0]);
        life.say("G1 X10 Y10 E1");
        life.say("M400");
        assert_eq!(place(life, "M114 R"), [10.0, 10.0, 50.0]);
        assert!(life.ask("M114", "X:").contains(" E:4.00"), "E counts on from there, relative");
        life.say("RESTORE_GCODE_STATE NAME=HERE MOVE=1 MOVE_SPEED=100");
        assert_eq!(place(life, "M114 R"), [0.0, 0.0, 50.0]);
        life.say("RESTORE_GCODE_STATE NAME=there");
        assert_eq!(life.count("echo:ignored: nothing is saved by that name"), 1);
    });
}
