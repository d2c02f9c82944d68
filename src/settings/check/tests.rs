//! Tests of check.

extern crate std;

use super::*;
use crate::kinematics::Mechanism;
use crate::motors::{MotorName, prototype};
use crate::settings::{AxisEnd, Range, SensorSource};
use crate::units::{Hertz, Ratio};
use std::string::{String, ToString as _};

/// The key that is out of its range.
fn out_of_range(checked: Result<(), SettingsError>) -> String {
    match checked {
        Err(SettingsError::OutOfRange(key)) => key.to_string(),
        other => std::format!("{other:?}"),
    }
}

#[test]
fn the_prototype_is_legal() {
    assert_eq!(Settings::prototype().check_machine(), Ok(()));
}

#[test]
fn rows_that_are_no_machine_are_refused_where_a_machine_is_made() {
    let mut s = Settings::prototype();
    s.mechanism.rows[6] = [0; 4];
    assert_eq!(
        s.check_machine(),
        Err(SettingsError::Mechanism { error: MechanismError::NotDriven("e"), motor: MotorName::NONE })
    );
    assert_eq!(s.check(), Ok(()), "stored settings have the machine's own rows");
    s = Settings::prototype();
    s.keepalive_s = 61;
    assert_eq!(out_of_range(s.check_machine()), "keepalive_s", "all the rest counts too");
}

#[test]
fn drivers_have_limits_too() {
    let mut s = Settings::prototype();
    s.drivers.z.microsteps = 24;
    assert_eq!(s.check(), Err(SettingsError::NoSuchMicrosteps("drivers.z")));
    s.drivers.belt.current_ma = 1701;
    assert_eq!(out_of_range(s.check()), "drivers.belt.current_ma");
}

#[test]
fn shaping_has_limits() {
    let error = |change: fn(&mut Settings)| {
        let mut s = Settings::prototype();
        change(&mut s);
        out_of_range(s.check())
    };
    let illegal = String::from;
    assert_eq!(error(|s| s.shapers.x.frequency = Hertz::lit("9.9")), illegal("shaper.x.frequency"));
    assert_eq!(error(|s| s.shapers.y.damping = Ratio::lit("0.51")), illegal("shaper.y.damping"));
    assert_eq!(error(|s| s.advance.time = Seconds::lit("4.1")), illegal("advance.time"));
    assert_eq!(error(|s| s.advance.window = Some(Seconds::ZERO)), "Err(OutOfRangeBeside(\"advance.window\"))");
    assert_eq!(error(|s| s.advance.time = Seconds::lit("4")), "Ok(())");
    assert_eq!(error(|s| s.minimum_cruise_ratio = Ratio::lit("0.91")), illegal("minimum_cruise_ratio"));
    assert_eq!(error(|s| s.lookahead_time = Seconds::lit("0.49")), illegal("lookahead_time"));
    assert_eq!(error(|s| s.lookahead_time = Seconds::const_from_int(61)), illegal("lookahead_time"));
}

#[test]
fn a_resolution_that_shared_motors_cannot_have_is_named() {
    let mut s = Settings::prototype();
    s.axes.y.steps_per_mm = StepsPerMm::const_from_int(160);
    assert_eq!(s.check(), Err(SettingsError::ResolutionsDiffer("x and y")));
    s.axes.y.steps_per_mm = StepsPerMm::const_from_int(25_600);
    assert_eq!(s.check(), Err(SettingsError::TooManySteps("axes.y")));
}

#[test]
fn the_ends_of_a_range_are_legal() {
    let is_legal = |change: &dyn Fn(&mut Settings)| {
        let mut s = Settings::prototype();
        change(&mut s);
        s.check().is_ok()
    };
    let most = ranges::SPEED.most;
    let more = most.saturating_add(MmPerSec::DELTA);
    assert!(is_legal(&|s| (s.min_feed, s.min_travel) = (most, most)));
    assert!(!is_legal(&|s| s.min_feed = more) && !is_legal(&|s| s.min_travel = more));
    assert!(is_legal(&|s| s.keepalive_s = 60) && !is_legal(&|s| s.keepalive_s = 61));
    assert!(
        is_legal(&|s| s.patience_ms = 0) && is_legal(&|s| s.patience_ms = 100) && !is_legal(&|s| s.patience_ms = 99)
    );
    // 500,000 steps a second, and a little more.
    let z = |speed: MmPerSec| {
        is_legal(&|s| (s.axes.z.steps_per_mm, s.axes.z.max_speed) = (StepsPerMm::const_from_int(10_000), speed))
    };
    assert!(z(MmPerSec::const_from_int(50)) && !z(MmPerSec::lit("50.001")));
    assert!(!is_legal(&|s| s.homing.y.slow = MmPerSec::ZERO));
}

