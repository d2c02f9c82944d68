//! Any machine, any path, any shaping: the steps keep the limits of axes and motors, and two pulses of a motor are
//! never too close. Speeds jump no more than corners may, and the end is met to the step.

use corehbot::motors::{MOTORS, Motor, MotorSet};
use corehbot::settings::{CornerRule, Settings, Shaper, ShaperKind};
use corehbot::units::{Hertz, Mm, MmPerSec, MmPerSec2, Ratio, Seconds};
use corehbot_sim::check::{Checker, Findings};
use corehbot_sim::host::FileHost;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::{Sink, run};
use proptest::prelude::*;

/// Checks the played events, and counts them.
struct Steps {
    checker: Checker,
    counts: [i64; MOTORS],
}

impl Sink for Steps {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.checker.event(tick, steps, forward);
        for (count, motor) in self.counts.iter_mut().zip(Motor::ALL) {
            if steps.has(motor) {
                *count += if forward.has(motor) { 1 } else { -1 };
            }
        }
    }

    fn stopped(&mut self, tick: u64) {
        self.checker.stopped(tick);
    }
}

fn shapers() -> impl Strategy<Value = Shaper> {
    let kind = proptest::sample::select(ShaperKind::all().collect::<Vec<_>>());
    let span = prop_oneof![Just(0.0), 500.0..1000.0f64];
    let motor = prop_oneof![Just(0.0), 100.0..400.0f64];
    (kind, 30.0..200.0f64, 0.0..0.2f64, span, motor).prop_map(|(kind, frequency, damping, span, motor)| Shaper {
        span: Mm::from_num(span),
        motor_frequency: Hertz::from_num(motor),
        ..Shaper::new(kind, Hertz::from_num(frequency), Ratio::from_num(damping))
    })
}

fn machines() -> impl Strategy<Value = Settings> {
    let accelerations = (500.0..10_000.0f64, 500.0..10_000.0f64, 500.0..10_000.0f64, 300.0..10_000.0f64);
    let rule = proptest::sample::select(CornerRule::all().collect::<Vec<_>>());
    let corner = (rule, 0.0..1.0f64).prop_map(|(rule, part)| match rule {
        CornerRule::JunctionDeviation(_) => CornerRule::JunctionDeviation(Mm::from_num(0.002 + 0.198 * part)),
        CornerRule::SquareCorner(_) => CornerRule::SquareCorner(MmPerSec::from_num(1.0 + 19.0 * part)),
    });
    let speeds = (100.0..400.0f64, 100.0..600.0f64);
    let shaped = (shapers(), proptest::option::of(shapers()));
    let advance = prop_oneof![
        Just((0.0, None)),
        (0.0..0.1f64, proptest::option::of(0.005..0.06f64)),
        (0.1..4.0f64, proptest::option::of(0.005..0.2f64)),
    ];
    (accelerations, corner, speeds, shaped, advance, 0.0..0.9f64).prop_map(
        |((x, y, motor, print), corner, (speed, belt), (shaper, other), (time, window), cruise)| {
            let mut s = Settings::prototype();
            s.axes.x.max_acceleration = MmPerSec2::from_num(x);
            s.axes.y.max_acceleration = MmPerSec2::from_num(y);
            s.motor_max_acceleration = MmPerSec2::from_num(motor);
            s.print_acceleration = MmPerSec2::from_num(print);
            (s.axes.x.max_speed, s.axes.y.max_speed) = (MmPerSec::from_num(speed), MmPerSec::from_num(speed * 0.9));
            s.motor_max_speed = MmPerSec::from_num(belt);
            s.corner = corner;
            (s.shapers.x, s.shapers.y) = (shaper, other.unwrap_or(shaper));
            (s.advance.time, s.advance.window) = (Seconds::from_num(time), window.map(Seconds::from_num));
            s.minimum_cruise_ratio = Ratio::from_num(cruise);
            s
        },
    )
}

