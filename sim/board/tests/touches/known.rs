//! The place of the bed, once known, bounds every touch until the motors of z lose their power.

use crate::common::life::Life;
use crate::touches::machine::{begin, begin_over, machine};
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::BedSetup;
use corehbot_rig::bed::probe::ProbeFault;

/// The probe triggers 1.5 mm above the bed, and its floor is 2 mm lower; and a step or two.
const DEEPEST: f64 = 0.5 + 0.01;

/// The deepest place of the nozzle in the bed.
fn deepest(life: &mut Life<'_>) -> f64 {
    life.bed().deepest().map_or(0.0, |deepest| deepest.mm)
}

/// A line that fails, and the number of failures with these words after it.
fn fails(life: &mut Life<'_>, line: &str, why: &str) -> usize {
    life.say(line);
    life.say("M108");
    assert_eq!(life.count("Error"), 0, "{:?}", life.heard);
    life.count(&format!("echo:print ended, heaters are off: probing failed: {why}"))
}

const NOT_WHERE_IT_WAS: &str = "the probe did not trigger down to Z-0.5, expected at Z1.5. Check its wire. If the bed \
                                is lower now, send M84 and home again";

/// Reproducer: the tool went 347 mm down.
#[test]
fn a_probe_that_dies_in_a_later_homing_goes_hardly_below_the_bed() {
    for kind in [ProbeKind::Switch, ProbeKind::Nozzle] {
        begin(&machine(kind), |life| {
            life.say("G28");
            life.fail_probe(ProbeFault::Dead);
            for (number, line) in ["G28", "G28 Z", "G28", "G28 Z R20"].into_iter().enumerate() {
                assert_eq!(fails(life, line, NOT_WHERE_IT_WAS), number + 1, "{line}: {:?}", life.heard);
                assert!(deepest(life) <= DEEPEST, "{line}: {}", deepest(life));
                // It does not climb from failure to failure.
                assert!(life.nozzle()[2] < 25.0, "{:?}", life.nozzle());
            }
            // Mended, it homes as ever.
            life.fail_probe(ProbeFault::None);
            life.say("G28");
            assert!(life.ask("G30 X195 Y208.8", "Bed X:").ends_with("Z:0.000"), "{:?}", life.heard);
            // Without power the bed may be anywhere, so the search goes on as in the first homing.
            life.fail_probe(ProbeFault::Dead);
            life.say("M84");
            let why = "the probe did not trigger within 347 mm. Check that it is out, and its wire";
            assert_eq!(fails(life, "G28", why), 1, "{:?}", life.heard);
            assert!(deepest(life) > 100.0);
        });
    }
}

#[test]
fn a_failed_touch_in_between_forgets_nothing() {
    begin(&machine(ProbeKind::Switch), |life| {
        life.say("G28");
        life.fail_probe(ProbeFault::Dead);
        let why = "the probe did not trigger down to Z-0.5, expected at Z1.5. Check its wire, and its offset (M851)";
        assert_eq!(fails(life, "G30", why), 1, "{:?}", life.heard);
        for number in 1..=3 {
            assert_eq!(fails(life, "G28", NOT_WHERE_IT_WAS), number, "{:?}", life.heard);
        }
        assert!(deepest(life) <= DEEPEST, "{}", deepest(life));
    });
}

#[test]
fn a_probe_that_dies_between_the_touches_of_the_first_homing_is_bounded_too() {
    begin(&machine(ProbeKind::Switch), |life| {
        life.forget_answers();
        life.put(0, "G28");
        while life.nozzle()[2] > 1.501 {
            life.rest(1);
        }
        life.fail_probe(ProbeFault::Dead);
        life.await_ok();
        for _ in 0..2 {
            life.say("G28");
        }
        assert!(deepest(life) <= DEEPEST, "{}: {:?}", deepest(life), life.heard);
        life.fail_probe(ProbeFault::None);
        life.say("G28");
        assert!(life.ask("G30 X195 Y208.8", "Bed X:").ends_with("Z:0.000"), "{:?}", life.heard);
    });
}

