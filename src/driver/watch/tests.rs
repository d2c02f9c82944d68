//! Tests of watch.

extern crate std;

use super::*;
use crate::motors::prototype;
use std::vec::Vec;

const BELT: MotorSet = prototype::BELT;

/// Owner and time in ms of each slot, for so many seconds.
fn slots(urgent: MotorSet, watched: MotorSet, has_job: bool, seconds: u32) -> Vec<(u32, Slot)> {
    let mut watch = Watch::new();
    watch.hurry(urgent);
    let wanted = Wanted { watched, writing: None, has_job, has_look: false };
    let mut ms = 0;
    let mut all = Vec::new();
    while ms < seconds * 1000 {
        let slot = watch.next(wanted, Instant::default().after_ms(ms));
        all.push((ms, slot));
        // Every exchange takes as long.
        ms += SLOT_MS;
    }
    all
}

/// The driver and register of a look.
fn looks_at(slot: Slot) -> Option<(Motor, Look)> {
    match slot {
        Slot::Urgent(motor) => Some((motor, Look::Flags)),
        Slot::Background(motor, look) => Some((motor, look)),
        Slot::Again | Slot::Job => None,
    }
}

/// The longest time without a look at this register of this driver.
fn longest(slots: &[(u32, Slot)], motor: Motor, look: Look) -> u32 {
    let looks = slots.iter().filter(|(_, slot)| looks_at(*slot) == Some((motor, look))).map(|(ms, _)| *ms);
    let end = slots.last().map_or(0, |(ms, _)| *ms);
    let times: Vec<u32> = looks.chain([end]).collect();
    times.first().copied().into_iter().chain(times.windows(2).map(|pair| pair[1] - pair[0])).max().unwrap_or(end)
}

/// The longest time without a look at this register of any of these drivers.
fn longest_of(slots: &[(u32, Slot)], motors: MotorSet, look: Look) -> u32 {
    let of = Motor::ALL.into_iter().filter(|motor| motors.has(*motor));
    of.map(|motor| longest(slots, motor, look)).max().unwrap_or(0)
}

#[test]
fn motors_that_can_pull_against_each_other_are_looked_at_every_64_ms_whatever_else_there_is_to_do() {
    for has_job in [false, true] {
        let slots = slots(BELT, MotorSet::ALL, has_job, 10);
        assert_eq!(longest_of(&slots, BELT, Look::Flags), 64, "with a job: {has_job}");
    }
}

#[test]
fn the_others_are_looked_at_no_later_than_they_were_and_all_registers_within_a_second() {
    for (motors, flags_ms, chopper_ms) in [(prototype::ALL, 175, 256), (MotorSet::ALL, 192, 272)] {
        let slots = slots(BELT, motors, false, 20);
        assert!(longest_of(&slots, motors.without(BELT), Look::Flags) <= flags_ms);
        assert!(longest_of(&slots, motors, Look::Chopper) <= chopper_ms);
        assert!(longest_of(&slots, motors, Look::Status) <= 1000);
    }
}

#[test]
fn a_job_gets_four_slots_of_ten_and_the_background_goes_on() {
    let slots = slots(BELT, prototype::ALL, true, 60);
    let of_job = slots.iter().filter(|(_, slot)| *slot == Slot::Job).count();
    assert!((0.39..0.41).contains(&(of_job as f64 / slots.len() as f64)), "{of_job} of {}", slots.len());
    let flags = |slots: &[_], motors: MotorSet| longest_of(slots, motors.without(BELT), Look::Flags);
    assert!(flags(&slots, prototype::ALL) <= 364, "as long as it was with jobs in between");
    let with_eighth = self::slots(BELT, MotorSet::ALL, true, 60);
    assert!(flags(&with_eighth, MotorSet::ALL) <= 480);
}

#[test]
fn without_motors_that_can_pull_against_each_other_all_drivers_are_alike() {
    let none = MotorSet::NONE;
    for (motors, ms) in [(prototype::ALL, 175), (MotorSet::ALL, 200)] {
        let alone = slots(none, motors, false, 10);
        for look in [Look::Flags, Look::Status, Look::Chopper] {
            assert!(longest_of(&alone, motors, look) <= ms, "{look:?}");
        }
    }
    // A job gets every second slot.
    let busy = slots(none, MotorSet::ALL, true, 10);
    assert!(busy.chunks_exact(2).all(|pair| pair.iter().filter(|(_, slot)| *slot == Slot::Job).count() == 1));
    // If only belt motors have power, the background has only their flags to read.
    let belt = slots(BELT, BELT, false, 10);
    assert!(longest_of(&belt, BELT, Look::Flags) <= 64 && longest_of(&belt, BELT, Look::Chopper) <= 256);
}

#[test]
fn a_driver_that_is_written_is_not_asked_for_its_chopper() {
    let mut watch = Watch::new();
    let wanted = Wanted { watched: MotorSet::ALL, writing: Some(prototype::Z2), has_job: false, has_look: false };
    for ms in 0..1000 {
        let slot = watch.next(wanted, Instant::default().after_ms(ms * SLOT_MS));
        assert_ne!(slot, Slot::Background(prototype::Z2, Look::Chopper));
    }
}

#[test]
fn drivers_that_are_to_be_asked_at_once_are_asked_one_after_the_other_until_they_are_well() {
    let mut watch = Watch::new();
    watch.hurry(BELT);
    let watched = prototype::ALL.without(MotorSet::of(prototype::M8));
    let wanted = Wanted { watched, writing: None, has_job: true, has_look: false };
    watch.ask_at_once(MotorSet::ALL);
    let mut asked = MotorSet::NONE;
    for slot in 0..6 {
        let Slot::Urgent(motor) = watch.next(wanted, Instant::default().after_ms(slot * SLOT_MS)) else {
            panic!("slot {slot}")
        };
        asked = asked.with(MotorSet::of(motor));
        watch.note_well(motor);
    }
    assert!(asked == watched && watch.unseen(watched).is_empty());
}

#[test]
fn a_look_in_the_background_that_is_to_be_repeated_leaves_urgent_ones_their_slots() {
    let mut watch = Watch::new();
    watch.hurry(BELT);
    let wanted = Wanted { watched: MotorSet::ALL, writing: None, has_job: false, has_look: true };
    let slots: Vec<Slot> = (0..8).map(|slot| watch.next(wanted, Instant::default().after_ms(slot * SLOT_MS))).collect();
    for pair in slots.chunks_exact(2) {
        assert!(matches!(pair, [Slot::Urgent(_), Slot::Again]), "{slots:?}");
    }
}
