//! Prints that are paused, held, cancelled and gone on with: the clock runs, and what moves is counted.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

#[path = "common/life.rs"]
mod life;

use corehbot::connectors::Heater;
use corehbot::settings::Settings;
use corehbot::units::Watts;
use life::{Life, live};

const MINUTE: u64 = 60_000;

/// A machine with a hotend and a bed that are warm before anything else.
fn heated() -> Settings {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    // A small one, which warms within seconds.
    settings.thermal.heaters.bed.power = Watts::from_num(1000);
    settings
}

/// Warms the machine up and prints a line; the tool ends at X150 Y100 Z50, E5.
fn print(life: &mut Life<'_>) {
    for line in ["M190 S40", "M109 S200", "G1 X150 E5 F6000", "M400"] {
        life.say(line);
    }
}

/// Where the tool is, and how much filament the extruder has moved, in mm.
fn place(life: &mut Life<'_>) -> [f64; 4] {
    let told = life.ask("M114 R", "X:");
    let number = |letter: &str| {
        let (_, rest) = told.split_once(letter).unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    [number("X:"), number("Y:"), number("Z:"), f64::from(life.extruder_steps()) / 400.0]
}

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
fn heat_goes_off_in_a_long_pause_and_is_waited_for_before_the_print_goes_on() {
    live(&heated(), 1, |life| {
        print(life);
        life.say("M25");
        life.rest(31 * MINUTE);
        assert_eq!(life.count("echo:Heaters off after 30 minutes without use"), 1);
        assert_eq!(life.targets(), [0.0, 0.0]);
        assert!(life.celsius() < 150.0, "{}", life.celsius());
        life.say("M24");
        // Told and done in this order.
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
fn jogging_and_heating_work_in_a_pause_and_the_print_goes_on_where_it_was() {
    live(&heated(), 1, |life| {
        print(life);
        life.say("M25");
        for line in ["G91", "G1 X50 Y20 Z5 F6000", "G90", "G1 Y200", "M83", "G1 E30 F300", "M104 S210"] {
            life.say(line);
        }
        assert_eq!(place(life), [60.0, 200.0, 65.0, 33.0]);
        for line in ["G92 X0", "G20"] {
            life.say(line);
        }
        life.say("M24");
        // Filament that was changed meanwhile is none that the print has asked for.
        assert_eq!(place(life), [150.0, 100.0, 50.0, 35.0]);
        assert_eq!(life.targets(), [210.0, 40.0], "hot enough to print with");
        for line in ["G1 X160 E6 F6000", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [160.0, 100.0, 50.0, 36.0], "absolute, in mm, E5 to E6");
    });
}

#[test]
fn what_a_pause_saves_is_the_whole_state_of_the_program() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["G92 X0 Y0", "M83", "M220 S80", "M221 S90", "M204 P1234", "G18", "G1 X10 E1 F1200", "M25"] {
            life.say(line);
        }
        for line in
            ["G90", "M82", "G92 X0 Y0 Z0 E0", "M220 S100", "M221 S100", "M204 P500", "G17", "G91", "G20", "G1 F9000"]
        {
            life.say(line);
        }
        life.say("M24");
        assert_eq!(life.ask("M220", "FR:"), "FR:80%");
        assert_eq!(life.ask("M221", "echo:E0"), "echo:E0 Flow: 90%");
        assert!(life.ask("M114", "X:").starts_with("X:10.00 Y:0.00 Z:50.00 E:1.00 "), "{:?}", life.heard.last());
        life.say("G1 X20 E1");
        assert!(life.ask("M114", "X:").starts_with("X:20.00 Y:0.00 Z:50.00 E:2.00 "));
        life.say("M503");
        assert_eq!(life.count("echo:  M204 P1234"), 1);
    });
}

/// A pause is a rest and nothing else: all steps before and after it are the same.
#[test]
fn the_steps_after_a_pause_are_those_of_a_print_without() {
    let lines: Vec<String> =
        (1..60).map(|n| format!("G1 X{}.37 Y{}.11 E{}.013", 100 + n % 7 * 3, 100 + n, n)).collect();
    let steps = |pause: &[&str]| {
        let mut after = Vec::new();
        live(&Settings::prototype(), 1, |life| {
            life.say("G1 F6000");
            for line in &lines[..30] {
                life.say(line);
            }
            life.say("M400");
            for line in pause {
                life.say(line);
            }
            life.mark();
            for line in &lines[30..] {
                life.say(line);
            }
            life.say("M400");
            after = life.events();
        });
        after
    };
    let whole = steps(&[]);
    assert!(whole.len() > 1000);
    for pause in [
        &["M25", "M24"][..],
        &["M25", "G91", "G1 X7.77 Z3", "G90", "M24"],
        &["M25", "M24", "M125 X50 Z2 L5", "M24"],
        // A host's own script, around M25 and after it, with its way back.
        &[
            "G91",
            "G1 E-2 F2400",
            "G1 Z10",
            "G90",
            "G1 X0 Y0",
            "M25",
            "M24",
            "G1 X106.37 Y130.11 F6000",
            "G91",
            "G1 Z-10",
            "G1 E2",
            "G90",
            "G1 F6000",
            "M400",
        ],
    ] {
        assert!(whole == steps(pause), "{pause:?}");
    }
}

/// OctoPrint's scripts at a pause and at its end, as its documentation has them, beside M25: they find the work done.
#[test]
fn a_pause_script_of_the_host_neither_retracts_nor_parks_twice() {
    let script = ["M114", "G91", "M83", "G1 E-2 F2400", "G1 Z10", "M82", "G90", "G1 X0 Y0 F6000", "M400"];
    let back = ["M83", "G1 E2 F2400", "M82", "G92 E5", "G1 X150 Y100 F6000", "G1 Z50", "G1 F6000", "M400"];
    live(&Settings::prototype(), 1, |life| {
        life.say("G1 X150 E5 F6000");
        life.say("M25");
        for line in script {
            life.say(line);
        }
        assert!(
            life.heard.iter().any(|line| line.starts_with("X:150.00 Y:100.00 Z:50.00 E:5.00 ")),
            "{:?}",
            life.heard
        );
        assert_eq!(place(life), [0.0, 0.0, 60.0, 3.0], "2 mm back and 10 mm up, once");
        for line in back {
            life.say(line);
        }
        // It goes on without M24.
        for line in ["G1 X160 E6", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [160.0, 100.0, 50.0, 6.0]);
        assert_eq!(life.count("//action:resumed"), 1);
    });
    // The other way round: the script first.
    live(&Settings::prototype(), 1, |life| {
        life.say("G1 X150 E5 F6000");
        for line in &script[1..] {
            life.say(line);
        }
        life.say("M25");
        assert_eq!(place(life), [0.0, 0.0, 60.0, 3.0]);
        life.say("M24");
        for line in back {
            life.say(line);
        }
        assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0]);
    });
}

