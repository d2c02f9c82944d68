//! Prints that end while they are paused, and the state that the next print finds.

use super::{MINUTE, heated, place, print};
use crate::common::life::live;
use corehbot::settings::Settings;
use corehbot::units::Mm;

/// Cancelled while parked, and printed again: the second print is the first one.
#[test]
fn a_cancel_while_parked_leaves_nothing_to_the_next_print() {
    let file = ["G28", "G90", "M82", "G92 E0", "G1 Z0.3 F600", "G1 X50 Y50 E3 F3000", "G1 X80 E5", "M400"];
    let steps = |before: &[&[&str]]| {
        let mut events = Vec::new();
        live(&Settings::prototype(), 1, |life| {
            life.say("N0 M110 N0*125");
            for life_before in before {
                for line in *life_before {
                    life.say(line);
                }
                life.say("G28");
                life.say("N0 M110 N0*125");
            }
            life.say("G28");
            life.mark();
            for line in &file[1..] {
                life.say(line);
            }
            assert_eq!(life.extruder_since_mark(), 5 * 400, "{before:?}");
            events = life.events();
        });
        events
    };
    let first = steps(&[]);
    let begin = ["G91", "M83", "G20", "M221 S50", "M220 S50", "G92 X5 Y5 Z5 E5", "G1 X.5 E.1 F300", "M25"];
    for cancel in
        [&["M84", "M104 S0", "M140 S0", "M106 S0"][..], &["M524"], &["M104 S0", "G28 X Y", "M84"], &["G10", "M77"], &[]]
    {
        assert!(first == steps(&[&[&begin[..], cancel].concat()]), "{cancel:?}");
    }
    // A print that ended as it should, with its filament pulled back.
    assert!(first == steps(&[&["M207 S4 Z1", "G1 X50 E1", "G10", "M84"], &["G1 X50 E1", "G10"]]));
}

/// The question comes in one packet with the cancel, and behind it.
#[test]
fn a_cancelled_print_tells_no_target_that_it_had() {
    live(&heated(), 1, |life| {
        print(life);
        let targets = life.ask("M105", "ok T:");
        assert!(targets.contains("/200.00") && targets.contains("/40.00"), "{targets}");
        let before = life.count("ok T:");
        life.put(0, "M524\nM105");
        life.await_ok();
        life.await_ok();
        for _ in 0..100 {
            life.say("M105");
            life.rest(1);
        }
        let told: Vec<_> = life.heard.iter().filter(|line| line.starts_with("ok T:")).skip(before).collect();
        assert_eq!(told.len(), 101);
        assert!(told.iter().all(|line| line.matches("/0.00").count() == 2), "{told:?}");
    });
}

/// Homing fails: in a print it ends the print. In a pause the print waits for the cure.
#[test]
fn homing_that_fails_ends_a_print_and_keeps_a_pause() {
    let mut settings = heated();
    settings.axes.x.length = Mm::from_num(20);
    // Far beyond the end of its axis: each search for the switch ends 30 mm nearer.
    let begin = ["G28", "G28", "G28", "G28", "M140 S60", "M302 P1", "M211 S0", "G1 X100 Y5 Z5 E5 F6000", "M400"];
    live(&settings, 1, |life| {
        for line in [&begin[..], &["M25", "G1 X100"]].concat() {
            life.say_within(line, MINUTE);
        }
        life.say("G28 X");
        let stays =
            "Check its switch, its plug and its wire. The print stays paused: home again (G28), then continue it";
        let told = format!("echo:homing failed: X endstop was not met within 30 mm. {stays}");
        assert_eq!(life.count(&told), 1, "{:?}", life.heard);
        let cancelled = life.count("//action:cancel");
        assert_eq!(life.targets(), [0.0, 60.0]);
        // It cannot continue without its place.
        let resumed = life.count("//action:resumed");
        life.say("M24");
        assert_eq!(life.count("//action:resumed"), resumed, "{:?}", life.heard);
        for _ in 0..3 {
            life.say("G28 X");
        }
        life.say("G28 Y");
        life.say("M24");
        life.say("G1 X15 E6");
        life.say("M400");
        assert_eq!(life.count("//action:resumed"), resumed + 1, "{:?}", life.heard);
        assert_eq!(place(life), [15.0, 5.0, 5.0, 6.0]);
        assert_eq!(life.count("//action:cancel"), cancelled);
    });
    live(&settings, 1, |life| {
        for line in begin {
            life.say_within(line, MINUTE);
        }
        let ended = "echo:print ended, heaters are off: homing failed: X endstop was not met";
        let before = life.count(ended);
        life.say("G28 X");
        assert_eq!(life.count(ended), before + 1);
        assert_eq!(life.count("Error:"), 0, "{:?}", life.heard);
        life.say("G1 X15 E6");
        assert_eq!((life.count("echo:the print was ended"), life.targets()), (1, [0.0, 0.0]));
        // The same file again, once the axis homes.
        for _ in 0..3 {
            life.say("G28");
        }
        for line in begin {
            life.say_within(line, MINUTE);
        }
        assert_eq!((place(life), life.targets()), ([100.0, 5.0, 5.0, 5.0], [0.0, 60.0]), "{:?}", life.heard);
    });
}

#[test]
fn a_retraction_does_not_outlive_its_print() {
    for end in ["G28", "M84", "N0 M110 N0*125"] {
        live(&Settings::prototype(), 1, |life| {
            for line in ["M207 S3 Z1", "G1 X110 E5 F6000", "G10", end, "G11", "G28"] {
                life.say(line);
            }
            life.mark();
            for line in ["G92 E0", "G1 X120 E2 F6000", "G10", "G11", "M400"] {
                life.say(line);
            }
            assert_eq!(life.extruder_since_mark(), 2 * 400, "{end}");
            assert_eq!(place(life)[2], 0.0, "{end}");
        });
    }
}

#[test]
fn motors_lose_their_power_when_the_print_is_over() {
    for end in [&["M84 S600", "M77"][..], &["M104 S0"]] {
        live(&heated(), 1, |life| {
            life.say("M302 P1");
            life.say("G1 X150 E5 F6000");
            for line in end {
                life.say(line);
            }
            life.rest(11 * MINUTE);
            assert!(!life.has_power(), "{end:?}");
        });
    }
    // A print without an end holds them for half a day.
    live(&Settings::prototype(), 1, |life| {
        life.say("G1 X150 E5 F6000");
        life.rest(61 * MINUTE);
        assert!(life.has_power());
    });
}
