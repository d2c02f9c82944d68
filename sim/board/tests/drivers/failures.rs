//! Failures: drivers that are reset, hot or unreadable, and when the machine stops for it.

use super::script::{LONG_MOVE, act, each, lines, play, play_with, say};
use corehbot::motors::{MotorSet, prototype};
use corehbot::units::TICKS_PER_MS;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::tmc2209;
use corehbot_sim::tmc2209::{Corruption, chopconf};

#[test]
fn a_driver_that_loses_its_registers_in_mid_move_stops_the_machine() {
    for motor in prototype::ALL.iter() {
        let drivers = Drivers::new();
        let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(move |d| d.chip(motor).reset()))));
        assert!(told.outcome.halted, "{:?}", told.heard);
        assert!(told.has("Error:Printer halted. kill() called! (driver of motor"), "{:?}", told.heard);
        assert!(told.has("was reset and lost its configuration"), "{:?}", told.heard);
        assert_eq!(drivers.enabled(), MotorSet::NONE);
        let ms = if prototype::BELT.has(motor) { 100 } else { 200 };
        assert!(told.steps.aftermath_ms() <= ms, "{motor:?}: {} ms", told.steps.aftermath_ms());
    }
}

#[test]
fn a_dip_of_the_whole_supply_is_seen_by_the_next_poll() {
    let drivers = Drivers::new();
    let strike = |d: &Drivers| each(d, tmc2209::Tmc2209::reset);
    let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(strike))));
    assert!(told.outcome.halted && told.steps.aftermath_ms() <= 50, "{} ms", told.steps.aftermath_ms());
}

#[test]
fn every_failure_in_mid_move_is_named() {
    type Break = fn(&mut tmc2209::Tmc2209);
    let cases: [(Break, &str); 7] = [
        (tmc2209::Tmc2209::power_off, "does not answer"),
        (|chip| chip.set(tmc2209::DRV_STATUS, 1 << 2), "short circuit"),
        (|chip| chip.set(tmc2209::DRV_STATUS, 3), "too hot"),
        (|chip| chip.set(tmc2209::GSTAT, 2), "had switched itself off"),
        (|chip| chip.set(tmc2209::GSTAT, 4), "a low supply voltage"),
        (|chip| chip.set(chopconf::ADDRESS, 0x1303_0053), "different microsteps"),
        (|chip| chip.set(chopconf::ADDRESS, 0x1403_0050), "holds a different CHOPCONF"),
    ];
    for (harm, words) in cases {
        let drivers = Drivers::new();
        let strike = move |d: &Drivers| harm(&mut d.chip(prototype::M11));
        let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(strike))));
        assert!(told.outcome.halted && told.has("kill() called! (driver of motor m11") && told.has(words), "{words}");
        assert_eq!(drivers.enabled(), MotorSet::NONE);
        assert!(told.steps.aftermath_ms() <= 250, "{words}: {} ms", told.steps.aftermath_ms());
    }
}

/// On such a wire each look takes longer than the time between two.
#[test]
fn a_driver_that_is_asked_twice_each_time_leaves_others_their_turn() {
    let drivers = Drivers::new();
    let harm = |chip: &mut tmc2209::Tmc2209| {
        let begin = chip.replies();
        (0..4000).for_each(|n| chip.corrupt_reply(begin + 4 * n, Corruption::Cut(0)));
    };
    let acts = vec![say("M17"), act(|d| each(d, harm)), say("M906 X700"), say("M569 S1"), say("M122")];
    let told = play(&drivers, acts, None);
    assert!(told.errors().is_empty() && !told.outcome.halted, "{:?}", told.heard);
    let busy = told.heard.iter().filter(|line| line.contains("busy")).count();
    assert!(busy <= 3, "{busy} times 2 s");
}

#[test]
fn a_hot_driver_is_reported_once_and_works_on() {
    let drivers = Drivers::new();
    let strike = |d: &Drivers| d.chip(prototype::E0).set(tmc2209::DRV_STATUS, 1);
    let told = play(&drivers, lines(&LONG_MOVE), Some((3000, Box::new(strike))));
    assert!(!told.outcome.halted);
    assert_eq!(told.heard.iter().filter(|line| line.contains("driver of motor e0 is hot")).count(), 1);
}

/// Whichever one reply is damaged, power comes, and then the motion is undisturbed.
#[test]
fn one_damaged_reply_never_matters() {
    let damages = [Corruption::Flip { byte: 3, mask: 0x80 }, Corruption::Cut(0), Corruption::Cut(5), Corruption::Zero];
    for damage in damages {
        for number in 0..25 {
            let drivers = Drivers::new();
            drivers.chip(prototype::M4).corrupt_reply(number, damage);
            let told = play(&drivers, lines(&["G1 X30 F3000", "M400", "G4 S3"]), None);
            assert_eq!(told.heard.iter().filter(|l| *l != "ok" && !l.contains("busy")).count(), 0, "{:?}", told.heard);
            assert_eq!(drivers.enabled(), prototype::ALL, "{damage:?} of reply {number}");
        }
    }
}

#[test]
fn a_driver_that_was_reset_while_it_had_no_power_is_configured_again() {
    let drivers = Drivers::new();
    let acts = vec![say("G1 X5 F6000"), say("M84"), act(|d| d.chip(prototype::M4).reset()), say("G1 X9"), say("M400")];
    let told = play(&drivers, acts, None);
    assert!(told.errors().is_empty() && !told.outcome.halted, "{:?}", told.heard);
    assert_eq!(drivers.chip(prototype::M4).microsteps(), 16);
}

#[test]
fn an_emergency_stop_is_heard_while_drivers_are_talked_to() {
    let drivers = Drivers::new();
    let told = play_with(&drivers, lines(&["M17"]), None, Some((9, "M112")));
    assert!(told.outcome.halted && drivers.enabled().is_empty());
    let ticks = drivers.switched() - told.interjected;
    assert!(ticks <= u64::from(TICKS_PER_MS), "{ticks} ticks");
    let drivers = Drivers::new();
    let told = play_with(&drivers, lines(&["M17", "G1 X1", "M400"]), None, Some((9, "M410")));
    assert!(!told.outcome.halted, "{:?}", told.heard);
    assert_eq!(told.outcome.counts[3], 80);
}

#[test]
fn a_reset_is_not_hidden_by_a_change_that_is_under_way() {
    let drivers = Drivers::new();
    let strike = |d: &Drivers| d.chip(prototype::M8).reset();
    let acts = lines(&["M17", LONG_MOVE[0], "M906 X900", "M400"]);
    let told = play(&drivers, acts, Some((1, Box::new(strike))));
    assert!(told.outcome.halted && told.has("driver of motor m8 was reset"), "{:?}", told.heard);
}