#[test]
fn words_of_the_line_choose_the_place_and_an_unhomed_or_cold_machine_stays() {
    live(&Settings::prototype(), 2, |life| {
        life.say("M125 X200 Y50 Z3 L1");
        assert_eq!(place(life), [200.0, 50.0, 53.0, -1.0]);
        life.say("M24");
        life.say("G1 X110 E5 F6000");
        // The line of M600 is kept, and the other host is served.
        life.put(0, "M600 X30 Z20 E4 U90");
        life.rest(5000);
        assert_eq!(life.count("echo:M600 U is not obeyed by this firmware"), 1);
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
fn a_line_that_has_lost_its_place_is_held_until_the_axes_are_homed() {
    let mut settings = Settings::prototype();
    settings.require_homing = true;
    live(&settings, 2, |life| {
        for line in ["G28", "G1 Z5 F600", "G1 X50 Y50 E1 F6000"] {
            life.say(line);
        }
        life.switch_to(1);
        life.say("M84 X Y");
        life.switch_to(0);
        // M84 ends the print; who prints on has lost its place.
        life.put(0, "G1 X60 E2");
        life.rest(10_000);
        assert_eq!(life.count("//action:pause action:pause"), 1, "{:?}", life.heard);
        assert_eq!(life.count("echo:print held: axes are not homed any more"), 1);
        assert!(life.count("echo:busy: paused for user") >= 4);
        let oks = life.oks();
        life.switch_to(1);
        life.say("M24");
        life.rest(1000);
        life.switch_to(0);
        assert_eq!((life.oks(), life.count("//action:resumed")), (oks, 0), "not without a home");
        life.switch_to(1);
        life.say("G28 X Y");
        life.say("M24");
        life.switch_to(0);
        life.await_ok();
        life.say("M400");
        assert_eq!(place(life), [60.0, 50.0, 5.0, 2.0], "from where it was");
        assert_eq!(life.count("//action:resumed"), 1);
    });
    // Outside of a print it is refused.
    live(&settings, 1, |life| {
        life.say("G1 X60");
        life.say("G1 E2");
        life.say("M84");
        life.say("G1 X70");
        assert_eq!(life.count("echo:move ignored: home its axes first (G28)"), 1, "{:?}", life.heard);
        assert_eq!(life.count("//action:pause"), 0);
    });
}

#[test]
fn a_cold_line_is_held_and_a_host_that_can_do_nothing_else_is_let_go_by_m108() {
    live(&heated(), 1, |life| {
        // A file for a printer that has a macro.
        life.say("START_PRINT BED=60 EXTRUDER=210");
        life.put(0, "G1 X110 E1 F6000");
        life.rest(5000);
        assert_eq!(life.count("//action:pause action:pause"), 1, "{:?}", life.heard);
        assert_eq!(life.extruder_steps(), 0);
        life.put(0, "M108");
        life.await_ok();
        life.await_ok();
        assert_eq!(life.count("echo:line left out, the print is still paused"), 1, "{:?}", life.heard);
        // The host heats, and its stream goes on.
        life.say("M109 S200");
        life.say("G1 X120 E2 F6000");
        life.say("M400");
        assert_eq!(place(life), [120.0, 100.0, 50.0, 2.0]);
        assert_eq!(life.count("//action:resumed"), 1);
    });
    // With a second host.
    live(&heated(), 2, |life| {
        life.put(0, "G1 X110 E1 F6000");
        life.rest(3000);
        life.switch_to(1);
        life.say("M104 S200");
        life.say("M24");
        life.switch_to(0);
        life.await_ok();
        life.say("M400");
        assert!(life.celsius() > 195.0, "{}", life.celsius());
        assert_eq!(place(life), [110.0, 100.0, 50.0, 1.0]);
    });
    // This is no print: it is left out, as ever.
    live(&heated(), 1, |life| {
        life.say("G1 E5 F300");
        assert_eq!(life.count("echo: cold extrusion prevented"), 1);
    });
}

#[test]
fn a_macro_that_is_not_there_homes_nothing() {
    live_unhomed(|life| {
        life.say("PRINT_START BED_TEMP=60");
        life.put(0, "G1 X110 E1 F6000");
        life.rest(3000);
        assert_eq!(life.count("echo:print held: axes are not homed any more"), 1, "{:?}", life.heard);
        life.put(0, "M524");
        life.await_ok();
        life.await_ok();
        assert_eq!(life.count("//action:cancel action:cancel"), 1);
        assert_eq!(life.extruder_steps(), 0);
    });
    // Without the macro it is told, as ever: there are machines without switches.
    live_unhomed(|life| {
        life.say("G1 X10 E1 F6000");
        assert_eq!(life.count("echo:motion before homing"), 1);
    });
}

fn live_unhomed(body: impl FnOnce(&mut Life<'_>)) {
    life::live_at(&Settings::prototype(), None, 1, body);
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
        assert_eq!(life.count("echo:bed gets no warmer"), 1, "{:?}", life.heard.last());
        assert_eq!(life.count("echo:print ended, heaters are off: bed stays at 4"), 1, "{:?}", life.heard.last());
        assert_eq!((life.count("//action:cancel action:cancel"), life.count("Error:"), life.count("!!")), (1, 0, 0));
        assert_eq!(life.targets(), [0.0, 0.0]);
        // The rest of the stream heats and moves nothing, and is told so once.
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

#[test]
fn a_timed_stop_goes_on_by_itself() {
    live(&Settings::prototype(), 1, |life| {
        life.say("G1 X150 E5 F6000");
        life.say("M0 S20");
        assert_eq!(place(life), [150.0, 100.0, 50.0, 5.0]);
        assert_eq!((life.count("//action:prompt_end"), life.count("//action:resumed")), (1, 1));
    });
}

/// printcore says nothing when it pauses; what it says before it goes on is from its source (printcore.py 2.2.0, `resume`).
#[test]
fn printcore_pauses_for_an_hour_and_goes_on() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["G28", "G1 Z5 F600", "G1 X50 Y50 E3 F3000", "M400"] {
            life.say(line);
        }
        life.rest(60 * MINUTE);
        for line in ["G90", "G1 X50.0 Y50.0 F6000", "G1 Z5.0 F600", "G92 E3.0", "G90", "M82", "G1 F3000.0"] {
            life.say(line);
        }
        for line in ["G1 X60 E4", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [60.0, 50.0, 5.0, 4.0]);
        assert_eq!(life.count("//action") + life.count("echo:motion"), 0, "{:?}", life.heard);
    });
}

/// OctoPrint cancels while a line is held: M108 out of band, and its script after the `ok` that this brings (comm.py 1.11.8,
/// `cancelPrint`; the script as it is delivered).
#[test]
fn octoprint_cancels_a_print_that_is_held_and_prints_again() {
    live(&heated(), 1, |life| {
        life.say("N0 M110 N0*125");
        life.put(0, "G1 X110 E1 F6000");
        life.rest(3000);
        life.put(0, "M108");
        life.await_ok();
        life.await_ok();
        for line in ["M400", "M114", "M84", "M104 T0 S0", "M140 S0", "M106 S0"] {
            life.say(line);
        }
        assert_eq!(life.targets(), [0.0, 0.0]);
        for line in ["N0 M110 N0*125", "G28", "M109 S200", "G1 X110 E1 F6000", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [110.0, 0.0, 0.0, 1.0]);
        assert_eq!(life.count("//action:pause action:pause"), 1);
    });
}

/// Storms of pauses and ends in any order leave a machine that prints.
#[test]
fn any_order_of_pauses_and_ends_leaves_a_machine_that_prints_the_same() {
    const WORDS: [&str; 16] = [
        "M25",
        "M24",
        "M602",
        "M125",
        "M108",
        "G10",
        "G11",
        "M84 E",
        "M75",
        "M77",
        "G91",
        "G90",
        "G1 X5 Z1 E1 F6000",
        "M110 N0",
        "G28 X",
        "M524",
    ];
    let mut seed = 7_u32;
    for round in 0..60 {
        live(&Settings::prototype(), 1, |life| {
            let mut said = Vec::new();
            for _ in 0..12 {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let word = WORDS[(seed >> 16) as usize % WORDS.len()];
                said.push(word);
                life.say(word);
            }
            for line in
                ["M108", "M24", "M84", "N0 M110 N0*125", "G28", "G90", "M82", "G21", "G92 E0", "M220 S100", "M221 S100"]
            {
                life.say(line);
            }
            life.mark();
            for line in ["G1 X50 Y50 Z1 E3 F3000", "G1 X80 E5", "M400"] {
                life.say(line);
            }
            assert_eq!(life.extruder_since_mark(), 5 * 400, "{round}: {said:?}");
            assert_eq!(place(life)[..3], [80.0, 50.0, 1.0], "{round}: {said:?}");
        });
    }
}
