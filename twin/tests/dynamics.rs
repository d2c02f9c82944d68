//! The machine in motion, against closed forms of an oscillator and figures that were computed independently.

use corehbot_twin::dynamics::plant::{Detail, Plant};
use corehbot_twin::dynamics::state::State;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::Run;
use corehbot_twin::run::watch::Watch;
use corehbot_twin::steps::{Column, StepTrace, TICKS_PER_SECOND};

const CENTRE: Place = Place::flat(235.0, 235.0);
const REDUCED: Detail = Detail { idlers: false, rotors: false };
const FULL: Detail = Detail { idlers: true, rotors: false };
const ROTORS: Detail = Detail { idlers: false, rotors: true };

/// Nothing but the belt's own damping takes energy.
fn frictionless(belt_damping_s: f64) -> Params {
    Params { belt_damping_s, ..Params::default().undamped() }
}

/// A trace of a CoreH-bot in the making: straight moves along x or y.
struct Maker {
    trace: StepTrace,
    seconds: f64,
}

impl Maker {
    fn new(step_mm: f64) -> Self {
        let rows = [[-1, 1], [-1, -1], [1, -1], [1, 1]];
        let columns = rows.map(|[x, y]| Column { name: String::new(), row: [x, y, 0], axis_step: 1.0 }).to_vec();
        Self { trace: StepTrace::new(columns, step_mm), seconds: 0.0 }
    }

    /// `way` mm along an axis (0 or 1), with the time at which each place is passed.
    fn go(mut self, axis: usize, way: f64, time: impl Fn(f64) -> f64) -> Self {
        let steps = (way.abs() / self.trace.step_mm).round() as u32;
        let forward_of_plus = if axis == 0 { 0b1100 } else { 0b1001 };
        let forward = if way > 0.0 { forward_of_plus } else { !forward_of_plus & 0b1111 };
        for step in 0..steps {
            let passed = (f64::from(step) + 0.5) * self.trace.step_mm;
            let tick = ((self.seconds + time(passed)) * TICKS_PER_SECOND).round() as u64;
            self.trace.add(tick, 0b1111, forward);
        }
        self.seconds += time(way.abs());
        self
    }

    fn at_speed(self, axis: usize, way: f64, speed: f64) -> Self {
        self.go(axis, way, |passed| passed / speed)
    }
}

/// The first part of a move that speeds up with `a` to `v`, and then keeps it.
fn ramp(a: f64, v: f64) -> impl Fn(f64) -> f64 {
    move |passed| {
        let ramp = v * v / (2.0 * a);
        if passed < ramp { (2.0 * passed / a).sqrt() } else { v / a + (passed - ramp) / v }
    }
}

/// Plays a trace. After every event `each` gets the time in s and the tool's way since the start.
fn follow(detail: Detail, params: &Params, trace: &StepTrace, mut each: impl FnMut(f64, [f64; 2])) {
    let mut plant = Plant::new(Machine::CoreHBot, params, CENTRE, detail);
    let mut state = State::at_rest(&plant);
    let mut now = 0;
    for (tick, counts) in trace.counted() {
        state.advance(&plant, (tick - now) as f64 / TICKS_PER_SECOND);
        now = tick;
        each(now as f64 / TICKS_PER_SECOND, [state.at[0], state.at[1]]);
        for (motor, count) in counts.iter().take(4).enumerate() {
            state.step(&plant, motor, *count as f64 * trace.step_mm);
        }
        plant.send(&state.sent_mm);
    }
}

fn agree(found: f64, expected: f64, part: f64) -> bool {
    (found - expected).abs() <= part * expected.abs()
}

/// An oscillator with an anchor that starts to move rings by v over omega.
#[test]
fn a_step_of_speed_rings_with_speed_over_frequency() {
    for (detail, axis, expected) in [(REDUCED, 0, 0.14445), (REDUCED, 1, 0.25429), (FULL, 0, 0.1469), (FULL, 1, 0.2622)]
    {
        let trace = Maker::new(0.002).at_speed(axis, 4.0, 100.0).trace;
        let mut greatest = 0.0_f64;
        follow(detail, &frictionless(0.0), &trace, |t, tool| greatest = greatest.max((tool[axis] - 100.0 * t).abs()));
        assert!(agree(greatest, expected, 0.01), "{detail:?}, axis {axis}: {greatest}");
    }
}

