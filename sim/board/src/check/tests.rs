//! The checker against synthetic motion: sound traces pass, each kind of fault is found.

mod plain;

use super::*;
use corehbot::motors::MOTORS;
use corehbot::settings::Settings;

/// Steps a path that is given as positions (x, y, z, e in mm) over time, as an ideal firmware would.
struct Motion {
    checker: Checker,
    stands: [i64; 4],
    time: u64,
    pulses: [i32; MOTORS],
}

impl Motion {
    fn new(gcode: &str) -> Self {
        let checker = Checker::new(&Settings::prototype(), &Limits::new(&Settings::prototype(), None, gcode));
        Self { checker, stands: [0; 4], time: 0, pulses: [0; MOTORS] }
    }

    /// Follows `position(t)` for `seconds`, looking every 10 us.
    fn follow(&mut self, seconds: f64, position: impl Fn(f64) -> [f64; 4]) -> &mut Self {
        for i in 1..=(seconds * 1e5) as u64 {
            let [x, y, z, e] = position(i as f64 / 1e5);
            let wanted = [(x + y) * 80.0, (x - y) * 80.0, z * 800.0, e * 400.0].map(|p| (p + 0.5).floor() as i64);
            let (mut steps, mut forward) = (0, 0);
            // Bits of each coordinate's motors: forward with it, forward against it.
            let motors = [(0x08u8, 0x02u8), (0x04, 0x01), (0x30, 0), (0x40, 0)];
            for ((stand, want), (with, against)) in self.stands.iter_mut().zip(wanted).zip(motors) {
                let way = (want - *stand).signum();
                *stand += way;
                if way != 0 {
                    steps |= with | against;
                    forward |= if way > 0 { with } else { against };
                }
            }
            self.event(self.time + i * 100, steps, forward);
        }
        self.time += (seconds * 1e7) as u64;
        self
    }

    fn event(&mut self, tick: u64, steps: u8, forward: u8) {
        if steps != 0 {
            self.checker.event(tick, MotorSet(steps), MotorSet(forward));
        }
        for (i, pulses) in self.pulses.iter_mut().enumerate() {
            *pulses += i32::from(steps >> i & 1) * (2 * i32::from(forward >> i & 1) - 1);
        }
    }

    fn findings(self) -> Findings {
        self.checker.finish(Some(self.pulses))
    }
}

/// A trapezoid from 0 over `way` with acceleration `a` to speed `v`, at time `t`.
fn trapezoid(t: f64, way: f64, v: f64, a: f64) -> f64 {
    let ramp = v / a;
    let level = way / v - ramp;
    let ramp_way = a * ramp * ramp / 2.0;
    if t < ramp {
        a * t * t / 2.0
    } else if t < ramp + level {
        ramp_way + v * (t - ramp)
    } else {
        way - a * (2.0 * ramp + level - t).max(0.0).powi(2) / 2.0
    }
}

fn found(findings: &Findings, text: &str) -> bool {
    findings.first.iter().any(|v| v.text.contains(text))
}

#[test]
fn trapezoids_at_the_limits_pass() {
    let mut m = Motion::new("");
    m.follow(0.5, |t| [trapezoid(t, 100.0, 300.0, 5000.0), 0.0, 0.0, 0.0]);
    m.follow(0.5, |t| [100.0, trapezoid(t, 100.0, 300.0, 5000.0), 0.0, 0.0]);
    m.follow(0.5, |t| [100.0 - trapezoid(t, 70.0, 225.0, 3750.0), 100.0 - trapezoid(t, 70.0, 225.0, 3750.0), 0.0, 0.0]);
    m.follow(0.5, |t| [30.0, 30.0, trapezoid(t, 5.0, 20.0, 200.0), trapezoid(t, 12.0, 80.0, 5000.0)]);
    assert_eq!(m.findings(), Findings::default());
}

#[test]
fn a_corner_may_jump_as_far_as_the_settings_say() {
    let mut m = Motion::new("");
    // Along x, a corner at 16 mm/s, then along y, at the end of a deceleration and the begin of an acceleration.
    let v = 16.0;
    let ramp = (300.0 - v) / 5000.0;
    let run = |t: f64| v * t + 2500.0 * t * t;
    let end = run(ramp);
    m.follow(300.0 / 5000.0, |t| [2500.0 * t * t, 0.0, 0.0, 0.0]);
    m.follow(ramp, |t| [9.0 + end - run(ramp - t), 0.0, 0.0, 0.0]);
    m.follow(ramp, |t| [9.0 + end, run(t), 0.0, 0.0]);
    m.follow(300.0 / 5000.0, |t| [9.0 + end, end + 300.0 * t - 2500.0 * t * t, 0.0, 0.0]);
    assert_eq!(m.findings(), Findings::default());
}

