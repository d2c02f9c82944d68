//! The image starts as the machine that is stored, whatever moves it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod common;

use common::{bench_of, firmware, print_on, root};
use corehbot::motors::{Motor, MotorSet};
use corehbot_emulator::compare::{difference, scheduled};
use corehbot_emulator::watch::End;
use corehbot_sim::machine_file;

/// Both belts and the screw, and an arc.
const GCODE: &str = "G28\nG1 X40 Y20 F12000\nG1 Z2\nG2 X60 Y40 I20 J0\nG1 X45 F9000\nM114\n";

/// Prints on the machine of a file in the EEPROM, compares the steps with the simulator's, and says which motors stepped.
fn motors_of(name: &str) -> MotorSet {
    let settings = machine_file::read(&root().join("examples/machines").join(name)).unwrap().settings;
    let seen = print_on(&firmware(), GCODE, &bench_of(settings));
    assert_eq!((seen.end, seen.resets.len(), &seen.line.failure), (End::Done, 0, &None));
    let host = scheduled(GCODE, &settings).unwrap();
    if let Some(difference) = difference(&seen.recorder.events, &host) {
        panic!("{name}: {difference}");
    }
    assert!(seen.safety.dangers.is_empty() && seen.recorder.unpowered == 0);
    let stored: Vec<_> = seen.line.said.iter().filter(|line| line.contains("stored settings retrieved")).collect();
    assert_eq!(stored.len(), 1, "{:?}", seen.line.said);
    host.iter().fold(MotorSet::NONE, |all, event| all.with(event.steps))
}

#[test]
fn a_corexy_has_two_belt_motors_and_one_screw() {
    let motors = [Motor::M8, Motor::M11, Motor::Z1].into_iter().map(MotorSet::of);
    assert_eq!(motors_of("corexy.toml"), motors.fold(MotorSet::NONE, MotorSet::with));
}

#[test]
fn a_corexyz_lifts_with_all_four() {
    assert_eq!(motors_of("corexyz.toml"), MotorSet::BELT);
}
