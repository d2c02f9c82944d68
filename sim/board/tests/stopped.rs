//! What M108, M410 and M524 end is told, in one text, and what they end is at rest.

use crate::common::heated::heated;
use crate::common::life::{Life, live};
use crate::common::on_bed::{over, with_probe};
use corehbot::accelerometer::SensorKind;
use corehbot::motors::EndstopSet;
use corehbot_sim::bed_plant;
use corehbot_sim::eeprom::Eeprom;

const CANCELLED: &str = "echo:cancelled, heaters are off";

/// A line on its way for so long, and then a word that ends it. Returns what was told in the meantime.
fn end(life: &mut Life<'_>, line: &str, ms: u64, word: &str) -> Vec<String> {
    let (oks, told) = (life.oks(), life.heard.len());
    life.put(0, line);
    life.rest(ms);
    assert_eq!(life.oks(), oks, "{line} is over: {:?}", life.heard);
    life.put(0, word);
    life.put(0, "M105");
    life.rest(500);
    assert_eq!(life.oks(), oks + 3, "{line}, {word}: {:?}", life.heard);
    life.forget_answers();
    life.heard.split_off(told)
}

/// Reproducer: M410 and M108 were answered at once, and the bed went on at full power for seconds, without a word.
/// M524 had two texts.
#[test]
fn a_self_test_is_ended_at_once_by_each_of_them_and_told_once() {
    for (word, text) in [
        ("M108", "echo:Self-test ended"),
        ("M410", "echo:SELF_TEST was ended by M410"),
        ("M524", "echo:print cancelled, heaters are off"),
    ] {
        live(&heated(), 1, |life| {
            life.put(0, "M105");
            life.rest(1000);
            let told = end(life, "SELF_TEST", 2000, word);
            assert_eq!(life.duties(), [0, 0], "{word}");
            life.rest(3000);
            assert_eq!(life.duties(), [0, 0], "{word}");
            // The report behind it knows of it.
            assert!(told.iter().rfind(|line| line.starts_with("ok T:")).unwrap().ends_with(" @:0 B@:0"), "{told:?}");
            let told: Vec<_> = told.iter().filter(|line| line.starts_with("echo:") && !line.contains("busy")).collect();
            assert_eq!(told, [text]);
            assert_eq!(life.count("echo:Self-test"), 0, "{word}: {:?}", life.heard);
        });
    }
}

/// Reproducer: only touches were told, and by another name than the line's.
#[test]
fn a_command_that_m410_ends_is_named_as_it_was_sent() {
    let mut s = with_probe(heated());
    s.accelerometer.kind = Some(SensorKind::Adxl345);
    let bed = bed_plant::read("bowl=0.2", &s).unwrap();
    for line in [
        "M303 E0 S150 C3",
        "M306 E0 T",
        "TEST_RESONANCES AXIS=X",
        "SHAPER_CALIBRATE",
        "M915",
        "M109 S150",
        "G4 S30",
        "G29",
        "BED_MESH_CALIBRATE",
        "Z_TILT_ADJUST",
    ] {
        over(&s, &bed, &mut Eeprom::blank(), |life| {
            let (oks, told) = (life.oks(), life.heard.len());
            life.put(0, line);
            life.rest(1000);
            assert_eq!(life.oks(), oks, "{line} is over: {:?}", life.heard);
            life.put(0, "M410");
            life.rest(2000);
            let told: Vec<_> = life.heard[told..].iter().filter(|line| line.contains(" ended")).collect();
            let name = line.split(' ').next().unwrap();
            assert_eq!(told, [&format!("echo:{name} was ended by M410")], "{line}: {:?}", life.heard);
            assert_eq!(life.oks(), oks + 2, "{line}");
        });
    }
}

/// Reproducer: heaters went off, and moves ended, with a bare `ok`.
#[test]
fn a_cancel_without_a_print_is_told_and_ends_no_print() {
    live(&heated(), 1, |life| {
        life.say("M104 S200");
        life.say("M140 S60");
        life.rest(3000);
        assert!(life.duties()[0] > 0);
        life.put(0, "M524");
        life.put(0, "M105");
        life.await_ok();
        life.await_ok();
        // The report behind it knows of it, targets and duties.
        let report = life.heard.iter().rfind(|line| line.starts_with("ok T:")).unwrap();
        assert!(report.matches(" /0.00").count() == 2 && report.ends_with(" @:0 B@:0"), "{report}");
        assert_eq!((life.targets(), life.count(CANCELLED)), ([0.0, 0.0], 1), "{:?}", life.heard);
        life.say("G1 X200 F3000");
        life.rest(200);
        life.say("M524");
        assert_eq!(life.count(CANCELLED), 2, "{:?}", life.heard);
        // The next line moves.
        life.say("G1 X110 F6000");
        assert!(life.ask("M114", "X:").starts_with("X:110.00 "), "{:?}", life.heard);
        assert_eq!(life.count("//action:cancel"), 0);
        // A print is told as one, once.
        life.say("M75");
        life.say("M524");
        life.say("M524");
        assert_eq!([life.count(CANCELLED), life.count("echo:print cancelled")], [2, 1], "{:?}", life.heard);
    });
}

