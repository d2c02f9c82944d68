//! The bed's heater while a touch is awaited.

use crate::common::life::Life;
use crate::touches::machine::{begin, begin_over, machine};
use corehbot::settings::{ProbeKind, Settings};
use corehbot_rig::bed::BedSetup;
use corehbot_rig::bed::probe::ProbeFault;

fn quiet() -> Settings {
    let mut s = machine(ProbeKind::Switch);
    s.probe.bed_heater_off = true;
    s.job.keeps_heat = true;
    s
}

/// The greatest duty of the bed in the fast way down to a touch, from `high` to `low`, and the greatest around it.
fn duties(life: &mut Life<'_>, line: &str, [high, low]: [f64; 2]) -> [u16; 2] {
    life.forget_answers();
    let before = life.oks();
    life.put(0, line);
    let (mut down, mut around, [.., mut at]) = (0, 0, life.nozzle());
    while life.oks() == before {
        life.rest(20);
        let ([.., z], duty) = (life.nozzle(), life.duties()[1]);
        if z < at && z < high && z > low {
            down = down.max(duty);
        }
        (around, at) = (around.max(duty), z);
    }
    [down, around]
}

#[test]
fn the_bed_gets_no_power_while_a_touch_is_awaited_if_its_current_is_noise() {
    for (s, is_off) in [(quiet(), true), (machine(ProbeKind::Switch), false)] {
        begin(&s, |life| {
            life.say("M190 S60");
            life.say("G28");
            for line in ["G30", "G28 Z", "G29", "G30 X100 Y100"] {
                let [down, around] = duties(life, line, [10.0, 2.5]);
                assert_eq!(down == 0, is_off, "{line}: {down}");
                assert!(around > 0, "{line}: it heats in between");
                assert_eq!(life.targets()[1], 60.0, "{line}: its target stays");
            }
            life.say("M190 S60");
            assert!(!life.is_halted(), "{:?}", life.heard);
        });
    }
}

/// Whatever ends a touch gives the bed its power back.
#[test]
fn the_bed_heats_again_after_a_touch_that_failed_or_was_ended() {
    begin(&quiet(), |life| {
        life.say("M190 S60");
        life.say("G28");
        for (fault, ends) in [(ProbeFault::Dead, false), (ProbeFault::Stuck, false), (ProbeFault::None, true)] {
            life.fail_probe(fault);
            life.forget_answers();
            life.put(0, "G28");
            if ends {
                while life.nozzle()[2] > 2.0 || life.duties()[1] > 0 {
                    life.rest(1);
                }
                life.put(0, "M410");
                life.await_ok();
            }
            life.await_ok();
            // Its switch is on for a part of the time.
            let most = (0..1000).map(|_| {
                life.rest(20);
                life.duties()[1]
            });
            assert!(most.max() > Some(0), "{:?}", life.heard);
            assert!(!life.is_halted(), "{:?}", life.heard);
            life.say("M108");
        }
        life.say("M190 S60");
    });
}

/// The first homing finds a bed that is far below: it has cooled by then, which is no fault.
#[test]
fn a_bed_that_cools_in_a_long_search_warms_up_again() {
    let mut s = quiet();
    s.probe.fast = corehbot::units::MmPerSec::from_num(1);
    let mut bed = BedSetup::of(&s);
    bed.surface.height = -300.0;
    begin_over(&s, &bed, |life| {
        life.say("M190 S90");
        life.say("G28");
        assert!(!life.is_halted(), "{:?}", life.heard);
        life.say("M190 S90");
        assert!(!life.is_halted() && life.count("echo:print ended") == 0, "{:?}", life.heard);
    });
}