#[test]
fn a_touch_far_above_the_known_bed_homes_nothing() {
    begin(&machine(ProbeKind::Switch), |life| {
        life.say("G28");
        life.fail_probe(ProbeFault::Early);
        let why = "the probe triggered 3.5 mm above the bed, expected at Z1.5. ";
        assert_eq!(fails(life, "G28", why), 1, "{:?}", life.heard);
        assert_eq!(fails(life, "G28 Z", why), 2, "{:?}", life.heard);
        let told = life.count("echo:move ignored: home its axes first (G28)");
        life.say("G30");
        assert_eq!(life.count("echo:move ignored: home its axes first (G28)"), told + 1, "{:?}", life.heard);
        life.fail_probe(ProbeFault::None);
        life.say("G28");
        assert!(life.ask("G30 X195 Y208.8", "Bed X:").ends_with("Z:0.000"), "{:?}", life.heard);
    });
}

/// Where the bed is does not depend on what the lines say of the offset.
#[test]
fn offsets_that_change_in_between_move_no_floor() {
    let lives: [(&[&str], f64); 3] =
        [(&["M851 Z-4"], DEEPEST), (&["M290 Z0.5"], DEEPEST), (&["M290 Z-0.7", "G1 Z20", "M290 Z0.3"], DEEPEST)];
    for (lines, most) in lives {
        begin(&machine(ProbeKind::Switch), |life| {
            life.say("G28");
            lines.iter().for_each(|line| life.say(line));
            // In order it homes with the other offset.
            life.say("G28 Z");
            assert_eq!(life.count("echo:print ended"), 0, "{lines:?}: {:?}", life.heard);
            life.fail_probe(ProbeFault::Dead);
            for line in ["G28", "G28 Z"] {
                life.say(line);
                life.say("M108");
            }
            assert_eq!(life.count("echo:print ended"), 2, "{lines:?}: {:?}", life.heard);
            assert!(deepest(life) <= most, "{lines:?}: {}", deepest(life));
        });
    }
}

/// A stop while a screw of z turns: the reference has moved by less than the floor allows.
#[test]
fn homing_goes_on_after_g34_was_stopped_in_a_turn() {
    let s = machine(ProbeKind::Switch);
    let mut bed = BedSetup::of(&s);
    bed.surface.tilt = [0.004, 0.0];
    begin_over(&s, &bed, |life| {
        life.say("G28");
        life.forget_answers();
        life.put(0, "G34");
        while !life.heard.iter().any(|line| line.starts_with("1:2=") || line.contains("1:2=")) {
            life.rest(1);
        }
        life.rest(40);
        life.put(0, "M410");
        life.await_ok();
        life.await_ok();
        life.say("G28");
        assert_eq!(life.count("echo:print ended"), 0, "{:?}", life.heard);
        life.say("G30 X195 Y208.8");
        assert_eq!(life.count("Bed X:"), 1, "{:?}", life.heard);
    });
}

/// The axis is shorter than the clearance of the probe.
#[test]
fn the_tool_does_not_rise_above_a_short_axis() {
    let mut s: Settings = machine(ProbeKind::Switch);
    s.axes.z.length = Mm::from_num(20);
    (s.probe.clearance, s.probe.deploy_clearance) = (Mm::from_num(45), Mm::from_num(45));
    s.check().unwrap();
    begin(&s, |life| {
        life.say("G28");
        for line in ["G30", "G28", "M401", "M48 P4"] {
            let mut highest = 0.0_f64;
            life.forget_answers();
            life.put(0, line);
            let before = life.oks();
            while life.oks() == before {
                life.rest(1);
                highest = highest.max(life.nozzle()[2]);
            }
            assert!(highest <= 20.001, "{line}: {highest}");
        }
        assert_eq!(life.count("Bed X:"), 1, "{:?}", life.heard);
    });
}
