//! A cancel at any moment: every command that makes its host wait ends at once by M524, as any cancel does.
//!
//! The commands are the examples of the firmware, which are of every code that it knows.
//! A command waits if its `ok` does not come at once, as seen here. So a new command that waits is in this test.

use crate::common::heated::heated;
use crate::common::life::Life;
use crate::common::on_bed::{SCREWS, over, with_probe};
use corehbot::accelerometer::SensorKind;
use corehbot::machine::examples;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::{Mm, TICKS_PER_MS};
use corehbot_rig::bed::BedSetup;
use corehbot_sim::bed_plant;
use corehbot_sim::eeprom::Eeprom;
use rayon::prelude::*;

/// Longer forms of commands that the table has in a short form.
const LONGER: [&str; 19] = [
    "G4 S30",
    "G28",
    "G28 Z",
    "G29",
    "G30 X200 Y200",
    "G34",
    "G35",
    "M48 P20",
    "M109 S150",
    "M190 S60",
    "M190 R30",
    "M303 E0 S150 C3",
    "M303 E-1 S60",
    "SELF_TEST",
    "TEST_RESONANCES AXIS=X",
    "SHAPER_CALIBRATE",
    "M915",
    "M500",
    "G1 X0 Y0 Z1 F60",
];

/// They act as they arrive, and end what is under way themselves.
const URGENT: [&str; 8] = ["M24", "M108", "M410", "M524", "M602", "M999", "RESUME", "CANCEL_PRINT"];

/// A line that is answered after this time has made its host wait.
const AT_ONCE_MS: u64 = 150;

/// The time after a cancel in which all motion but the raise of a probe ends.
const STOPS_MS: u64 = 500;

/// And the raise.
const RAISED_MS: u64 = 1500;

/// So long a command is watched to find out how long it takes.
const LONGEST_MS: u64 = 60_000;

/// A printer with everything that a command may wait for.
fn machine(kind: ProbeKind) -> (Settings, BedSetup) {
    let mut s = with_probe(heated());
    (s.probe.kind, s.probe.homes_z) = (kind, kind == ProbeKind::BlTouch);
    s.probe.offset.z = Mm::from_num(-1.5);
    s.accelerometer.kind = Some(SensorKind::Adxl345);
    (s.mesh.columns, s.mesh.rows) = (4, 4);
    let bed = bed_plant::read("bowl=0.2", &s).unwrap();
    (s, bed)
}

/// A print is under way, the tool moves for four seconds more, and the bed is warm.
fn print(life: &mut Life<'_>) {
    for line in ["G28 X Y", "M75", "M302 P1", "G90", "M83", "G21", "M220 S100", "M204 P3000 T3000", "M140 S40", "M400"]
    {
        life.say(line);
    }
    life.say("G1 X100 Y200 F9000");
    life.say("M400");
    life.say("G1 X300 F3000");
}

/// Time passes until the host has so many answers; false if it takes longer.
fn is_answered(life: &mut Life<'_>, oks: usize, ms: u64) -> bool {
    let until = life.now() + ms * u64::from(TICKS_PER_MS);
    while life.oks() < oks && life.now() < until {
        life.rest(1);
    }
    life.oks() >= oks
}

/// How long a line makes its host wait in a print, in ms; `None` if it is answered at once.
fn wait_of(s: &Settings, bed: &BedSetup, line: &str) -> Option<u64> {
    let mut found = None;
    over(s, bed, &mut Eeprom::blank(), |life| {
        print(life);
        let (begun, oks) = (life.now(), life.oks());
        life.put(0, line);
        if !is_answered(life, oks + 1, AT_ONCE_MS) {
            let _ = is_answered(life, oks + 1, LONGEST_MS);
            found = Some((life.now() - begun) / u64::from(TICKS_PER_MS));
        }
    });
    found
}

/// A number that looks random, below `most`.
fn random(seed: &mut u64, most: u64) -> u64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) % most
}

/// The numbers of an answer to M114.
fn numbers(place: &str) -> Vec<f64> {
    place.split([' ', ':']).filter_map(|word| word.parse().ok()).collect()
}

