//! Hosts and their scripts, around a pause and in it.

use super::{MINUTE, heated, place};
use crate::common::life::{Life, live};
use crate::support::hosts::{Host, Pauses, Printcore};
use crate::support::octoprint::OctoPrint;
use corehbot::settings::Settings;

/// OctoPrint's scripts at a pause and at its end, as its documentation has them, in addition to M25: they find the work
/// done.
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
        // It resumes without M24.
        for line in ["G1 X160 E6", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [160.0, 100.0, 50.0, 6.0]);
        assert_eq!(life.count("//action:resumed"), 1);
    });
    // In the opposite order: the script first.
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

/// A print that heats and changes its filament, which both models of hosts send.
const PRINT: [&str; 10] =
    ["G28", "G90", "M82", "G92 E0", "M109 S200", "G1 Z0.3 F600", "G1 X50 Y50 E3 F3000", "M600", "G1 X80 E5", "M400"];

/// printcore and OctoPrint as their sources have them (tests/support), with their M110 and their lines on cancel. The
/// host waits before each line of the print.
fn models(pauses: &[u32]) -> [(Box<dyn Host>, &'static str, &'static [&'static str]); 2] {
    let program = || PRINT.map(str::to_owned).to_vec();
    let cancel: &[&str] = &["M108", "M400", "M114", "M84", "M104 T0 S0", "M140 S0", "M106 S0"];
    [
        (Box::new(Printcore::new(program(), Pauses(pauses.to_vec()))), "M110 N-1", &["M108"]),
        (Box::new(OctoPrint::new(program(), Pauses(pauses.to_vec()))), "M110 N0", cancel),
    ]
}

/// The host prints, and `happens` runs in every ms; it returns whether to end.
fn drive(life: &mut Life<'_>, host: &mut dyn Host, mut happens: impl FnMut(&mut Life<'_>) -> bool) {
    let (mut seen, mut ms) = (life.heard.len(), 0);
    while !host.is_done() && !happens(life) {
        life.heard[seen..].iter().for_each(|line| host.hear(line));
        seen = life.heard.len();
        if let Some(line) = host.speak(ms) {
            life.put(0, &line);
        }
        life.rest(1);
        ms += 1;
        assert!(ms < 3_600_000, "{:?}", &life.heard[life.heard.len().saturating_sub(20)..]);
    }
    // The model of OctoPrint gives up waiting for an `ok` after 30 s, `busy` or not, and then sends ahead.
    for _ in 0..40_000 {
        if happens(life) {
            return;
        }
        life.rest(1);
    }
}

/// The user resumes from a screen after this many reports that the printer waits.
fn change_filament(life: &mut Life<'_>, reports: usize) -> bool {
    if life.heard.last().is_some_and(|line| line == "echo:busy: paused for user")
        && life.count("echo:busy: paused for user").is_multiple_of(reports)
    {
        life.switch_to(1);
        life.say("M24");
        life.switch_to(0);
    }
    false
}

#[test]
fn both_models_of_hosts_print_through_a_change_of_filament_and_a_pause_of_their_own() {
    // The line behind M600 comes after 20 s, and in printcore after more than half an hour.
    for (place_of_model, ms) in [(0, 20_000), (0, 2_100_000), (1, 20_000)] {
        live(&heated(), 2, |life| {
            let mut pauses = [0; 10];
            pauses[8] = ms;
            let [printcore, octoprint] = models(&pauses);
            let (mut host, number, _) = if place_of_model == 0 { printcore } else { octoprint };
            life.say(number);
            drive(life, &mut *host, |life| change_filament(life, 10));
            assert_eq!(life.extruder_steps(), 5 * 400, "{place_of_model} {ms}");
            assert_eq!(life.count("//action:resumed"), 1);
            assert_eq!(life.count("echo:Heating again"), usize::from(ms > 1_800_000), "{:?}", life.heard);
            assert_eq!(life.count("Error") + life.count("!!") + life.count("Resend"), 0, "{:?}", life.heard);
            life.forget_answers();
            assert_eq!(place(life)[..2], [80.0, 50.0]);
        });
    }
}

#[test]
fn both_models_of_hosts_cancel_while_the_printer_waits_and_print_again() {
    for place_of_model in [0, 1] {
        live(&heated(), 2, |life| {
            for cancelled in [true, true, false] {
                let [printcore, octoprint] = models(&[]);
                let (mut host, number, cancel) = if place_of_model == 0 { printcore } else { octoprint };
                life.forget_answers();
                life.say(number);
                life.mark();
                let waits = life.count("echo:busy: paused for user");
                if cancelled {
                    drive(life, &mut *host, |life| life.count("echo:busy: paused for user") > waits);
                    life.put(0, cancel[0]);
                    life.rest(10_000);
                    life.forget_answers();
                    cancel[1..].iter().for_each(|line| life.say(line));
                } else {
                    drive(life, &mut *host, |life| change_filament(life, 1));
                    assert_eq!(life.extruder_since_mark(), 5 * 400, "{place_of_model}");
                    life.forget_answers();
                    assert_eq!(place(life)[..2], [80.0, 50.0]);
                }
                assert_eq!(life.count("Error") + life.count("!!") + life.count("Resend"), 0, "{:?}", life.heard);
            }
        });
    }
}

/// printcore sends nothing when it pauses; its lines before it resumes are from its source (printcore.py 2.2.0,
/// `resume`).
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

/// OctoPrint cancels while a line is held: M108 out of band, and its script after the `ok` that this brings (comm.py
/// 1.11.8, `cancelPrint`; the script as it is delivered).
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
