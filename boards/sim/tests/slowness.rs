//! Motion so slow that it outlasts ticks of 32 bits and the look-ahead.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Outcome, Sink, run};

struct Nothing;

impl Sink for Nothing {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

fn print(gcode: &str) -> Outcome {
    let start = Some([20, 20, 1].map(Mm::from_num));
    run(&Settings::prototype(), start, &mut FileHost::new(gcode), &mut Nothing).unwrap()
}

fn steps(outcome: &Outcome, motor: Motor) -> i32 {
    outcome.counts[motor.index()].abs()
}

/// Reproducer: where motors were under way for more than 1.7 s without a step, the generator looked for the next one
/// for ever, and nothing below it ran.
#[test]
fn a_step_may_be_seconds_away() {
    let outcome = print("M220 S10\nG1 X21 F1\nG1 X20 F600\nG1 X21 Y20.2 F0.5\nM400\n");
    assert!(outcome.ticks > 600 * 10_000_000, "{} ticks", outcome.ticks);
    assert_eq!(outcome.underruns, 0);
    assert_eq!((steps(&outcome, prototype::M1), steps(&outcome, prototype::M4)), (64, 96), "x + 1, y + 0.2");
}

/// Reproducer: a resolution that changed 220 s after the begin of motion gave all later steps times before the start,
/// so they never came.
#[test]
fn a_resolution_may_change_after_minutes() {
    let outcome = print("G4 S220\nM92 X81 Y81\nG1 X60 F6000\nG1 X20\nG1 X30\nM400\n");
    assert_eq!((steps(&outcome, prototype::M1), steps(&outcome, prototype::M4)), (810, 810));
    let outcome = print("G4 S220\nM92 E97\nG92 E0\nM302 S0\nG1 E30 F600\nM400\n");
    assert_eq!(steps(&outcome, prototype::E0), 2910);
}