#[test]
fn axes_that_share_motors_are_named_in_pairs() {
    let none = [0; 4];
    let (z, e) = ([0, 0, 1, 0], [0, 0, 0, 1]);
    let corexz = [[0, 1, 0, 0], none, [1, 0, -1, 0], [1, 0, 1, 0], none, none, e];
    let coreyz = [[1, 0, 0, 0], none, [0, 1, -1, 0], [0, 1, 1, 0], none, none, e];
    let corexy = [none, none, [1, -1, 0, 0], [1, 1, 0, 0], z, none, e];
    for (rows, pair) in [(corexz, "x and z"), (coreyz, "y and z"), (corexy, "x and y")] {
        let mut s = Settings { mechanism: Mechanism::of(&rows), ..Settings::prototype() };
        s.belt.is_closed = false;
        let [x, y, z] = [&mut s.axes.x, &mut s.axes.y, &mut s.axes.z].map(|axis| &mut axis.steps_per_mm);
        (*x, *y, *z) =
            (StepsPerMm::const_from_int(80), StepsPerMm::const_from_int(90), StepsPerMm::const_from_int(100));
        assert_eq!(s.check_shared_motors(), Err(pair));
        s.belt.is_closed = true;
        assert_eq!(s.check_shared_motors(), Err("x and y"), "a closed belt has one step");
        let equal = StepsPerMm::const_from_int(80);
        (s.axes.x.steps_per_mm, s.axes.y.steps_per_mm, s.axes.z.steps_per_mm) = (equal, equal, equal);
        assert_eq!(s.check_shared_motors(), Ok(()));
    }
}

#[test]
fn a_motor_has_the_resolution_of_its_axis() {
    let none = [0; 4];
    let rows = [[1, 0, 0, 0], [0, 1, 0, 0], none, none, [0, 0, 1, 0], none, [0, 0, 0, 1]];
    let mut s = Settings { mechanism: Mechanism::of(&rows), ..Settings::prototype() };
    let axes = [&mut s.axes.x, &mut s.axes.y, &mut s.axes.z, &mut s.axes.e];
    for (axis, number) in axes.into_iter().zip(1..) {
        axis.steps_per_mm = StepsPerMm::const_from_int(number);
    }
    let motors = [prototype::M1, prototype::M4, prototype::Z1, prototype::E0];
    assert_eq!(motors.map(|motor| s.steps_per_mm(motor).to_num::<u32>()), [1, 2, 3, 4]);
}

