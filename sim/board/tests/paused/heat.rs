//! Heat in a pause: it goes off after a time and comes back before the print resumes, and its faults are faults.

use super::{MINUTE, heated, place, print};
use crate::common::life::live;
use corehbot::settings::Settings;
use corehbot::units::Watts;

#[test]
fn heat_goes_off_in_a_long_pause_and_is_waited_for_before_the_print_goes_on() {
    live(&heated(), 1, |life| {
        print(life);
        life.say("M25");
        life.rest(31 * MINUTE);
        assert_eq!(life.count("echo:Heaters off after 30 minutes without use"), 1);
        assert_eq!(life.targets(), [0.0, 0.0]);
        assert!(life.celsius() < 150.0, "{}", life.celsius());
        life.say("M24");
        // Reported and done in this order.
        let nth = |begin: &str| life.heard.iter().position(|line| line.starts_with(begin)).unwrap();
        assert!(nth("echo:Heating again") < nth("//action:resumed"), "{:?}", life.heard);
        assert_eq!(life.targets(), [200.0, 40.0]);
        assert!(life.celsius() > 198.0, "{}", life.celsius());
        assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0]);
    });
}

/// A host that pauses by itself says nothing: its print is silent.
#[test]
fn a_host_that_falls_silent_in_a_print_finds_it_as_it_was() {
    live(&heated(), 1, |life| {
        print(life);
        life.rest(35 * MINUTE);
        assert_eq!(life.targets(), [0.0, 0.0]);
        assert!(life.has_power());
        life.say("G1 X160 E6 F6000");
        life.say("M400");
        assert_eq!(life.count("echo:Heating again"), 1, "{:?}", life.heard);
        assert_eq!(place(life), [160.0, 100.0, 50.0, 6.0]);
        assert!(life.celsius() > 195.0);
    });
}

#[test]
fn a_fault_in_a_pause_halts_as_ever() {
    live(&heated(), 1, |life| {
        print(life);
        life.say("M25");
        life.open_hotend_sensor();
        life.rest(5000);
        assert!(life.count("Error:hotend") >= 1 && life.is_halted(), "{:?}", life.heard);
        assert_eq!(life.duties(), [0, 0]);
    });
    for word in ["M112", "M410"] {
        live(&Settings::prototype(), 1, |life| {
            life.say("G1 X150 E5 F6000");
            life.put(0, "M600");
            life.rest(3000);
            life.put(0, word);
            life.rest(3000);
            assert_eq!(life.is_halted(), word == "M112");
            if word == "M410" {
                life.await_ok();
                life.await_ok();
                life.say("M24");
                assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0], "{:?}", life.heard);
            }
        });
    }
}

#[test]
fn a_wait_for_a_heater_that_does_not_get_there_ends_the_job_and_not_the_machine() {
    let mut settings = heated();
    // A bed of 60 W in a room of 25 C comes to some 42.
    settings.thermal.heaters.bed.power = Watts::from_num(60);
    live(&settings, 1, |life| {
        for line in ["G28", "M104 S150", "M190 S48"] {
            life.say_within(line, 90 * MINUTE);
        }
        assert_eq!(life.count("echo:bed does not get warmer"), 1, "{:?}", life.heard.last());
        assert_eq!(life.count("echo:print ended, heaters are off: bed stays at 4"), 1, "{:?}", life.heard.last());
        assert_eq!((life.count("//action:cancel action:cancel"), life.count("Error:"), life.count("!!")), (1, 0, 0));
        assert_eq!(life.targets(), [0.0, 0.0]);
        // The rest of the stream heats and moves nothing, and one message says so.
        let before = place(life);
        for line in ["M104 S200", "M109 S200", "G1 X50 Y50 E5 F6000", "G10", "M400", "M600"] {
            life.say(line);
        }
        assert_eq!(place(life), before);
        assert_eq!(life.targets(), [0.0, 0.0]);
        assert_eq!(life.count("echo:the print was ended"), 1);
        // The machine is usable.
        for line in ["G28", "G1 X50 F6000", "M140 S30", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life)[0], 50.0);
        assert_eq!(life.targets(), [0.0, 30.0]);
    });
}
