//! Where the tool waits: filament back, up, away, and back again.

use super::{MINUTE, heated, place, print};
use crate::common::life::live;
use corehbot::settings::Settings;

#[test]
fn a_pause_parks_the_tool_and_holds_motors_for_any_time() {
    for minutes in [10, 31, 60] {
        live(&Settings::prototype(), 1, |life| {
            life.say("G1 X150 E5 F6000");
            life.say("M25");
            assert_eq!(place(life), [10.0, 10.0, 60.0, 3.0], "lifted, parked and 2 mm of filament back");
            life.rest(minutes * MINUTE);
            assert!(life.has_power(), "motors hold");
            life.say("M24");
            assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0], "back where the print is");
            assert_eq!((life.count("//action:paused"), life.count("//action:resumed")), (1, 1));
            life.say("G1 X900 F6000");
            life.say("M400");
            assert_eq!(place(life)[0], 390.0, "the ends of the axes are known still");
        });
    }
}

#[test]
fn words_of_the_line_choose_the_place_and_an_unhomed_or_cold_machine_stays() {
    live(&Settings::prototype(), 2, |life| {
        life.say("M125 X200 Y50 Z3 L1");
        assert_eq!(place(life), [200.0, 50.0, 53.0, -1.0]);
        life.say("M24");
        life.say("G1 X110 E5 F6000");
        // The line of M600 is kept, and the other host is served.
        life.put(0, "M600 X30 Z20 E4 N5");
        life.rest(5000);
        assert_eq!(life.count("echo:M600 N is not supported by this firmware"), 1);
        assert!(life.count("echo:busy: paused for user") >= 1, "{:?}", life.heard);
        life.switch_to(1);
        assert_eq!(place(life), [30.0, 10.0, 70.0, 1.0]);
        life.say("M600");
        assert_eq!(life.count("echo:ignored, the print is paused already: send M24 or M108 first"), 1);
        life.say("G1 X40 F6000");
        life.say("M24");
        life.switch_to(0);
        life.await_ok();
        assert_eq!(place(life), [110.0, 100.0, 50.0, 5.0]);
    });
    live(&Settings::prototype(), 1, |life| {
        life.say("M84");
        let before = place(life);
        for line in ["M125", "M24", "M25", "M24"] {
            life.say(line);
        }
        assert_eq!(place(life), before, "an axis that is not homed is not parked");
    });
    live(&heated(), 1, |life| {
        life.say("M125");
        assert_eq!(place(life), [10.0, 10.0, 60.0, 0.0], "cold filament stays");
        life.say("M24");
        assert_eq!(place(life), [100.0, 100.0, 50.0, 0.0]);
    });
}

#[test]
fn a_pause_knows_what_is_retracted_already() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["M207 S3 Z0.4", "G1 X150 E5 F6000", "G10", "M25"] {
            life.say(line);
        }
        assert_eq!(place(life), [10.0, 10.0, 60.4, 2.0], "3 mm are enough");
        life.say("M24");
        assert_eq!(place(life), [150.0, 100.0, 50.4, 2.0], "retracted as before");
        for line in ["G11", "G1 X160 E6", "M25"] {
            life.say(line);
        }
        assert_eq!(place(life), [10.0, 10.0, 60.0, 4.0]);
        // In the pause too, and whatever is left of it.
        for line in ["G10", "M24", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [160.0, 100.0, 50.0, 6.0]);
    });
    // A slicer's retraction and its z-hop.
    live(&Settings::prototype(), 1, |life| {
        for line in ["G1 X150 E5 F6000", "G1 E4.2 F2400", "G1 Z50.4", "G1 X170", "M25"] {
            life.say(line);
        }
        assert_eq!(place(life), [10.0, 10.0, 60.4, 3.0], "2 mm back in all");
        life.say("M24");
        assert_eq!(place(life), [170.0, 100.0, 50.4, 4.2]);
    });
}

#[test]
fn pausing_twice_and_resuming_twice_are_nothing() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["M24", "G1 X150 E5 F6000", "M25", "M25", "M125 X99"] {
            life.say(line);
        }
        assert_eq!(place(life), [10.0, 10.0, 60.0, 3.0]);
        for line in ["M24", "M24", "M602"] {
            life.say(line);
        }
        assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0]);
        assert_eq!(life.count("//action:resumed"), 1);
    });
}

#[test]
fn arcs_and_waits_for_heat_are_finished_before_a_pause() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["G3 X100 Y100 I20 E9 F3000", "M25"] {
            life.say(line);
        }
        assert_eq!(place(life), [10.0, 10.0, 60.0, 7.0]);
        for line in ["M24", "G2 X110 Y100 I5 E10", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [110.0, 100.0, 50.0, 10.0]);
    });
    live(&heated(), 1, |life| {
        print(life);
        // M25 waits its turn behind M109, which M108 may end.
        life.put(0, "M109 S230");
        life.put(0, "M25");
        life.rest(2000);
        life.put(0, "M108");
        life.await_ok();
        life.await_ok();
        life.await_ok();
        life.say("M24");
        assert_eq!(life.targets(), [230.0, 40.0]);
        assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0]);
    });
}

#[test]
fn a_timed_stop_goes_on_by_itself() {
    live(&Settings::prototype(), 1, |life| {
        life.say("G1 X150 E5 F6000");
        life.say("M0 S20");
        assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0]);
        assert_eq!((life.count("//action:prompt_end"), life.count("//action:resumed")), (1, 1));
    });
}