/// A ramp of the time t_a is two steps of acceleration. It leaves 2 a / omega^2 |sin(omega t_a / 2)|.
#[test]
fn a_ramp_leaves_the_ripple_of_two_steps_of_acceleration() {
    for (axis, a, v, expected) in
        [(0, 3e3, 100.0, 0.01072), (1, 3e3, 100.0, 0.01038), (0, 4e3, 120.0, 0.01367), (1, 4e3, 120.0, 0.01940)]
    {
        let trace = Maker::new(0.000_5).go(axis, 9.0, ramp(a, v)).trace;
        let mut greatest = 0.0_f64;
        follow(REDUCED, &frictionless(0.0), &trace, |t, tool| {
            if t > v / a {
                let sent = v * v / (2.0 * a) + v * (t - v / a);
                greatest = greatest.max((tool[axis] - sent).abs());
            }
        });
        assert!(agree(greatest, expected, 0.02), "axis {axis}, {a} mm/s2: {greatest}");
    }
}

fn rectangle(step_mm: f64, speed: f64) -> StepTrace {
    let sides = [(0, 30.0), (1, 30.0), (0, -30.0), (1, -30.0)];
    sides.into_iter().fold(Maker::new(step_mm), |maker, (axis, way)| maker.at_speed(axis, way, speed)).trace
}

fn play(detail: Detail, params: &Params, trace: &StepTrace, refined: f64) -> Watch {
    let run = Run::new(Machine::CoreHBot, params, CENTRE, detail, trace).unwrap();
    run.refined(refined).play(|_| true).unwrap()
}

#[test]
fn a_rectangle_at_constant_speed_is_left_by_as_much_as_computed_elsewhere() {
    let table = [(20.0, 0.0479), (39.0, 0.0934), (79.0, 0.1891), (100.0, 0.2391), (200.0, 0.5132), (300.0, 0.7347)];
    for (speed, expected) in table {
        for step_mm in [0.002_5, 0.012_5] {
            let found = play(REDUCED, &frictionless(2e-4), &rectangle(step_mm, speed), 1.0).contour;
            assert!(agree(found.greatest_mm, expected, 0.02), "{speed} mm/s: {}", found.greatest_mm);
        }
    }
}

#[test]
fn without_damping_no_energy_is_lost_or_won() {
    for (detail, part) in [(REDUCED, 1e-6), (ROTORS, 1e-6), (FULL, 1e-6)] {
        let mut plant = Plant::new(Machine::CoreHBot, &frictionless(0.0), Place::flat(150.0, 300.0), detail);
        let mut state = State::at_rest(&plant);
        // A blow of 100 mm/s, as a stop from there would be.
        state.speeds[0] = 100.0;
        state.speeds[1] = -60.0;
        plant.send(&state.sent_mm);
        let begin = plant.energy_n_mm(&state.at, &state.speeds, &state.sent_mm);
        for _ in 0..10 {
            state.advance(&plant, 0.1);
            let now = plant.energy_n_mm(&state.at, &state.speeds, &state.sent_mm);
            assert!(agree(now, begin, part), "{detail:?}: {begin} became {now}");
        }
    }
}

#[test]
fn halved_steps_of_the_integration_change_nothing_that_is_told() {
    let params = Params::default();
    for detail in [REDUCED, FULL, ROTORS] {
        let trace = rectangle(0.0125, 100.0);
        let figures = |refined| {
            let watch = play(detail, &params, &trace, refined);
            let contour = [watch.contour.greatest_mm, watch.contour.rms_mm(), watch.yaw_torque_n_mm];
            let corners = watch.contour.corners.iter().flat_map(|c| [c.rounding_mm, c.overshoot_mm]);
            let spans = watch.tensions_n.iter().flat_map(|range| [range.least, range.greatest]);
            let motors = watch.motors.iter().map(|motor| motor.greatest_force_n);
            contour.into_iter().chain(corners).chain(spans).chain(motors).collect::<Vec<_>>()
        };
        for (coarse, fine) in figures(1.0).into_iter().zip(figures(2.0)) {
            assert!(agree(coarse, fine, 1e-3), "{detail:?}: {coarse} and {fine}");
        }
    }
}

/// A belt without preload cannot push.
#[test]
fn a_loose_belt_goes_slack_and_a_tight_one_does_not() {
    let trace = rectangle(0.0125, 200.0);
    let tight = play(REDUCED, &Params::default(), &trace, 1.0);
    assert_eq!(tight.slack, 0);
    let loose = play(REDUCED, &Params { preload_n: 2.0.into(), ..Params::default() }, &trace, 1.0);
    assert!(loose.slack > 0);
    assert!(loose.tensions_n.iter().all(|range| range.least >= 0.0));
    assert!(loose.tensions_n.iter().any(|range| range.least == 0.0));
}