#[test]
fn a_circle_at_the_acceleration_limit_passes() {
    let mut m = Motion::new("");
    let (r, a) = (5.0f64, 3000.0);
    let v = (r * a).sqrt();
    m.follow(1.0, |t| {
        let angle = v / r * (t - 0.05 + 0.05 * (-t / 0.05).exp());
        [r * angle.cos() - r, r * angle.sin(), 0.0, 0.0]
    });
    assert_eq!(m.findings().first.iter().filter(|f| f.tick < 9_900_000).count(), 0, "only the sudden end is a fault");
}

#[test]
fn twice_the_acceleration_is_found() {
    for axis in 0..2 {
        let mut m = Motion::new("");
        m.follow(0.5, |t| {
            let mut p = [0.0; 4];
            p[axis] = trapezoid(t, 100.0, 300.0, 10_000.0);
            p
        });
        assert!(found(&m.findings(), "accelerates"), "axis {axis}");
    }
    let mut m = Motion::new("");
    m.follow(0.5, |t| [0.0, 0.0, 0.0, trapezoid(t, 20.0, 80.0, 10_000.0)]);
    assert!(found(&m.findings(), "e accelerates"));
}

#[test]
fn a_sudden_start_is_found() {
    let mut m = Motion::new("");
    m.follow(0.3, |t| [70.0 * t, 0.0, 0.0, 0.0]);
    assert!(found(&m.findings(), "x accelerates"));
    let mut m = Motion::new("");
    m.follow(0.3, |t| [0.0, 0.0, 12.0 * t, 0.0]);
    assert!(found(&m.findings(), "z accelerates"));
}

#[test]
fn an_axis_above_its_speed_is_found() {
    let mut m = Motion::new("");
    m.follow(1.0, |t| [0.0, 0.0, trapezoid(t, 15.0, 21.0, 150.0), 0.0]);
    assert!(found(&m.findings(), "z moves at"));
    let mut m = Motion::new("M203 Z30");
    m.follow(1.0, |t| [0.0, 0.0, trapezoid(t, 15.0, 21.0, 150.0), 0.0]);
    assert_eq!(m.findings(), Findings::default());
}

#[test]
fn a_homing_stop_is_hard_in_a_touch_alone() {
    let stop = |gcode: &str, is_touch: bool| {
        let mut m = Motion::new(gcode);
        let down = |t: f64| -8.0 * (t - 0.05 + 0.05 * (-t / 0.05).exp());
        m.follow(0.5, |t| [0.0, 0.0, down(t), 0.0]);
        if is_touch {
            m.checker.stopped(m.time);
        }
        m.follow(0.1, |t| [0.0, 0.0, down(0.5) + trapezoid(t, 0.2, 5.0, 200.0), 0.0]);
        m.findings()
    };
    assert_eq!(stop("G28", true), Findings::default());
    // The print has homed, and nothing was touched.
    assert!(found(&stop("G28", false), "z accelerates"));
    assert!(found(&stop("G1", true), "z accelerates"));
}

/// Moves along x, then z starts at `first` mm/s with its own acceleration from there on.
fn hop(gcode: &str, first: f64) -> Findings {
    let mut m = Motion::new(gcode);
    m.follow(0.5, |t| [trapezoid(t, 30.0, 100.0, 1250.0), 0.0, 0.0, 0.0]);
    let (a, ramp) = (200.0, 0.01);
    let up = move |t: f64| {
        let (rise, fall) = (first * ramp + a * ramp * ramp / 2.0, first + a * ramp);
        if t < ramp { first * t + a * t * t / 2.0 } else { rise + trapezoid_end(t - ramp, fall, a) }
    };
    m.follow(0.3, |t| [30.0, 0.0, up(t), 0.0]);
    m.findings()
}

/// Brakes from `v` to rest.
fn trapezoid_end(t: f64, v: f64, a: f64) -> f64 {
    let t = t.min(v / a);
    v * t - a * t * t / 2.0
}

/// The law that gave z the speed of the corner: 8 mm/s of w, whatever z bears. What its own acceleration explains
/// passes.
#[test]
fn a_z_that_starts_without_its_ramp_is_found_though_the_print_has_homed() {
    let limits = "M201 X1000 Y1000 Z200 E5000\nM204 P1250 R1250 T1250\n";
    for (jerks, w, cap) in [
        ("M205 X8.00 Y8.00 Z0.40 E4.50\n", 8.0, 0.4),
        ("M205 X8\n", 8.0, f64::INFINITY),
        ("M205 X5\n", 5.0, f64::INFINITY),
        ("SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=20\n", 20.0, f64::INFINITY),
    ] {
        let gcode = format!("{limits}{jerks}G28\nG1 X30\nG1 Z5\n");
        let findings = hop(&gcode, w);
        assert!(found(&findings, "z changes its speed"), "{jerks}: {findings:?}");
        let sound: f64 = w * (200.0f64 / 1250.0).sqrt();
        assert_eq!(hop(&gcode, sound.min(cap)), Findings::default(), "{jerks}");
    }
    // The same where homing came before the limits of the file, under the rule of the settings.
    assert!(found(&hop(&format!("G28\n{limits}M205 X8 Z0.4\nG1 X30\n"), 8.0), "z changes its speed"));
}