#[test]
fn errors_name_the_setting_that_is_wrong() {
    let mut s = Settings::prototype();
    s.homing.y.fast = MmPerSec::ZERO;
    assert_eq!(s.check().unwrap_err().to_string(), "homing.y.fast is outside its legal range");
    let texts = [
        (SettingsError::OutOfRangeBeside("homing.y.position"), "homing.y.position is outside its legal range"),
        (SettingsError::TooManySteps("axes.y"), "axes.y: speed limit x steps_per_mm is above 500000 steps/s"),
        (SettingsError::ResolutionsDiffer("x and y"), "x and y share motors: their steps_per_mm must be equal"),
        (
            SettingsError::MicrostepsDiffer {
                motors: ["m1", "z1"].map(MotorName::lit),
                microsteps: [16, 32],
                keys: ["drivers.belt", "drivers.z"],
            },
            "motors m1 and z1 move the same axis with 16 and 32 microsteps, so one moves further than the other: set \
            drivers.belt.microsteps and drivers.z.microsteps alike",
        ),
        (
            SettingsError::BeltCurrents { motors: ["m1", "m4"].map(MotorName::lit), currents: [700, 900] },
            "motors m1 and m4 pull one closed belt, but with 700 and 900 mA: give all motors of the belt the same \
            current_ma, or set drivers.belt.current_ma alone",
        ),
        (
            SettingsError::NamedAsGroup(MotorName::lit("z")),
            "drivers.z is a group of drivers, not motor z alone: rename the motor",
        ),
        (SettingsError::NoSuchMicrosteps("drivers.z"), "drivers.z: microsteps are 1, 2, 4 and so on up to 256"),
    ];
    for (error, text) in texts {
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn the_nearest_legal_value_is_the_value_or_an_end_of_its_range() {
    let range = Range { least: 10, most: 20 };
    assert_eq!([9, 10, 15, 20, 21].map(|value| range.clamp(value)), [10, 10, 15, 20, 20]);
}

#[test]
fn a_switch_sits_in_its_half_of_the_axis_or_as_far_outside_as_the_axis_backs_off() {
    for (end, from, to) in [(AxisEnd::Min, -50, 150), (AxisEnd::Max, 150, 350)] {
        for at in -60..=360 {
            let mut s = Settings::prototype();
            s.axes.x.length = Mm::const_from_int(300);
            s.endstops.x = Endstop { end, position: Mm::const_from_int(at) };
            assert_eq!(s.check().is_ok(), (from..=to).contains(&at), "{end:?} at {at} mm");
        }
    }
}

#[test]
fn two_heaters_that_are_fitted_share_no_output_and_no_sensor() {
    let mut s = Settings::prototype();
    let heaters = |s: &mut Settings, hotend, bed| {
        (s.thermal.heaters.hotend.is_fitted, s.thermal.heaters.bed.is_fitted) = (hotend, bed);
        s.check()
    };
    assert_eq!(heaters(&mut s, true, true), Ok(()), "each has its own");
    let own = s.thermal.heaters.bed;
    s.thermal.heaters.bed.output = s.thermal.heaters.hotend.output;
    assert_eq!(heaters(&mut s, true, true), Err(SettingsError::SharedHeater("output")));
    assert_eq!([heaters(&mut s, true, false), heaters(&mut s, false, true)], [Ok(()); 2]);
    s.thermal.heaters.bed = own;
    s.thermal.heaters.bed.sensor = s.thermal.heaters.hotend.sensor;
    assert_eq!(heaters(&mut s, true, true), Err(SettingsError::SharedHeater("sensor")));
    assert_eq!([heaters(&mut s, true, false), heaters(&mut s, false, true)], [Ok(()); 2]);
}

/// Reproducer: a gantry was legal with 16 microsteps for motors of one driver table and 32 for those of another. It
/// would have racked.
#[test]
fn motors_of_an_axis_go_equally_far_in_a_full_step_unless_their_pulleys_differ() {
    let z = [0, 0, 1, 0];
    let machine = |m1, m8, z1, belt, screws| {
        let mut s = Settings::prototype();
        s.belt.is_closed = false;
        s.axes.z.steps_per_mm = s.axes.x.steps_per_mm;
        s.mechanism = Mechanism::of(&[m1, [1, -1, 0, 0], m8, [1, 1, 0, 0], z1, z, [0, 0, 0, 1]]);
        (s.drivers.belt.microsteps, s.drivers.z.microsteps) = (belt, screws);
        s.check_machine()
    };
    let differ = |motors: [&str; 2], microsteps| {
        let motors = motors.map(MotorName::lit);
        Err(SettingsError::MicrostepsDiffer { motors, microsteps, keys: ["drivers.belt", "drivers.z"] })
    };
    assert_eq!(machine(z, z, z, 16, 16), Ok(()));
    assert_eq!(machine(z, z, z, 32, 32), Ok(()));
    assert_eq!(machine(z, z, z, 16, 32), Ok(()));
    let lift = [1, 1, 1, 0];
    assert_eq!(machine(lift, z, z, 32, 32), Ok(()));
    assert_eq!(machine(lift, z, z, 16, 32), differ(["m1", "m8"], [16, 32]));
    // Other microsteps of another axis do not matter, nor do the extruder's.
    assert_eq!(machine([0; 4], [0; 4], z, 16, 32), Ok(()));
    let mut alone = Settings::prototype();
    (alone.drivers.z.microsteps, alone.drivers.e.microsteps) = (32, 64);
    assert_eq!(alone.check_machine(), Ok(()));
    // Motors of x and z: a row twice as great goes with twice the microsteps; other pulleys go with the same ones.
    let belts = |m11, z1, belt, screws| {
        let mut s = Settings::prototype();
        s.belt.is_closed = false;
        s.axes.z.steps_per_mm = s.axes.x.steps_per_mm;
        s.mechanism = Mechanism::of(&[[0; 4], [0; 4], [0, 1, 0, 0], m11, z1, [0; 4], [0, 0, 0, 1]]);
        (s.drivers.belt.microsteps, s.drivers.z.microsteps) = (belt, screws);
        s.check()
    };
    assert_eq!(belts([1, 0, 1, 0], [0, 0, 2, 0], 16, 32), Ok(()));
    assert_eq!(belts([4, 0, 4, 0], [0, 0, 5, 0], 16, 16), Ok(()));
    assert_eq!(belts([1, 0, 1, 0], [0, 0, 1, 0], 16, 32), differ(["m11", "z1"], [16, 32]));
    assert_eq!(belts([4, 0, 4, 0], [0, 0, 5, 0], 16, 32), differ(["m11", "z1"], [16, 32]));
}

/// A stronger motor would drag the others along the belt.
#[test]
fn motors_of_a_closed_belt_have_one_current() {
    let mut s = Settings::prototype();
    let belt = [prototype::M1, prototype::M4, prototype::M8, prototype::M11];
    s.drivers.own[belt[1].index()].current_ma = 700;
    let motors = ["m1", "m4"].map(MotorName::lit);
    assert_eq!(s.check(), Err(SettingsError::BeltCurrents { motors, currents: [0, 700] }));
    let said = s.check().unwrap_err().to_string();
    assert!(
        said.starts_with("motors m1 and m4 pull one closed belt, but only m4 has its own current, 700 mA:"),
        "{said}"
    );
    // As much as the group's is no excuse: M906 X changes only the group.
    s.drivers.belt.current_ma = 700;
    assert!(s.check().is_err());
    belt.iter().for_each(|motor| s.drivers.own[motor.index()].current_ma = 700);
    assert_eq!(s.check(), Ok(()));
    s.drivers.own[belt[3].index()].current_ma = 0;
    let motors = ["m1", "m11"].map(MotorName::lit);
    assert_eq!(s.check(), Err(SettingsError::BeltCurrents { motors, currents: [700, 0] }));
    s.belt.is_closed = false;
    assert_eq!(s.check(), Ok(()), "two belts");
    s.belt.is_closed = true;
    belt.iter().for_each(|motor| s.drivers.own[motor.index()].current_ma = 0);
    // Other motors, and thresholds of a stall, may differ.
    (s.drivers.own[prototype::Z1.index()].current_ma, s.drivers.own[belt[0].index()].stall_threshold) = (600, 9);
    assert_eq!(s.check(), Ok(()));
    s.motor_names[prototype::Z1.index()] = MotorName::lit("e");
    assert_eq!(s.check(), Err(SettingsError::NamedAsGroup(MotorName::lit("e"))));
}

/// A second sensor guards a heater that is there, by an input that is not the heater's own.
#[test]
fn a_second_sensor_guards_a_heater_that_is_fitted() {
    let mut s = Settings::prototype();
    let [.., second] = &mut s.thermal.sensors;
    (second.is_fitted, second.guards) = (true, Some(Heater::Bed));
    assert_eq!(s.check(), Err(SettingsError::GuardsNothing("second")));
    s.thermal.heaters.bed.is_fitted = true;
    assert_eq!(s.check(), Ok(()));
    for sensor in [SensorSource::Mcu, SensorSource::At(s.thermal.heaters.bed.sensor)] {
        let mut nonsense = s;
        let [.., second] = &mut nonsense.thermal.sensors;
        second.sensor = sensor;
        assert_eq!(nonsense.check(), Err(SettingsError::GuardsNothing("second")), "{sensor:?}");
        second_is_off(&mut nonsense);
        assert_eq!(nonsense.check(), Ok(()));
    }
}

fn second_is_off(s: &mut Settings) {
    let [.., second] = &mut s.thermal.sensors;
    second.is_fitted = false;
}