/// The line is cancelled at that moment: everything stops, and the user is told once.
fn cancel(life: &mut Life<'_>, line: &str, at_ms: u64) {
    print(life);
    let (oks, told) = (life.oks(), life.heard.len());
    life.put(0, line);
    life.rest(at_ms);
    let is_over = life.oks() > oks;
    life.put(0, "M524");
    life.rest(STOPS_MS);
    let stopped = life.counts();
    let why = format!("{line} after {at_ms} ms: {:#?}", &life.heard[told..]);
    assert!(is_answered(life, oks + 2, RAISED_MS), "no answer, {why}");
    life.rest(2000);
    for (motor, (now, then)) in life.counts().into_iter().zip(stopped).enumerate() {
        let is_raise = SCREWS.contains(&motor) && now > then;
        assert!(now == then || is_raise, "motor {motor} moves on, {why}");
    }
    assert_eq!(life.oks(), oks + 2, "{why}");
    assert_eq!(life.targets(), [0.0, 0.0], "{why}");
    assert_eq!(life.duties(), [0, 0], "{why}");
    life.forget_answers();
    let heard = life.heard.split_off(told);
    let count = |begin: &str| heard.iter().filter(|line| line.starts_with(begin)).count();
    if !is_over {
        assert_eq!(count("echo:print cancelled, heaters are off"), 1, "{why}");
        assert_eq!(count("//action:cancel"), 1, "{why}");
    }
    assert_eq!(
        [count("Error"), count("!!"), count("echo:print ended"), count("//action:pause action")],
        [0; 4],
        "{why}"
    );
    let places = ["M114", "M114 R"].map(|ask| life.ask(ask, "X:"));
    let [named, real] = places.each_ref().map(|place| numbers(place));
    assert_eq!(named.len(), real.len(), "{places:?}, {why}");
    // Both are rounded to hundredths, from two forms of the same place: at 6.745 one says 6.74 and the other 6.75.
    let is_same = named.iter().zip(&real).all(|(named, real)| (named - real).abs() < 0.0101);
    assert!(is_same, "{places:?}, {why}");
    // The next print finds nothing of it.
    for line in ["N0 M110 N0*125", "G28", "G1 X50 Y60 F6000", "M400"] {
        life.say(line);
    }
    let place = life.ask("M114", "X:");
    assert!(place.starts_with("X:50.00 Y:60.00 "), "{place}, {why}");
    assert_eq!(life.count("echo:the print was ended"), 0, "{why}");
}

fn every_wait_is_cancelled(kind: ProbeKind) {
    let (s, bed) = machine(kind);
    let lines = examples().map(|(line, _)| line).chain(LONGER);
    let lines: Vec<_> = lines.filter(|line| !URGENT.contains(&line.split(' ').next().unwrap())).collect();
    let waits: Vec<_> = lines.into_par_iter().filter_map(|line| Some((line, wait_of(&s, &bed, line)?))).collect();
    for code in ["G4", "G28", "G29", "G30", "G34", "G35", "M0", "M25", "M48", "M84", "M109", "M190", "M303", "M400"] {
        assert!(waits.iter().any(|(line, _)| line.starts_with(code)), "{code} waits: {waits:?}");
    }
    waits.par_iter().enumerate().for_each(|(place, (line, ms))| {
        let mut seed = place as u64 + 1;
        over(&s, &bed, &mut Eeprom::blank(), |life| {
            // Again and again on one printer.
            for _ in 0..2 {
                let at_ms = AT_ONCE_MS.min(ms / 2) + random(&mut seed, *ms);
                cancel(life, line, at_ms.min(ms.saturating_sub(1)));
            }
        });
    });
}

/// Reproducer: a mesh went on for six minutes after M524, with the bed hot, and was then cancelled.
#[test]
fn a_command_that_waits_is_cancelled_at_any_moment() {
    every_wait_is_cancelled(ProbeKind::Switch);
}

#[test]
fn so_it_is_on_a_printer_whose_probe_homes_z_and_has_to_be_taken_in() {
    every_wait_is_cancelled(ProbeKind::BlTouch);
}

/// Codes that act though a job has ended: they begin or end one, cure the machine, or stop it.
const ACT: [&str; 12] =
    ["G28", "START_PRINT", "PRINT_START", "M18", "M75", "M77", "M84", "M108", "M110", "M112", "M915", "M999"];

/// Reproducer: M290, SET_GCODE_OFFSET with MOVE=1, STEPPER_BUZZ and SELF_TEST of the rest of a file acted.
#[test]
fn a_job_that_has_ended_moves_and_heats_nothing_whatever_the_command() {
    let (s, bed) = machine(ProbeKind::Switch);
    let more = ["M290 Z0.3", "SET_GCODE_OFFSET Z_ADJUST=0.3 MOVE=1", "STEPPER_BUZZ STEPPER=m1"];
    let lines = examples().map(|(line, _)| line).chain(LONGER).chain(more);
    let code = |line: &str| line.split([' ', '(', ';']).next().unwrap().to_owned();
    over(&s, &bed, &mut Eeprom::blank(), |life| {
        print(life);
        life.say("M524");
        life.rest(2000);
        let stopped = life.counts();
        for line in lines.filter(|line| !ACT.contains(&code(line).as_str())) {
            life.put(0, line);
            life.put(0, "M104 S200");
            life.rest(300);
            assert_eq!(life.counts(), stopped, "{line} moves: {:?}", life.heard.last());
            assert_eq!((life.targets(), life.duties()), ([0.0; 2], [0; 2]), "{line} heats: {:?}", life.heard.last());
        }
        assert_eq!(life.count("echo:the print was ended"), 1);
    });
}
