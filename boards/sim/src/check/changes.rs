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

/// Samples of the window: 4 ms.
const WINDOW_SAMPLES: usize = 8;

/// A change of speed may exceed the one by the acceleration by this factor.
const BEND: f64 = 1.3;

/// Two steps farther apart than this are a rest.
const REST: u64 = 20 * SAMPLES_PER_SECOND as u64 * SAMPLE_TICKS / 1000;

/// Instants between samples at which places are kept: those of a rest, and of the steps at its ends.
const KEPT: usize = 64;
const _: () = assert!(KEPT as u64 >= REST / SAMPLE_TICKS + 3);

/// A coordinate of motors. Between two steps it has a mean speed, and so a place at each instant.
struct Line {
    lead: Motor,
    /// mm of x and of y for half a step of it, all other coordinates standing.
    weights: [f64; 2],
    /// Its last step: when, and 1 or -1 for its direction; 0 before the first one.
    tick: u64,
    direction: i64,
    /// Its place at the last step in half steps, without the ways of rests: there it passed the middle of a step.
    place: i64,
    /// End of the last way between two steps.
    end: Option<u64>,
    /// The next end of a sample that it will pass.
    ahead: u64,
    /// Its place at the ends of samples: a ring by the sample's number.
    passed: [f64; KEPT],
    /// Its place at the end of the last sample that was judged.
    judged: f64,
}

impl Line {
    fn new(lead: Motor, weights: [f64; 2]) -> Self {
        let (tick, direction, place, end, ahead) = (0, 0, 0, None, 0);
        Self { lead, weights, tick, direction, place, end, ahead, passed: [0.0; KEPT], judged: 0.0 }
    }

    /// Its lead steps; `next` is the begin of the next sample, and earlier ones are not asked for any more.
    #[inline]
    fn event(&mut self, tick: u64, is_forward: bool, next: u64) {
        let direction = if is_forward { 1 } else { -1 };
        let has_way = self.direction != 0 && (1..=REST).contains(&(tick - self.tick));
        // From the middle of a step to the middle of the next one, or back to the same.
        let way = if has_way { self.direction + direction } else { 0 };
        if tick >= self.ahead {
            self.pass(tick, way, next);
        }
        if has_way {
            self.end = Some(tick);
        }
        self.place += way;
        (self.tick, self.direction) = (tick, direction);
    }

    /// It goes on by `way` half steps until `tick`.
    fn pass(&mut self, tick: u64, way: i64, next: u64) {
        let (from, place) = (self.tick, self.place as f64);
        let speed = if way == 0 { 0.0 } else { way as f64 / short(tick - from) };
        let mut end = self.ahead.max(next + SAMPLE_TICKS);
        while end <= tick {
            self.passed[(end / SAMPLE_TICKS) as usize % KEPT] = place + short(end - from) * speed;
            end += SAMPLE_TICKS;
        }
        self.ahead = end;
    }

    /// Whether it rested in all samples of the window before this one.
    #[inline]
    fn rests(&self, next: u64) -> bool {
        self.end.is_none_or(|end| end + WINDOW_SAMPLES as u64 * SAMPLE_TICKS <= next)
    }

    /// Its way in half steps in the next sample, which ends at this time and at which it rests unless it has passed it.
    #[inline]
    fn take_way(&mut self, end: u64) -> f64 {
        let has_passed = end < self.ahead;
        let place = if has_passed { self.passed[(end / SAMPLE_TICKS) as usize % KEPT] } else { self.place as f64 };
        place - std::mem::replace(&mut self.judged, place)
    }
}

/// A time below [`REST`] as a number, by the conversion that processors have.
fn short(ticks: u64) -> f64 {
    f64::from(ticks as u32)
}

/// An axis, and its excesses.
struct Axis {
    name: String,
    /// The most that its speeds may differ.
    most: f64,
    /// Samples for which a further excess belongs to the last one.
    quiet: u32,
}

impl Axis {
    fn new(limit: &Limit) -> Self {
        let window = WINDOW_SAMPLES as f64 / f64::from(SAMPLES_PER_SECOND);
        let most = BEND * limit.acceleration * window
            + limit.jump
            + limit.hard_stop.max(limit.hard_stop_up)
            + (limit.acceleration * limit.step).sqrt();
        Self { name: limit.name.clone(), most, quiet: 0 }
    }