/// A job that has ended may keep its heat (`job.keep_heat`): a cancel takes it, and tells that.
#[test]
fn a_cancel_behind_the_end_of_a_job_tells_that_its_heat_goes() {
    let mut s = heated();
    s.job.keeps_heat = true;
    live(&s, 1, |life| {
        life.say("M75");
        life.say("M104 S100");
        life.unplug(EndstopSet::X);
        life.say("G28 X");
        assert_eq!((life.count("echo:print ended, heaters stay on"), life.targets()), (1, [100.0, 0.0]));
        life.say("M524");
        life.say("M524");
        assert_eq!((life.count(CANCELLED), life.targets()), (1, [0.0, 0.0]), "{:?}", life.heard);
    });
}

/// Reproducer: the offset of 5 mm was called out of its range of 5 mm.
#[test]
fn shifts_of_z_that_are_too_large_together_are_called_so() {
    live(&heated(), 1, |life| {
        for line in ["G28", "SET_GCODE_OFFSET Z=-1", "G1 Z1 F1200", "SET_GCODE_OFFSET Z=5 MOVE=1"] {
            life.say(line);
        }
        let told = ["the offset of Z would be", "the shifts of Z since homing would"];
        assert_eq!(told.map(|text| life.count(&format!("echo:ignored: {text}"))), [0, 1], "{:?}", life.heard);
        life.say("SET_GCODE_OFFSET Z=6 MOVE=1");
        assert_eq!(told.map(|text| life.count(&format!("echo:ignored: {text}"))), [1, 1], "{:?}", life.heard);
        life.say("G28 Z");
        life.say("SET_GCODE_OFFSET Z=5 MOVE=1");
        assert_eq!(life.count("echo:ignored"), 2, "{:?}", life.heard);
    });
}

/// Reproducer: it said that the stored mesh was forgotten.
#[test]
fn a_profile_is_not_saved_without_a_mesh() {
    let s = with_probe(heated());
    let bed = bed_plant::read("bowl=0.2", &s).unwrap();
    over(&s, &bed, &mut Eeprom::blank(), |life| {
        life.say("G29 J");
        life.say("BED_MESH_PROFILE SAVE=foo");
        assert_eq!((life.count("echo:Invalid mesh"), life.count("echo:Stored mesh")), (1, 0), "{:?}", life.heard);
    });
}

/// A letter of an axis that there is not: settings obey the rest of the line, motion none of it.
#[test]
fn letters_of_other_axes_refuse_motion_and_no_setting() {
    live(&heated(), 1, |life| {
        for line in
            ["M201 X5000 Y5000 W1:2", "M203 X250 Y250 A1:2", "M92 X80 Y80 V1", "M906 X700 U1:2", "M851 Z-1.5 W1"]
        {
            life.say(line);
        }
        assert_eq!(life.count("echo:line ignored"), 0, "{:?}", life.heard);
        for (ask, told) in [("M201", " X5000 "), ("M203", " X250 ")] {
            assert!(life.ask(ask, "  M20").contains(told), "{:?}", life.heard);
        }
        for line in ["G0 W5", "G1 X5 U1", "G92 C0", "M17 W", "M18 V"] {
            life.say(line);
        }
        assert_eq!(life.count("echo:line ignored: there is no axis"), 5, "{:?}", life.heard);
    });
}

/// Reproducer: a line that waits for its continuation was kept beyond the halt, and its host got no answer any more.
#[test]
fn a_halt_during_a_pause_leaves_its_host_answered() {
    for line in ["M600", "M0", "M1", "M601", "M25", "M125"] {
        live(&heated(), 1, |life| {
            life.put(0, line);
            life.rest(3000);
            life.put(0, "M112");
            life.rest(100);
            assert!(life.is_halted(), "{line}");
            let errors = life.count("Error:");
            life.put(0, "M105");
            life.put(0, "G1 X50");
            life.rest(100);
            assert_eq!(life.count("Error:"), errors + 2, "{line}: {:?}", life.heard);
            life.put(0, "N0 M110 N0*125");
            life.put(0, "M105");
            life.rest(100);
            assert_eq!(life.count("echo:Printer halted. Send M999 or reset"), 1, "{line}: {:?}", life.heard);
            assert_eq!(life.count("ok T:"), 1, "{line}: {:?}", life.heard);
        });
    }
}
