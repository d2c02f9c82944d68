//! Tests of compare.

use super::*;
use crate::tick::NS_PER_TICK;
use corehbot::accelerometer::SensorKind;
use corehbot::motors::prototype;

fn event(due: u32, lag: u32, late: i64) -> StepEvent {
    let schedule = Schedule { due, lag, stretched: 0, late };
    let at = u64::from(due) * NS_PER_TICK + late as u64;
    StepEvent { at, steps: prototype::BELT, forward: MotorSet::NONE, spread: 8, schedule: Some(schedule) }
}

fn planned(tick: u64) -> Scheduled {
    Scheduled { tick, steps: prototype::BELT, forward: MotorSet::NONE }
}

#[test]
fn motion_time_stands_still_between_two_motions() {
    let pins = [event(60, 10, 300), event(160, 10, 700), event(9160, 9000, 400), event(9260, 9000, 500)];
    let host = [planned(50), planned(150), planned(160), planned(260)];
    assert_eq!(difference(&pins, &host), None);
    let timing = timing(&pins, &host);
    assert_eq!(timing.late.0, [300, 400, 500, 700]);
    assert_eq!(timing.longest.0, [300, 700], "the first of two alike");
    assert_eq!((timing.starts, timing.exact, timing.inexact, timing.stretched), (2, 4, 0, 0));
}

#[test]
fn an_event_one_tick_off_is_seen() {
    let timing = timing(&[event(10, 10, 0), event(111, 10, 0)], &[planned(0), planned(100)]);
    assert_eq!((timing.exact, timing.inexact), (1, 1));
}

#[test]
fn stretched_time_is_no_start() {
    let mut late = event(400, 250, 0);
    late.schedule = late.schedule.map(|schedule| Schedule { stretched: 1, ..schedule });
    let timing = timing(&[event(60, 10, 0), late], &[planned(50), planned(150)]);
    assert_eq!((timing.starts, timing.stretched, timing.inexact), (1, 1, 0));
}

#[test]
fn the_first_difference_is_named() {
    let host = [planned(0), planned(100)];
    let found = difference(&[event(10, 10, 0)], &host).unwrap();
    assert_eq!(found.to_string(), "event 1: the pins are silent, the host steps -m1 -m4 -m8 -m11 at tick 100");
}

/// The host once had no accelerometer where the machine came from an EEPROM. It refused the sweep that the image made,
/// so it was silent after the moves before it.
#[test]
fn a_stored_machine_has_its_accelerometer_plugged_in() {
    let mut settings = Settings::prototype();
    settings.accelerometer.kind = Some(SensorKind::Adxl345);
    let mut eeprom = Eeprom::blank();
    eeprom.save(&settings).unwrap();
    let before = "G28 X Y\nG0 X40 Y40\n";
    let gcode = format!("{before}TEST_RESONANCES AXIS=X FREQ_START=134 FREQ_END=135 HZ_PER_SEC=2\n");
    let stored = scheduled_stored(&gcode, &settings, &mut eeprom, None).unwrap();
    assert_eq!(stored, scheduled(&gcode, &settings).unwrap());
    assert!(stored.len() > scheduled(before, &settings).unwrap().len() + 1000, "{}", stored.len());
}

/// The belts are those of the stored machine: with the prototype's, a millimetre would have half as many steps, and
/// the tool would meet its switches elsewhere.
#[test]
fn a_stored_machine_pulls_its_own_belts() {
    let mut settings = Settings::prototype();
    for axis in [&mut settings.axes.x, &mut settings.axes.y] {
        axis.steps_per_mm = corehbot::units::StepsPerMm::from_num(160);
    }
    let mut eeprom = Eeprom::blank();
    eeprom.save(&settings).unwrap();
    let setup = BeltSetup { seed: Some(3), ..BeltSetup::default() };
    let gcode = "G28 X Y\nG1 X20 F6000\nM400\n";
    let stored = scheduled_stored(gcode, &settings, &mut eeprom, Some(&setup)).unwrap();
    let built = scheduled_with(gcode, &settings, NoStorage, Some(&setup)).unwrap();
    assert!(built.len() > 1000 && stored == built, "{} {}", stored.len(), built.len());
}
