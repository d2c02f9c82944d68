//! Motors that several axes share: they step at once, and are never strained.

use super::answers::answers;
use super::print::{machines, print};
use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::settings::{Cartesian, Settings};
use corehbot::units::Mm;
use corehbot_sim::check::Findings;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Sink, run};

/// Keeps the motors of every event.
#[derive(Default)]
pub struct Motors(pub Vec<MotorSet>);

impl Sink for Motors {
    fn event(&mut self, _tick: u64, steps: MotorSet, _forward: MotorSet) {
        self.0.push(steps);
    }
}

/// Homing one axis puts all that share motors with it on whole steps; from there a move of an axis takes all its motors
/// along at once, without zig-zag.
#[test]
fn after_homing_an_axis_moves_alone() {
    for (name, mut s) in machines() {
        for (axis, back_off) in [(0, 5.0), (1, 5.0), (2, 5.0), (0, 0.4), (1, 0.4), (2, 0.4)] {
            // Ways of less than a millimetre end where they are sent, on no whole step.
            let Cartesian { x, y, z } = &mut s.homing;
            [x, y, z].into_iter().for_each(|homing| homing.back_off = Mm::from_num(back_off));
            if !(0..3).any(|other| other != axis && s.mechanism.share(axis, other)) {
                continue;
            }
            let letter = ["X", "Y", "Z"][axis];
            let gcode = format!("G1 X10.006 Y20.012 Z5.0042 F600\nG28 {letter}\nG1 {letter}5 F600\n");
            let mut motors = Motors::default();
            let mut host = FileHost::new(&gcode);
            run(&s, Some([10, 20, 5].map(Mm::from_num)), &mut host, &mut motors).unwrap();
            let last = &motors.0[motors.0.len() - 390..];
            // Motors of different pulleys step as often as these say, and so hardly ever together.
            if s.mechanism.has_multiples() {
                let steps = |motor: Motor| last.iter().filter(|steps| steps.has(motor)).count();
                let (long, short) = (steps(prototype::M11), steps(prototype::M8));
                assert!((4 * short).abs_diff(5 * long) <= 9, "{letter}: {short} and {long}");
                continue;
            }
            assert!(last.iter().all(|steps| *steps == s.mechanism.motors_of(axis)), "{name}: {letter} {last:?}");
        }
    }
}

/// M92 gives a place between new steps its name; the motors must not come to pull against each other, each time by a
/// step more.
#[test]
fn other_resolutions_strain_nothing() {
    for (name, s) in machines() {
        let mut gcode = String::new();
        for i in 1..40 {
            let per_mm = 80.0 - f64::from(i) * 0.137;
            gcode +=
                &format!("M92 X{per_mm} Y{per_mm} Z{per_mm}\nG1 X{} Y{} Z{} F3000\n", 10 + i, 20 + 2 * i, 5 + i % 7);
        }
        assert_eq!(print(&s, Some([10, 20, 5].map(Mm::from_num)), &gcode).findings, Findings::default(), "{name}");
    }
}

/// M92 may not give axes that share motors different steps; where nothing is shared, it may.
#[test]
fn m92_respects_shared_motors() {
    let refused =
        |s: &Settings, line: &str| answers(s, &[line]).iter().any(|said| said.starts_with("echo:M92 ignored"));
    for (name, s) in machines() {
        let shares = s.mechanism.share(0, 1);
        assert_eq!(refused(&s, "M92 X90"), shares || s.mechanism.share(0, 2), "{name}");
        assert_eq!(refused(&s, "M92 Z90"), s.mechanism.share(0, 2) || s.mechanism.share(1, 2), "{name}");
        assert!(!refused(&s, "M92 X90 Y90 Z90"), "{name}");
    }
}
