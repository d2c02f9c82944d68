//! A print that is paused because its probe failed: the user mends it, and M24 tries the line again.

use crate::common::heated::heated;
use crate::common::life::{Life, live_with};
use crate::common::on_bed::{over_with, with_probe};
use corehbot::port::NoStorage;
use corehbot::settings::{OnFailure, ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::probe::ProbeFault;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::bed_plant;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::Desk;

/// A machine that pauses a print, and a bowl as its bed.
fn machine(kind: ProbeKind) -> (Settings, BedSetup) {
    let mut s = with_probe(heated());
    (s.probe.kind, s.probe.homes_z) = (kind, kind == ProbeKind::BlTouch);
    s.probe.offset.z = Mm::from_num(-1.5);
    s.job.on_failure = OnFailure::Pause;
    (s.mesh.columns, s.mesh.rows) = (3, 3);
    let bed = bed_plant::read("bowl=0.2", &s).unwrap();
    (s, bed)
}

/// A print has begun, and its probe is broken now.
fn begin(life: &mut Life<'_>, fault: ProbeFault) {
    for line in ["M75", "M190 S40", "M109 S150", "G28"] {
        life.say(line);
    }
    life.fail_probe(fault);
}

/// A line is sent and kept: the host gets no `ok`, but a request to pause.
fn is_kept(life: &mut Life<'_>, line: &str) {
    let (answered, pauses) = (life.oks(), life.count("//action:pause action:pause"));
    life.put(0, line);
    await_hold(life, pauses);
    assert_eq!(life.oks(), answered, "{:?}", life.heard);
}

fn await_hold(life: &mut Life<'_>, before: usize) {
    for _ in 0..1200 {
        life.rest(500);
        if life.count("//action:pause action:pause") > before {
            life.rest(500);
            return;
        }
    }
    life.heard.retain(|line| !line.starts_with("echo:busy") && !line.starts_with(" T:"));
    panic!("not held: {:#?}", life.heard);
}

/// The user says a line at a screen of its own.
fn user(life: &mut Life<'_>, line: &str) {
    life.switch_to(1);
    life.say(line);
    life.switch_to(0);
}

/// The user goes on, and the kept line is answered.
fn goes_on(life: &mut Life<'_>) {
    user(life, "M24");
    life.await_ok();
}

/// The rest of the print, on its mesh.
fn prints(life: &mut Life<'_>) {
    life.say("M109 S150");
    life.say("M420");
    assert_eq!(life.heard.iter().rev().find(|line| line.contains("Leveling")).unwrap(), "echo:Bed Leveling ON");
    life.say("G1 X300 Y208.8 Z0.3 F9000");
    life.say("M400");
    let [x, y, z] = life.nozzle();
    // The bowl there.
    let rises = 0.2 * (105.0_f64 / 195.0).powi(2);
    assert!((x - 300.0).abs() < 0.01 && (y - 208.8).abs() < 0.01, "{x} {y}");
    assert!((z - 0.3 - rises).abs() < 0.03, "{z}, {rises}\n{:#?}", life.heard);
    assert_eq!([life.count("Error"), life.count("//action:cancel")], [0, 0]);
}

const KINDS: [ProbeKind; 2] = [ProbeKind::Switch, ProbeKind::BlTouch];

#[test]
fn a_line_that_failed_is_tried_again_and_the_print_goes_on() {
    for kind in KINDS {
        let (s, bed) = machine(kind);
        over_with(&s, &bed, &mut Eeprom::blank(), 2, |life| {
            begin(life, ProbeFault::Stuck);
            is_kept(life, "G29");
            // The heat stays, other lines are served.
            assert_eq!(life.targets(), [150.0, 40.0]);
            user(life, "M119");
            life.fail_probe(ProbeFault::None);
            goes_on(life);
            assert_eq!(life.count("Bilinear Leveling Grid:"), 1);
            prints(life);
        });
    }
}

#[test]
fn a_line_that_fails_again_pauses_again_and_may_be_cancelled() {
    for kind in KINDS {
        let (s, bed) = machine(kind);
        for is_cancelled in [false, true] {
            over_with(&s, &bed, &mut Eeprom::blank(), 2, |life| {
                begin(life, ProbeFault::Stuck);
                is_kept(life, "G29");
                for times in 1..3 {
                    user(life, "M24");
                    await_hold(life, times);
                    assert_eq!(life.count("echo:print held: mend what failed"), times + 1);
                }
                if is_cancelled {
                    user(life, "M524");
                    life.await_ok();
                    assert_eq!(life.targets(), [0.0, 0.0]);
                    assert_eq!(life.count("//action:cancel"), 1);
                    life.fail_probe(ProbeFault::None);
                    life.heard.clear();
                    for line in ["M75", "M190 S40", "M109 S150", "G28", "G29"] {
                        life.say(line);
                    }
                } else {
                    life.fail_probe(ProbeFault::None);
                    goes_on(life);
                }
                prints(life);
            });
        }
    }
}

/// Reproducer: without a home, the line was left out, and the print went on without a mesh.
#[test]
fn a_probe_that_missed_the_bed_has_z_homed_before_its_line_is_tried_again() {
    for kind in KINDS {
        let (s, bed) = machine(kind);
        for homes_first in [false, true] {
            over_with(&s, &bed, &mut Eeprom::blank(), 2, |life| {
                begin(life, ProbeFault::Dead);
                is_kept(life, "G29");
                life.fail_probe(ProbeFault::None);
                if !homes_first {
                    user(life, "M24");
                    await_hold(life, 1);
                    assert_eq!(life.count("echo:print held: axes are no longer homed"), 1, "{:#?}", life.heard);
                }
                user(life, "G28");
                goes_on(life);
                prints(life);
            });
        }
    }
}

/// Reproducer: after a home in the pause, M24 took the tool to where z had been counted before, below the bed.
#[test]
fn a_home_that_failed_is_tried_again_wherever_z_was_lost() {
    let (mut s, bed) = machine(ProbeKind::BlTouch);
    s.probe.samples = 9;
    for homes_first in [false, true] {
        let mut desk = Desk::new(2);
        desk.bed = Some(Box::new(BedPlant::new(&s, &bed)));
        live_with(&s, None, (&mut desk, 2), NoStorage, |life| {
            life.say("M75");
            // Its touches differ, so z goes down to the bed before it fails.
            life.fail_probe(ProbeFault::Noisy);
            is_kept(life, "G28");
            life.fail_probe(ProbeFault::None);
            if homes_first {
                user(life, "G28");
            }
            life.put(1, "M24");
            let mut lowest = f64::MAX;
            while life.oks() < 2 {
                life.rest(2);
                lowest = lowest.min(life.nozzle()[2]);
            }
            assert!(lowest > 1.0, "{lowest}");
            life.await_ok();
            for line in ["M190 S40", "G29"] {
                life.say(line);
            }
            prints(life);
        });
    }
}
