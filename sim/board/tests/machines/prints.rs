//! Prints: every machine homes, prints a file, and ends where it says.

use super::print::{Steps, machines, print, steps_of};
use corehbot::kinematics::Mechanism;
use corehbot::motors::{MOTORS, Motor};
use corehbot::units::Mm;
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::host::FileHost;
use corehbot_sim::limits::Limits;

/// A real file: homing, arcs, retractions, Z hops, and a long way home. It ends at its last place, counted from the
/// zero of homing; another print after the same homing gives that zero.
#[test]
fn every_machine_prints_a_file_and_ends_where_it_says() {
    let gcode = include_str!("../../../../examples/first-print.gcode");
    let body = gcode.split_once("G28 ; home all axes").unwrap().1;
    // X0 Y200 Z7 at the end, from a corner of the bed on a homed machine; the filament is the file's business.
    let start = [10.0, 20.0, 5.0];
    for (name, s) in machines() {
        let homed = print(&s, None, gcode);
        assert_eq!(homed.findings, Findings::default(), "{name}");
        assert_eq!(homed.outcome.underruns, 0, "{name}");
        let print = print(&s, Some(start.map(Mm::from_num)), body);
        assert_eq!(print.findings, Findings::default(), "{name}");
        assert!(print.events > 100_000, "{name}: {} events", print.events);
        let [sx, sy, sz] = start;
        let from = s.mechanism.inverse(steps_of(&s, [sx, sy, sz, 0.0]));
        let to = s.mechanism.inverse(steps_of(&s, [0.0, 200.0, 7.0, 0.0]));
        for (motor, row) in s.mechanism.motors().filter(|(_, row)| row[3] == 0) {
            let way = to[motor.index()] - from[motor.index()];
            assert_eq!(print.counts[motor.index()], way, "{name}: {} {row:?}", s.name_of(motor));
        }
    }
}

/// Homing meets each switch at its place: the way to a point starts at the first switch-on position, whatever the
/// motors.
#[test]
fn every_axis_of_every_machine_finds_its_switch() {
    let far = [31.7, 23.3, 12.4];
    for (name, s) in machines() {
        for (gcode, home) in [
            ("G28\nG28 Y\nG28 Z X\n", [true; 3]),
            ("G28 X\n", [true, false, false]),
            ("G28 Z\nG28 Y", [false, true, true]),
        ] {
            let print = print(&s, None, gcode);
            assert_eq!(print.findings, Findings::default(), "{name}: {gcode}");
            let back = s.mechanism.forward_kinematics().unwrap();
            let way = back.fractions(&print.counts).map(|(sum, over)| sum as f64 / over as f64);
            let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
            for axis in 0..3 {
                // A switch is pressed at or below 0; the step that the machine takes with it is one.
                let expected = if home[axis] { -(far[axis] * pitch[axis]).floor() } else { 0.0 };
                assert!((way[axis] - expected).abs() <= 1.0, "{name}: {gcode}: axis {axis} went {way:?}");
            }
        }
    }
}

/// Homing from between two steps finds the same zero however often, and the motors never come to rest against each
/// other.
#[test]
fn homing_again_and_again_adds_up_to_nothing() {
    for (name, s) in machines() {
        let mut gcode = "G28\n".to_owned();
        for i in 0..12 {
            let (x, y, z) = (20.013 + 3.0 * f64::from(i), 31.007 + f64::from(i), 3.0 + 0.317 * f64::from(i));
            gcode += &format!(
                "G1 X{x} Y{y} Z{z} F3000\nG91\nG1 X.013 Y.007 Z.004\nG90\nM400\nG28 {}\n",
                ["X", "Y", "Z"][i as usize % 3]
            );
        }
        gcode += "G28\nG1 X50 Y60 Z5 F3000\n";
        let print = print(&s, Some([0, 0, 0].map(Mm::from_num)), &gcode);
        assert_eq!(print.findings, Findings::default(), "{name}");
        let to = s.mechanism.inverse(steps_of(&s, [50.0, 60.0, 5.0, 0.0]));
        let end = print.counts;
        let way = s.mechanism.forward_kinematics().unwrap().fractions(&end).map(|(sum, over)| sum as f64 / over as f64);
        let wanted =
            s.mechanism.forward_kinematics().unwrap().fractions(&to).map(|(sum, over)| sum as f64 / over as f64);
        for axis in 0..3 {
            assert!((way[axis] - wanted[axis]).abs() <= 2.0, "{name}: axis {axis} {way:?} {wanted:?}");
        }
    }
}

/// Missing motors get neither steps nor power, and need no proof of their driver.
#[test]
fn motors_that_are_not_fitted_are_left_alone() {
    for (name, s) in machines() {
        let drivers = Drivers::new();
        let mut host = FileHost::new("G28\nG1 X10 Y10 Z1 E1 F3000\nM400\nM122\n");
        let mut steps =
            Steps { checker: Checker::new(&s, &Limits::new(&s, None, "G28")), counts: [0; MOTORS], events: 0 };
        let storage = corehbot::port::NoStorage;
        let outcome = corehbot_sim::world::run_on(&s, None, storage, &drivers, &mut [&mut host], &mut steps).unwrap();
        assert!(!outcome.halted && host.failure().is_none(), "{name}");
        let fitted = s.mechanism.fitted();
        assert_eq!(drivers.enabled(), fitted, "{name}");
        for motor in Motor::ALL {
            let (is_fitted, chip) = (fitted.has(motor), drivers.chip(motor));
            assert_eq!(chip.replies() > 0, is_fitted, "{name}: {}", s.name_of(motor));
            assert!(is_fitted || steps.counts[motor.index()] == 0, "{name}: {}", s.name_of(motor));
        }
    }
}

/// The examples are the machines that their names say.
#[test]
fn there_is_a_file_for_every_kind_of_machine() {
    let machines = machines();
    let of = |name: &str| machines.iter().find(|(file, _)| file == name).unwrap().1.mechanism;
    assert_eq!(of("prototype"), Mechanism::corehbot());
    // The firmware sees no difference between a CoreXY and an H-bot, or between axes that move the bed and axes that
    // move the head.
    assert_eq!(of("corexy"), of("hbot"));
    assert_eq!(of("cartesian"), of("cartesian-xz"));
    let motors = |name: &str| of(name).fitted().0.count_ones();
    let counted = [
        "corexy",
        "awd-corexy",
        "corehbot-two-drivers",
        "corehbot-three-screws",
        "corexyz",
        "corexyz-three",
        "corexz",
        "cartesian",
        "dual-y",
        "core-unequal",
    ];
    assert_eq!(counted.map(motors), [4, 6, 5, 8, 5, 4, 4, 5, 5, 4]);
    // Every file is one of those above.
    let looked_at = [&["prototype", "hbot", "cartesian-xz"][..], &counted].concat();
    for (name, _) in &machines {
        assert!(looked_at.contains(&name.as_str()), "{name}: say here what kind of machine it is");
    }
}