#[test]
fn motors_slip_where_the_torque_does_not_suffice_and_are_counted() {
    // From rest to 150 mm/s at once: 0.02 J of the tool, where four fields of 0.40 N m hold 0.064 J.
    let trace = rectangle(0.0125, 150.0);
    let strong = play(ROTORS, &Params::default(), &trace, 1.0);
    assert!(strong.motors.iter().all(|motor| motor.slips == 0));
    assert!(strong.residual_mm > 0.0 && strong.commanded_residual_mm == 0.0);
    let weak = Params { holding_torque_nm: 0.06, ..Params::default() };
    let weak = play(ROTORS, &weak, &trace, 1.0);
    assert!(weak.motors.iter().any(|motor| motor.slips > 0 && motor.turns_off != 0.0), "{:?}", weak.motors);
}

/// A detent draws a rotor to its full steps: between two of them it rests where field and detent balance.
#[test]
fn a_detent_pulls_rotors_towards_full_steps_and_keeps_energy() {
    let params = Params { detent_torque_nm: Some(0.02), belt_damping_s: 2e-3, ..Params::default() };
    let mut plant = Plant::new(Machine::CoreHBot, &params, CENTRE, ROTORS);
    let mut state = State::at_rest(&plant);
    // A quarter of a full step: where the detent pulls back most.
    let sent = params.full_step_mm(0) / 4.0;
    for (motor, sign) in [-1.0, -1.0, 1.0, 1.0].into_iter().enumerate() {
        state.step(&plant, motor, sign * sent);
    }
    plant.send(&state.sent_mm);
    state.advance(&plant, 1.0);
    let (mut low, mut high) = (0.0, sent);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if plant.field_n(0, middle, sent) > 0.0 { low = middle } else { high = middle }
    }
    let found = state.at[plant.first_motor() + 3];
    assert!(agree(found, low, 1e-3) && low < 0.97 * sent, "{found} {low} {sent}");
    let params = Params { detent_torque_nm: Some(0.02), ..frictionless(0.0) };
    let plant = Plant::new(Machine::CoreHBot, &params, CENTRE, ROTORS);
    let mut state = State::at_rest(&plant);
    state.speeds[1] = 50.0;
    let begin = plant.energy_n_mm(&state.at, &state.speeds, &state.sent_mm);
    state.advance(&plant, 0.2);
    assert!(agree(plant.energy_n_mm(&state.at, &state.speeds, &state.sent_mm), begin, 1e-6));
}

/// Newton: what accelerates the tool is what the motors give, and what yaws the bar is the head beside the middle.
#[test]
fn a_steady_acceleration_takes_the_torque_and_the_yaw_of_statics() {
    let params = Params { belt_damping_s: 2e-3, ..frictionless(0.0) };
    // Looked at just before each step, a quarter of a micrometre long, or half of it would count.
    // 3 m/s2 in y from x = 40: 1.8 kg, and for the yaw 0.6 kg by 195 mm.
    let start = Place::flat(40.0, 150.0);
    let trace = Maker::new(0.000_25).go(1, 30.0, |passed| (2.0 * passed / 3e3).sqrt()).trace;
    let mut plant = Plant::new(Machine::CoreHBot, &params, start, REDUCED);
    let mut state = State::at_rest(&plant);
    let (mut now, mut forces, mut yaw, mut looks) = (0, [0.0; 4], 0.0, 0.0);
    for (tick, counts) in trace.counted() {
        state.advance(&plant, (tick - now) as f64 / TICKS_PER_SECOND);
        now = tick;
        if now > 800_000 {
            yaw += plant.yaw_torque_n_mm(&state.at, &state.speeds);
            for (sum, force) in forces.iter_mut().zip(plant.motor_forces(&state.at, &state.sent_mm)) {
                *sum += force;
            }
            looks += 1.0;
        }
        for (motor, count) in counts.iter().take(4).enumerate() {
            state.step(&plant, motor, *count as f64 * trace.step_mm);
        }
        plant.send(&state.sent_mm);
    }
    assert!(agree(yaw / looks, -0.6 * 3.0 * 195.0, 0.02), "{}", yaw / looks);
    // Beside the middle the motors share it unevenly, but virtual work is that of the thrust: F1 - F4 - F8 + F11.
    let thrust = (forces[0] - forces[1] - forces[2] + forces[3]) / looks;
    assert!(agree(thrust, 5.40, 0.02), "{thrust}");
}
