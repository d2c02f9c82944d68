//! Changes of speed: how much the speeds of x and y vary within 4 ms.
//!
//! Sampled positions are only exact to one step of length q. Over 4 ms that error would hide a curve driven several
//! times too fast. The instants of steps are known to a tick, and between two of them a motor goes one step. So its
//! mean speed is known there, and the motor has had that speed at some moment. Where a motor reverses or starts, up to
//! `sqrt(A q)` of its speed cannot be seen.
//!
//! Within a window T an axis may change its speed by `1.3 A T + J + sqrt(A q)`: J is the jump of one corner (see
//! [`limits`](crate::limits)), and the factor leaves room for braking in a curve.

use super::{EPISODE, Findings};
use crate::limits::{Limit, Limits};
use crate::sampler::{SAMPLE_TICKS, SAMPLES_PER_SECOND};
use corehbot::kinematics::{Group, Groups};
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::TICKS_PER_SECOND;
use std::collections::VecDeque;

/// Samples of the window: 4 ms.
const WINDOW_SAMPLES: usize = 8;

/// A change of speed may exceed the one by the acceleration by this factor.
const BEND: f64 = 1.3;

/// Two steps farther apart than this are a rest.
const REST: u64 = 20 * SAMPLES_PER_SECOND as u64 * SAMPLE_TICKS / 1000;

/// Mean speed between two steps, in steps a tick.
struct Piece {
    from: u64,
    to: u64,
    speed: f64,
}

/// A coordinate of motors.
struct Line {
    lead: Motor,
    /// mm of x and of y for a step of it, all other coordinates standing.
    weights: [f64; 2],
    count: i64,
    /// When it last passed the middle between two steps, and which.
    last: Option<(u64, f64)>,
    pieces: VecDeque<Piece>,
}

impl Line {
    fn event(&mut self, tick: u64, is_forward: bool) {
        let way = if is_forward { 1 } else { -1 };
        let middle = self.count as f64 + 0.5 * f64::from(way);
        self.count += i64::from(way);
        if let Some((from, before)) = self.last.replace((tick, middle))
            && (1..=REST).contains(&tick.saturating_sub(from))
        {
            self.pieces.push_back(Piece { from, to: tick, speed: (middle - before) / (tick - from) as f64 });
        }
    }

    /// Its way between two ticks, in steps; later calls never ask for an earlier tick.
    fn way(&mut self, from: u64, to: u64) -> f64 {
        while self.pieces.front().is_some_and(|piece| piece.to <= from) {
            self.pieces.pop_front();
        }
        let within = self.pieces.iter().take_while(|piece| piece.from < to);
        within.map(|piece| (piece.to.min(to) - piece.from.max(from)) as f64 * piece.speed).sum()
    }
}

/// An axis, and its speeds in the window.
struct Axis {
    limit: Limit,
    speeds: VecDeque<f64>,
    quiet: u32,
}

impl Axis {
    /// Takes in the next speed. If the difference of speeds is a new excess, returns the excess and the limit.
    fn measure(&mut self, speed: f64) -> Option<(f64, f64)> {
        self.speeds.push_back(speed);
        if self.speeds.len() > WINDOW_SAMPLES {
            self.speeds.pop_front();
        }
        let limit = &self.limit;
        let window = WINDOW_SAMPLES as f64 / f64::from(SAMPLES_PER_SECOND);
        let most = BEND * limit.acceleration * window
            + limit.jump
            + limit.hard_stop.max(limit.hard_stop_up)
            + (limit.acceleration * limit.step).sqrt();
        let greatest = self.speeds.iter().copied().fold(f64::MIN, f64::max);
        let least = self.speeds.iter().copied().fold(f64::MAX, f64::min);
        let (is_over, is_new) = (greatest - least > most, self.quiet == 0);
        self.quiet = if is_over { EPISODE } else { self.quiet.saturating_sub(1) };
        (is_over && is_new).then_some((greatest - least, most))
    }
}

/// Measures the changes of speed of x and y.
pub(super) struct Changes {
    lines: Vec<Line>,
    /// Empty if there is nothing to judge.
    axes: Vec<Axis>,
    /// Begin of the next sample.
    next: u64,
}

impl Changes {
    pub fn new(s: &Settings, limits: &Limits) -> Self {
        let back = s.mechanism.forward_kinematics();
        let line = |group: &Group| {
            let counts = Motor::ALL.map(|motor| i64::from(group.with.has(motor)) - i64::from(group.against.has(motor)));
            let [x, y, ..] = back.as_ref().map_or([(0, 1); 4], |back| back.fractions(&counts));
            let weights = [(x, s.axes.x), (y, s.axes.y)]
                .map(|((sum, over), axis)| sum as f64 / over as f64 / axis.steps_per_mm.to_num::<f64>());
            Line { lead: group.lead, weights, count: 0, last: None, pieces: VecDeque::new() }
        };
        let lines = Groups::new(&s.mechanism).iter().filter(|group| !group.motors().is_empty()).map(line).collect();
        let judged = if limits.is_judged { 2 } else { 0 };
        let axis = |limit: &Limit| Axis { limit: limit.clone(), speeds: VecDeque::new(), quiet: 0 };
        Self { lines, axes: limits.of.iter().take(judged).map(axis).collect(), next: 0 }
    }

    pub fn event(&mut self, findings: &mut Findings, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.advance(findings, tick);
        for line in &mut self.lines {
            if steps.has(line.lead) {
                line.event(tick, forward.has(line.lead));
            }
        }
    }

    /// Checks all samples that are fully known at `tick`.
    pub fn advance(&mut self, findings: &mut Findings, tick: u64) {
        while self.next + SAMPLE_TICKS + REST < tick {
            if self.lines.iter().all(|line| line.pieces.is_empty()) {
                // It rests: nothing begins before the last of these samples.
                let rest = (tick - REST - self.next) / SAMPLE_TICKS;
                if rest > WINDOW_SAMPLES as u64 {
                    self.next += (rest - WINDOW_SAMPLES as u64) * SAMPLE_TICKS;
                }
            }
            self.sample(findings);
        }
    }

    fn sample(&mut self, findings: &mut Findings) {
        let (from, to) = (self.next, self.next + SAMPLE_TICKS);
        self.next = to;
        let mut ways = [0.0; 2];
        for line in &mut self.lines {
            let way = line.way(from, to);
            ways.iter_mut().zip(line.weights).for_each(|(sum, weight)| *sum += weight * way);
        }
        for (axis, way) in self.axes.iter_mut().zip(ways) {
            if let Some((change, most)) = axis.measure(way * f64::from(TICKS_PER_SECOND) / SAMPLE_TICKS as f64) {
                let name = &axis.limit.name;
                findings.add(to, || {
                    format!("{name} changes its speed by {change:.1} mm/s within 4 ms, {most:.1} is the most")
                });
            }
        }
    }
}