/// The checker's limits for these settings. An axis that speeds up more slowly than the belts is seen only as well as
/// these: when they speed up for the other axis too, their steps fall at different times. Where x and y are shaped
/// differently, a belt motor runs the sum of an x and a y of different moments, which the planner does not limit.
fn limits(s: &Settings) -> Limits {
    let mut limits = Limits::new(s, None, "");
    let (axes, belts) = limits.of.split_at_mut(4);
    for axis in &mut axes[..2] {
        let unseen = |acceleration: f64| (acceleration * axis.step).sqrt();
        axis.jump += (unseen(belts[0].acceleration) - unseen(axis.acceleration)).max(0.0);
    }
    if s.shapers.x != s.shapers.y {
        let (axes, belts) = limits.of.split_at_mut(4);
        let (x, y) = (&axes[0], &axes[1]);
        for belt in belts {
            (belt.speed, belt.acceleration) = (x.speed + y.speed, x.acceleration + y.acceleration);
            belt.jump = x.jump + y.jump;
        }
    }
    limits
}

/// Prints moves from (100, 100, 10) to (50, 60, 12); returns the findings, and the turns of the motors.
fn print(s: &Settings, moves: &[(i32, i32, i32, i32, u32)], scale: f64) -> (Findings, [i64; MOTORS]) {
    let mut gcode = "M83\nG91\nM211 S0\n".to_owned();
    for (x, y, z, e, f) in moves {
        let [x, y, z, e] = [x, y, z, e].map(|v| f64::from(*v) * scale);
        gcode += &format!("G1 X{x:.3} Y{y:.3} Z{:.3} E{:.4} F{f}\n", z / 20.0, e / 100.0);
    }
    gcode += "G90\nG1 X50 Y60 Z12 F9000\nM400\n";
    let mut steps = Steps { checker: Checker::new(s, &limits(s)), counts: [0; MOTORS] };
    let start = Some([100, 100, 10].map(Mm::from_num));
    let outcome = run(s, start, &mut FileHost::new(&gcode), &mut steps).unwrap();
    (steps.checker.finish(Some(outcome.counts)), steps.counts)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_machine_is_asked_for_more_than_it_bears(
        s in machines(),
        moves in proptest::collection::vec((-300i32..300, -300i32..300, -6i32..6, 0i32..200, 600u32..18000), 3..80),
        scale in prop_oneof![Just(0.1), Just(0.02), Just(0.005)],
    ) {
        let (findings, counts) = print(&s, &moves, scale);
        prop_assert_eq!(findings.total, 0, "{:?} {:?}", findings.first, s);
        // u = x + y drives 11 and 4, v = x - y drives 8 and 1: -50 mm and -40 mm at 80 steps/mm.
        let [m1, m4, m8, m11, z1, z2, ..] = counts;
        prop_assert_eq!([m1, m4, m8, m11, z1, z2], [800, 7200, -800, -7200, 1600, 1600]);
    }
}

/// The belts speed up for x by eight times as much as y may, and their steps fall at different times. So half steps of
/// y come and go, though it hardly moves.
#[test]
fn a_slow_axis_of_belts_that_speed_up_for_the_other_one_is_no_finding() {
    let mut s = Settings::prototype();
    (s.axes.x.max_acceleration, s.axes.y.max_acceleration) = (MmPerSec2::lit("6556.953"), MmPerSec2::lit("660.367"));
    (s.motor_max_acceleration, s.print_acceleration) = (MmPerSec2::lit("5238.33"), MmPerSec2::lit("7504.176"));
    (s.axes.x.max_speed, s.axes.y.max_speed) = (MmPerSec::from_num(100), MmPerSec::from_num(90));
    s.motor_max_speed = MmPerSec::from_num(100);
    s.corner = CornerRule::SquareCorner(MmPerSec::from_num(1));
    let shaper = Shaper::new(ShaperKind::Zvd, Hertz::from_num(30), Ratio::from_num(0));
    (s.shapers.x, s.shapers.y) = (shaper, shaper);
    s.minimum_cruise_ratio = Ratio::from_num(0);
    let (findings, _) = print(&s, &[(-107, 7, 0, 0, 3171), (158, -52, 0, 0, 2898), (0, 0, 0, 0, 600)], 0.02);
    assert_eq!(findings.total, 0, "{:?}", findings.first);
}
