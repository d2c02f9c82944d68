//! Motion so slow that it outlasts ticks of 32 bits and the look-ahead.

use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Outcome, Sink, run};

struct Nothing;

impl Sink for Nothing {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

/// The ticks of the first and the last step.
#[derive(Default)]
struct Ends(Option<[u64; 2]>);

impl Sink for Ends {
    fn event(&mut self, tick: u64, _steps: MotorSet, _forward: MotorSet) {
        self.0 = Some([self.0.map_or(tick, |[first, _]| first), tick]);
    }
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

/// Reproducer: feeds were cut off to whole 65,536ths of a mm/s, so F0.6 was 0.055 % slow. A step is 0.0125 mm.
#[test]
fn a_slow_feed_is_as_fast_as_it_says() {
    for feed in [0.6, 0.7, 1.0, 7.0, 13.0, 29.0, 100.0, 777.7] {
        let (mut ends, length) = (Ends::default(), if feed < 10.0 { 0.5 } else { 5.0 });
        let gcode = format!("G1 X{} F{feed}\nM400\n", 20.0 + length);
        run(&Settings::prototype(), Some([20, 20, 1].map(Mm::from_num)), &mut FileHost::new(&gcode), &mut ends)
            .unwrap();
        let [first, last] = ends.0.unwrap();
        // Between these steps it has the speed of the feed, except for ramps that are shorter than a step.
        let speed = feed / 60.0;
        let ramps = speed / 3000.0;
        let (found, expected) = ((last - first) as f64 / 1e7, (length - 0.0125) / speed);
        assert!((found - expected).abs() < 5e-5 * expected + ramps, "F{feed}: {found} s, {expected} s expected");
    }
}
