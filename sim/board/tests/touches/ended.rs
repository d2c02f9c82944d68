//! A touch that M410 ends: the tool does not stay at the bed.

use crate::common::life::Life;
use crate::touches::machine::{begin, machine};
use corehbot::settings::ProbeKind;

/// Sends a line, and M410 as soon as the tool is on its way down within a touch, at `z` at most.
fn stop_at(life: &mut Life<'_>, line: &str, z: f64) -> f64 {
    life.forget_answers();
    life.put(0, line);
    let mut before = f64::MAX;
    for _ in 0..400_000 {
        life.rest(1);
        let [.., now] = life.nozzle();
        if now < before && now < z {
            life.put(0, "M410");
            life.await_ok();
            life.await_ok();
            life.rest(1500);
            return now;
        }
        before = now;
    }
    panic!("{line} does not go down to {z}: {:?}", life.heard);
}

/// Reproducer: the tool stayed at Z1.86, and the host heard of nothing.
#[test]
fn a_quick_stop_in_a_touch_raises_the_tool_and_tells_what_was_ended() {
    for kind in [ProbeKind::Switch, ProbeKind::BlTouch] {
        begin(&machine(kind), |life| {
            life.say("G28");
            for (line, name) in [("G30", "G30"), ("G29", "G29"), ("G34", "G34"), ("G35", "G35"), ("M48 P4", "M48")] {
                let low = stop_at(life, line, 1.9);
                let [.., z] = life.nozzle();
                // By the clearance, but not above where the touch began.
                assert!(z > low + 4.0 && z < low + 6.5, "{line}: {low} to {z}\n{:?}", life.heard);
                assert!(!life.bed().is_out(), "{line}");
                assert_eq!(life.count(&format!("echo:{name} was ended by M410")), 1, "{:?}", life.heard);
                // The position is true, and the machine is as before.
                let told = life.ask("M114", "X:");
                let told: f64 = told.split("Z:").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
                assert!((told - z).abs() < 0.01, "{told} {z}");
            }
            life.say("G30");
            assert_eq!((life.count("Bed X:"), life.count("//action:cancel")), (1, 0), "{:?}", life.heard);
        });
    }
}

#[test]
fn a_quick_stop_in_homing_by_the_probe_raises_the_tool_and_z_is_not_homed() {
    begin(&machine(ProbeKind::Switch), |life| {
        let low = stop_at(life, "G28", 1.9);
        let [.., z] = life.nozzle();
        assert!(z > low + 4.0 && z < low + 6.5, "{low} to {z}\n{:?}", life.heard);
        assert_eq!([life.count("echo:G28 was ended by M410"), life.count("echo:homing was interrupted")], [1, 1]);
        life.say("G28 Z");
        life.say("G30");
        assert_eq!(life.count("Bed X:"), 1, "{:?}", life.heard);
    });
}

/// M410 again ends the rise: whoever stops the machine twice wants it to stand.
#[test]
fn a_second_quick_stop_ends_the_rise() {
    let mut s = machine(ProbeKind::Switch);
    s.probe.clearance = corehbot::units::Mm::from_num(40);
    s.probe.deploy_clearance = s.probe.clearance;
    begin(&s, |life| {
        life.say("G28");
        life.forget_answers();
        life.put(0, "G30");
        while life.nozzle()[2] > 1.9 {
            life.rest(1);
        }
        life.put(0, "M410");
        life.rest(300);
        life.put(0, "M410");
        life.rest(3000);
        let [.., z] = life.nozzle();
        assert!(z > 1.9 && z < 20.0, "{z}");
        life.forget_answers();
        life.say("G30");
        assert_eq!(life.count("Bed X:"), 1, "{:?}", life.heard);
    });
}

/// M524 has its own text, and the same rise.
#[test]
fn a_cancel_in_a_touch_raises_the_tool_too_and_says_so_once() {
    begin(&machine(ProbeKind::BlTouch), |life| {
        life.say("G28");
        life.forget_answers();
        life.put(0, "G29");
        while life.nozzle()[2] > 1.9 {
            life.rest(1);
        }
        let [.., low] = life.nozzle();
        life.put(0, "M524");
        life.rest(3000);
        let [.., z] = life.nozzle();
        assert!(z > low + 4.0 && z < low + 6.5, "{low} to {z}: {:?}", life.heard);
        assert!(!life.bed().is_out());
        assert_eq!([life.count("echo:print cancelled"), life.count("echo:G29 was ended")], [1, 0], "{:?}", life.heard);
    });
}
