//! Slow axes behind a corner: their first steps come as their own ramp from the speed in the corner explains, in every
//! file that sets a square-corner velocity.

use corehbot::motors::{MotorName, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Sink, run};

/// The ticks of the steps of some motors.
struct Steps {
    of: MotorSet,
    at: Vec<u64>,
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, _: MotorSet) {
        if steps.intersects(self.of) {
            self.at.push(tick);
        }
    }
}

fn steps(motor: &str, gcode: &str) -> Vec<u64> {
    let settings = Settings::prototype();
    let is_it = |name: &MotorName| name.as_str() == motor;
    let place = settings.motor_names.iter().position(is_it).unwrap();
    let (mut steps, mut host) = (Steps { of: MotorSet(1 << place), at: Vec::new() }, FileHost::new(gcode));
    run(&settings, Some([100, 100, 50].map(Mm::from_num)), &mut host, &mut steps).unwrap();
    assert_eq!(host.failure(), None);
    steps.at
}

/// Of each stretch of steps without a rest, the greatest excess of a step's speed over the ramp from `first` mm/s with
/// that acceleration.
fn worst(steps: &[u64], steps_per_mm: f64, first: f64, acceleration: f64) -> f64 {
    let is_joined = |a: &u64, b: &u64| b - a < u64::from(TICKS_PER_SECOND) / 50;
    let excesses = steps.chunk_by(is_joined).flat_map(|stretch| {
        stretch.windows(2).enumerate().map(move |(n, pair)| {
            let speed = f64::from(TICKS_PER_SECOND) / steps_per_mm / (pair[1] - pair[0]) as f64;
            // From the corner on it has gone so far at most when the second of the two steps comes.
            let way = (n as f64 + 2.0) / steps_per_mm;
            speed / (first * first + 2.0 * acceleration * way).sqrt()
        })
    });
    excesses.fold(0.0, f64::max)
}

const MACHINE_LIMITS: &str = "M201 X1000 Y1000 Z200 E5000\nM203 X200 Y200 Z12 E120\nM204 P1250 R1250 T1250\n";

/// Reproducer: the block of machine limits that PrusaSlicer writes made z start at 8 mm/s, 6,400 steps/s.
#[test]
fn a_hop_behind_the_machine_limits_of_a_slicer_has_its_ramp() {
    let hops = "G1 X150 F9000\nG1 Z50.4 F9000\nG1 X100 F9000\nG1 Z50 F9000\nG1 X150 F9000\n";
    for (jerks, first) in [
        ("M205 X8.00 Y8.00 Z0.40 E4.50\n", 0.4),
        ("M205 X8.00\n", 8.0 * (200.0f64 / 1250.0).sqrt()),
        ("M205 X20 Y5\n", 5.0 * (200.0f64 / 1250.0).sqrt()),
        ("SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=20\n", 20.0 * (200.0f64 / 1250.0).sqrt()),
        ("M205 J0.02 Z1\n", 1.0),
    ] {
        for homing in ["", "G28 Z\nG1 Z50 F600\n"] {
            let at = steps("z1", &format!("{homing}{MACHINE_LIMITS}{jerks}{hops}"));
            // The hops alone: homing has its own speeds.
            let hops = &at[at.len() - 2 * 320..];
            let worst = worst(hops, 800.0, first, 200.0);
            assert!(worst < 1.01, "{homing}{jerks}: {worst} of the ramp");
        }
    }
}

/// A heavy bed in y, as bed slingers have it.
#[test]
fn a_slow_y_has_its_ramp_too() {
    let zigzag = "G1 X150 F9000\nG1 Y150 F9000\nG1 X100 F9000\nG1 Y100 F9000\nG1 X150 F9000\n";
    let at = steps("m1", &format!("M201 X3000 Y300\nM204 P3000 T3000\nM205 X20\n{zigzag}"));
    // In the bed plane a belt motor turns for x and y. It never stops in a corner, so its speed there is what y has.
    let fast = f64::from(TICKS_PER_SECOND) / 80.0;
    let speeds: Vec<f64> = at.windows(2).map(|pair| fast / (pair[1] - pair[0]) as f64).collect();
    // 50 mm of x before the corner, to the step.
    let corner = 50 * 80;
    let behind = &speeds[corner + 1..corner + 5];
    let first = 20.0 * (300.0f64 / 3000.0).sqrt();
    assert!(behind.iter().all(|v| *v < (first * first + 2.0 * 300.0 * 6.0 / 80.0).sqrt() * 1.02), "{behind:?}");
}

/// What is set is reported, kept by M500's lines, and counts from the next move on.
#[test]
fn the_jerk_of_z_counts_from_the_next_move_on() {
    let hop = "G1 X150 F9000\nG1 Z52 F9000\nG1 X100 F9000\nG1 Z50 F9000\n";
    let at = steps("z1", &format!("M205 X20\n{hop}M205 Z0.5\n{hop}"));
    let [slow, capped] = [&at[..2 * 1600], &at[2 * 1600..]];
    let first = 20.0 * (200.0f64 / 5000.0).sqrt();
    assert!(worst(slow, 800.0, first, 200.0) < 1.01 && worst(slow, 800.0, 0.5, 200.0) > 2.0);
    assert!(worst(capped, 800.0, 0.5, 200.0) < 1.01);
}