    /// Whether this change of speed is a new excess.
    #[inline]
    fn exceeds(&mut self, change: f64) -> bool {
        let (is_over, is_new) = (change > self.most, self.quiet == 0);
        self.quiet = if is_over { EPISODE } else { self.quiet.saturating_sub(1) };
        is_over && is_new
    }
}

/// The last speeds of x and y.
struct Speeds {
    /// In a ring; the first speed fills it.
    last: Option<[[f64; 2]; WINDOW_SAMPLES]>,
    oldest: usize,
}

impl Speeds {
    /// Takes in the next speeds, and returns the greatest change of each within the window.
    #[inline]
    fn change(&mut self, speeds: [f64; 2]) -> [f64; 2] {
        let last = self.last.get_or_insert([speeds; WINDOW_SAMPLES]);
        last[self.oldest] = speeds;
        self.oldest = (self.oldest + 1) % WINDOW_SAMPLES;
        // Comparisons: `f64::max` has more instructions, for what is no number.
        let (mut greatest, mut least) = (speeds, speeds);
        for speeds in last {
            for ((speed, greatest), least) in speeds.iter().zip(&mut greatest).zip(&mut least) {
                *greatest = if speed > greatest { *speed } else { *greatest };
                *least = if speed < least { *speed } else { *least };
            }
        }
        [greatest[0] - least[0], greatest[1] - least[1]]
    }
}

/// Measures the changes of speed of x and y.
pub(super) struct Changes {
    /// The coordinates that move x or y.
    lines: Vec<Line>,
    speeds: Speeds,
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
                .map(|((sum, over), axis)| 0.5 * sum as f64 / over as f64 / axis.steps_per_mm.to_num::<f64>());
            Line::new(group.lead, weights)
        };
        let groups = Groups::new(&s.mechanism);
        let lines = groups.iter().filter(|group| !group.motors().is_empty()).map(line);
        let lines = lines.filter(|line| line.weights != [0.0; 2]).collect();
        let judged = if limits.is_judged { 2 } else { 0 };
        Self {
            lines,
            speeds: Speeds { last: None, oldest: 0 },
            axes: limits.of.iter().take(judged).map(Axis::new).collect(),
            next: 0,
        }
    }

    #[inline]
    pub fn event(&mut self, findings: &mut Findings, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.advance(findings, tick);
        for line in &mut self.lines {
            if steps.has(line.lead) {
                line.event(tick, forward.has(line.lead), self.next);
            }
        }
    }

    /// Checks all samples that are fully known at `tick`.
    #[inline]
    pub fn advance(&mut self, findings: &mut Findings, tick: u64) {
        while self.next + SAMPLE_TICKS + REST < tick {
            if self.lines.iter().all(|line| line.rests(self.next)) {
                // It rests: nothing begins before the last of these samples.
                let skipped = ((tick - REST - self.next) / SAMPLE_TICKS).saturating_sub(1);
                self.next += skipped * SAMPLE_TICKS;
                for axis in &mut self.axes {
                    axis.quiet = axis.quiet.saturating_sub(u32::try_from(skipped).unwrap_or(u32::MAX));
                }
            }
            self.sample(findings);
        }
    }

    fn sample(&mut self, findings: &mut Findings) {
        self.next += SAMPLE_TICKS;
        let mut ways = [0.0; 2];
        for line in &mut self.lines {
            let way = line.take_way(self.next);
            ways.iter_mut().zip(line.weights).for_each(|(sum, weight)| *sum += weight * way);
        }
        let changes = self.speeds.change(ways.map(|way| way * f64::from(SAMPLES_PER_SECOND)));
        for (axis, change) in self.axes.iter_mut().zip(changes) {
            if axis.exceeds(change) {
                let Axis { name, most, .. } = &*axis;
                findings.add(self.next, || {
                    format!("{name} changes its speed by {change:.1} mm/s within 4 ms, {most:.1} is the most")
                });
            }
        }
    }
}