/// *Reproducer*: G34 turned each screw with the belt's 1500 mm/s^2 instead of z's 200. The checker saw the first one,
/// which it took for z, and not the second.
#[test]
fn a_screw_that_turns_alone_is_held_to_the_limits_of_z_whichever_it_is() {
    for (motor, name) in [(0x10, "z "), (0x20, "z2 ")] {
        let turn = |acceleration: f64| {
            let (mut m, mut stands) = (Motion::new("G34"), 0);
            for i in 1..=30_000 {
                let wanted = (trapezoid(f64::from(i) / 1e5, 0.5, 8.0, acceleration) * 800.0 + 0.5).floor() as i64;
                if wanted > std::mem::replace(&mut stands, wanted) {
                    m.event(i as u64 * 100, motor, motor);
                }
            }
            m.findings()
        };
        assert_eq!(turn(200.0), Findings::default(), "{name}");
        let findings = turn(1500.0);
        assert!(found(&findings, &format!("{name}changes its speed")), "{findings:?}");
    }
}

#[test]
fn a_heavy_y_that_starts_without_its_ramp_is_found() {
    let start = |first: f64| {
        let mut s = Settings::prototype();
        s.axes.y.max_acceleration = corehbot::units::MmPerSec2::from_num(300);
        let limits = Limits::new(&s, None, "M204 P3000 T3000\nM205 X20\nG28\nG1 X30\n");
        let mut m = Motion { checker: Checker::new(&s, &limits), ..Motion::new("") };
        m.follow(0.5, |t| [trapezoid(t, 30.0, 100.0, 3000.0), 0.0, 0.0, 0.0]);
        m.follow(0.3, |t| [30.0, trapezoid_end(t, first, 300.0), 0.0, 0.0]);
        m.findings()
    };
    assert!(found(&start(20.0), "y changes its speed"));
    assert_eq!(start(20.0 * 0.1f64.sqrt()), Findings::default());
}

#[test]
fn a_missing_step_a_short_pulse_and_falling_time_are_found() {
    let mut m = Motion::new("");
    m.event(100, 0x0F, 0x0C);
    m.event(109, 0x0F, 0x0C);
    m.event(1000, 0x0E, 0x0C);
    m.event(900, 0x30, 0x10);
    let findings = m.checker.finish(None);
    for text in ["m11 are 9 ticks apart", "out of step", "time falls"] {
        assert!(found(&findings, text), "{text}: {findings:?}");
    }
}

#[test]
fn motors_out_of_step_are_told_once_until_they_are_in_step_again() {
    let mut m = Motion::new("");
    // Motor 1 misses a step, others continue, it makes the step, and misses another.
    for (n, (steps, forward)) in
        [(0x0E, 0x0C), (0x30, 0x30), (0x01, 0), (0x30, 0), (0x0E, 0x0C)].into_iter().enumerate()
    {
        m.event(1000 * (n as u64 + 1), steps, forward);
    }
    let findings = m.checker.finish(None);
    let ticks: Vec<_> = findings.first.iter().filter(|v| v.text.contains("out of step")).map(|v| v.tick).collect();
    assert_eq!(ticks, [1000, 5000], "{findings:?}");
}

#[test]
fn a_wrong_end_is_found() {
    let mut m = Motion::new("");
    m.event(100, 0x40, 0x40);
    m.pulses[6] = 2;
    assert!(found(&m.findings(), "e0 ends at step 1 instead of 2"));
}

/// Along x at `speed`, and to and fro in y by 0.1 mm with a wave length of 1 mm, which grows from nothing.
fn wave(speed: f64) -> Findings {
    let mut motion = Motion::new("");
    motion.follow(2.2, |t| {
        let x = trapezoid(t, 2.0 * speed, speed, 1000.0);
        let y = 0.1 * (t / 0.5).min(1.0).min((2.0 - t).max(0.0) / 0.5) * (std::f64::consts::TAU * x).sin();
        [x, y, 0.0, 0.0]
    });
    motion.findings()
}

#[test]
fn a_wave_that_is_run_too_fast_is_found_though_it_is_short() {
    // 4 m/s2, and 23 m/s2.
    assert_eq!(wave(32.0).first, []);
    let findings = wave(76.0);
    assert!(findings.first.iter().any(|v| v.text.starts_with("y changes its speed by")), "{findings:?}");
}
