//! The tool's velocity over time, read from released moves, and its variation within a window.

use super::speeds::speeds;
use corehbot::motion::Move;
use corehbot::settings::Settings;
use corehbot::units::Steps;

/// A velocity in mm/s.
pub type Velocity = [f64; 3];

/// The velocity at one time; linear from one to the next. A corner has two of one time.
#[derive(Clone, Copy, Debug)]
pub struct Knot {
    pub time: f64,
    pub velocity: Velocity,
}

/// How the velocity goes over moves from `from` on.
pub fn course(mut from: [Steps; 4], moves: &[Move], s: &Settings) -> Vec<Knot> {
    let pitch = s.axes.map(|a| a.steps_per_mm.to_num::<f64>()).to_array();
    let mut course = vec![Knot { time: 0.0, velocity: [0.0; 3] }];
    let mut time = 0.0;
    for m in moves {
        let way: Velocity = std::array::from_fn(|i| m.end[i].wrapping_sub(from[i]).to_num::<f64>() / pitch[i]);
        let length = size(way);
        from = m.end;
        let phases = [0, m.accelerate.0, m.cruise.0, m.decelerate.0].map(|t| t as f64 / 65536.0 / 1e7);
        let [entry, peak, exit] = if length > 0.0 { speeds(m, length) } else { [0.0; 3] };
        for (phase, speed) in phases.into_iter().zip([entry, peak, peak, exit]) {
            time += phase;
            course.push(Knot { time, velocity: way.map(|d| if length > 0.0 { d * speed / length } else { 0.0 }) });
        }
    }
    course
}

pub fn size([x, y, z]: Velocity) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// The greatest `excess` of any two velocities that are no farther apart than `window` seconds, and when the first of
/// them is. As the velocity is linear between knots, only pairs of knots and pairs `window` apart with a knot among
/// them can be it.
pub fn worst(course: &[Knot], window: f64, excess: impl Fn(Velocity, Velocity) -> f64) -> (f64, f64) {
    let mut worst = (0.0, 0.0);
    let mut try_pair = |time: f64, p: Velocity, q: Velocity| {
        let found = excess(p, q);
        if found > worst.0 {
            worst = (found, time);
        }
    };
    let (mut first, mut next) = (0, 0);
    for (i, knot) in course.iter().enumerate() {
        while course[first].time < knot.time - window {
            first += 1;
        }
        for other in &course[first..i] {
            try_pair(other.time, other.velocity, knot.velocity);
        }
        if first > 0 {
            try_pair(knot.time - window, between(course, first, knot.time - window), knot.velocity);
        }
        while next < course.len() && course[next].time <= knot.time + window {
            next += 1;
        }
        if next < course.len() {
            try_pair(knot.time, knot.velocity, between(course, next, knot.time + window));
        }
    }
    worst
}

/// The velocity at a time before the knot of that index.
fn between(course: &[Knot], index: usize, time: f64) -> Velocity {
    let (p, q) = (&course[index - 1], &course[index]);
    let part = if q.time > p.time { (time - p.time) / (q.time - p.time) } else { 0.0 };
    std::array::from_fn(|i| p.velocity[i] + (q.velocity[i] - p.velocity[i]) * part)
}
