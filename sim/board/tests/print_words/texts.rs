//! The owner's texts.

use super::{MINUTE, heated, is_sound, live_with_texts, place};
use crate::common::life::Life;

/// Counts its calls on the bed's target, says what it is given, and moves.
const TEXTS: &str = "START_PRINT\nM140 S{BED}\nM109 S{EXTRUDER:200}\nG28\nPURGE LENGTH={PURGE:10}\n\n\
    PURGE\nG91\nG1 Z5 F600\nM83\nG1 E{LENGTH} F300\nG1 X{SIDE:20} E2 F3000\n\n\
    END_PRINT\nM104 S0\nM140 S0\nG91\nG1 Z10 F600\n\n\
    A\nB\n\nB\nC\n\nC\nM118 deep\n\nD\nA\n\nLOOP\nM118 round\nLOOP\n\n\
    PAUSE\nM118 own pause\nPAUSE\nG91\nG1 Z3 F600\nG90\nG1 X300 Y300 F9000\n\n\
    RESUME\nM118 own resume\nRESUME\n\n\
    CANCEL_PRINT\nM118 own cancel\nG91\nG1 Z7 F600\n\n\
    ASK\nM118 before\nM0\nM118 after\n\nBAD\nFOO_BAR X=1\nM118 goes on\n\n";

fn live(hosts: usize, body: impl FnOnce(&mut Life<'_>)) {
    live_with_texts(&heated(), TEXTS, hosts, body);
}

#[test]
fn a_text_replaces_what_is_built_in_and_its_modes_end_with_it() {
    live(1, |life| {
        for _ in 0..2 {
            let (oks, filament) = (life.oks(), life.extruder_steps());
            life.say("START_PRINT BED=40 EXTRUDER=205 PURGE=5");
            assert_eq!(life.oks(), oks + 1, "one ok for the caller");
            assert_eq!(life.targets(), [205.0, 40.0]);
            assert_eq!(place(life, "M114"), [20.0, 0.0, 5.0]);
            assert_eq!(life.extruder_steps() - filament, 7 * 400);
            // Absolute again.
            life.say("G1 X50 F6000");
            assert_eq!(place(life, "M114")[0], 50.0);
            life.say("END_PRINT");
            assert_eq!(place(life, "M114")[2], 15.0);
            assert_eq!(life.targets(), [0.0, 0.0]);
        }
        is_sound(life);
    });
}

#[test]
fn a_word_that_is_missing_refuses_the_call_before_anything_moves() {
    live(1, |life| {
        let before = life.counts();
        for (line, why) in [
            ("START_PRINT", "echo:START_PRINT ignored: BED= is missing"),
            ("START_PRINT EXTRUDER=200", "echo:START_PRINT ignored: BED= is missing"),
            ("PURGE LENGTH={X}", "echo:PURGE ignored: LENGTH= needs a plain word of at most 24 characters"),
            ("PURGE LENGTH=\"5 X300\"", "echo:PURGE ignored: LENGTH= needs a plain word of at most 24 characters"),
            (
                "PURGE LENGTH=1234567890123456789012345",
                "echo:PURGE ignored: LENGTH= needs a plain word of at most 24 characters",
            ),
            ("PURGE LENGTH", "echo:line ignored: \"LENGTH\" is not a name with = and a number"),
        ] {
            life.heard.clear();
            life.say(line);
            assert_eq!(life.count(why), 1, "{line}: {:#?}", life.heard);
        }
        assert_eq!(life.counts(), before);
    });
}

#[test]
fn texts_call_each_other_three_deep_and_never_themselves() {
    live(1, |life| {
        life.say("A");
        assert_eq!(life.count("deep"), 1, "{:#?}", life.heard);
        life.say("D");
        assert_eq!(life.count("echo:C ignored: texts call each other more than 3 deep"), 1, "{:#?}", life.heard);
        life.say("LOOP");
        assert_eq!((life.count("round"), life.count("echo:ignored: a text calls itself")), (1, 1));
        // It is as before.
        life.say("a");
        assert_eq!(life.count("deep"), 2);
        life.say("BAD");
        assert_eq!(life.count("echo:a text has an unknown command: \"FOO_BAR X=1\""), 1);
        assert_eq!(life.count("goes on"), 1);
    });
}

/// The owner's PAUSE and RESUME, half an hour apart: the print goes on to a step where it was.
#[test]
fn a_pause_with_a_text_goes_back_to_the_place_of_the_print() {
    live(1, |life| {
        for line in ["M140 S40", "M109 S200", "M75", "G92 E0", "G1 X150 Y150 E5 F6000", "PAUSE"] {
            life.say(line);
        }
        assert_eq!((life.count("own pause"), life.count("//action:paused action:pause")), (1, 1));
        assert_eq!(place(life, "M114 R"), [300.0, 300.0, 63.0]);
        life.say("PAUSE");
        assert_eq!(life.count("own pause"), 1, "it is paused already");
        life.rest(31 * MINUTE);
        life.say("RESUME");
        assert_eq!((life.count("own resume"), life.count("//action:resumed")), (1, 1));
        assert_eq!(place(life, "M114 R"), [150.0, 150.0, 50.0]);
        life.say("RESUME");
        assert_eq!(life.count("own resume"), 1, "nothing is paused");
        life.say("G1 X100 E8");
        life.say("M400");
        assert_eq!(life.extruder_steps(), 8 * 400);
    });
}

#[test]
fn a_cancel_ends_a_text_and_then_runs_its_own() {
    live(1, |life| {
        life.put(0, "START_PRINT BED=90");
        life.rest(5000);
        life.put(0, "CANCEL_PRINT");
        life.await_ok();
        life.await_ok();
        assert_eq!((life.count("own cancel"), life.count("echo:print cancelled, heaters are off")), (1, 1));
        assert_eq!(life.targets(), [0.0, 0.0]);
        assert_eq!(place(life, "M114")[2], 57.0, "its moves are made");
        // The rest of the print is not.
        let stopped = life.counts();
        life.say("G1 X10 F6000");
        life.say("M104 S200");
        life.rest(1000);
        assert_eq!((life.counts(), life.targets()), (stopped, [0.0, 0.0]));
    });
}

#[test]
fn a_question_in_a_text_lets_other_hosts_be_served_and_the_text_goes_on_after_it() {
    live(2, |life| {
        life.put(0, "ASK");
        life.rest(10_000);
        assert_eq!((life.count("before"), life.count("after"), life.oks()), (1, 0, 0));
        life.switch_to(1);
        life.say("M114");
        life.say("B");
        assert_eq!(life.count("deep"), 1, "other texts run meanwhile");
        life.say("M108");
        life.switch_to(0);
        life.await_ok();
        assert_eq!(life.count("after"), 1, "{:#?}", life.heard);
        life.rest(1000);
        assert_eq!(life.oks(), 1);
    });
}

#[test]
fn m112_stops_the_machine_in_a_text() {
    live(1, |life| {
        life.put(0, "START_PRINT BED=90");
        life.rest(5000);
        life.put(0, "M112");
        life.rest(1000);
        assert!(life.is_halted());
        assert_eq!(life.duties(), [0, 0]);
    });
}
