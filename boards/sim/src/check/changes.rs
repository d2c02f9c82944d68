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

/// Samples of the window: 4 ms.
const WINDOW_SAMPLES: usize = 8;

/// A change of speed may exceed the one by the acceleration by this factor.
const BEND: f64 = 1.3;

/// Two steps farther apart than this are a rest.
const REST: u64 = 20 * SAMPLES_PER_SECOND as u64 * SAMPLE_TICKS / 1000;

/// Samples of which ways are gathered at a time: those of a rest, and of the steps at its ends.
const GATHERED: usize = 64;
const _: () = assert!(GATHERED as u64 >= REST / SAMPLE_TICKS + 3);

/// A coordinate of motors. Between two steps it has a mean speed, and so a way in each sample.
struct Line {
    lead: Motor,
    /// mm of x and of y for a step of it, all other coordinates standing.
    weights: [f64; 2],
    count: i64,
    /// When it last passed the middle between two steps, and which.
    last: Option<(u64, f64)>,
    /// End of the last way between two steps.
    end: Option<u64>,
    /// Its way in each sample, in steps, from the next sample on: a ring by the sample's number.
    ways: [f64; GATHERED],
}

impl Line {
    /// Its lead steps; `next` is the begin of the next sample, and earlier ones are not asked for any more.
    fn event(&mut self, tick: u64, is_forward: bool, next: u64) {
        let way = if is_forward { 1 } else { -1 };
        let middle = self.count as f64 + 0.5 * f64::from(way);
        self.count += i64::from(way);
        if let Some((from, before)) = self.last.replace((tick, middle))
            && (1..=REST).contains(&tick.saturating_sub(from))
        {
            let speed = (middle - before) / short(tick - from);
            self.end = self.end.max(Some(tick));
            let mut begin = from.max(next);
            while begin < tick {
                let number = begin / SAMPLE_TICKS;
                let end = tick.min((number + 1) * SAMPLE_TICKS);
                self.ways[number as usize % GATHERED] += short(end - begin) * speed;
                begin = end;
            }
        }
    }

    /// Whether all its ways had ended when the sample before this one began, or it has none.
    fn rests(&self, next: u64) -> bool {
        self.end.is_none_or(|end| end + SAMPLE_TICKS <= next)
    }

    /// Its way in the sample that begins at this time.
    const fn take_way(&mut self, begin: u64) -> f64 {
        std::mem::replace(&mut self.ways[(begin / SAMPLE_TICKS) as usize % GATHERED], 0.0)
    }
}

/// A time below [`REST`] as a number, by the conversion that processors have.
fn short(ticks: u64) -> f64 {
    f64::from(ticks as u32)
}

/// An axis, and its speeds in the window.
struct Axis {
    name: String,
    /// The most that its speeds may differ.
    most: f64,
    /// The last speeds, in a ring with `next` as the oldest. The first speed fills it.
    speeds: Option<[f64; WINDOW_SAMPLES]>,
    next: usize,
    quiet: u32,
}

impl Axis {
    fn new(limit: &Limit) -> Self {
        let window = WINDOW_SAMPLES as f64 / f64::from(SAMPLES_PER_SECOND);
        let most = BEND * limit.acceleration * window
            + limit.jump
            + limit.hard_stop.max(limit.hard_stop_up)
            + (limit.acceleration * limit.step).sqrt();
        Self { name: limit.name.clone(), most, speeds: None, next: 0, quiet: 0 }
    }

    /// Takes in the next speed, and returns the difference of speeds if it is a new excess.
    fn measure(&mut self, speed: f64) -> Option<f64> {
        let speeds = self.speeds.get_or_insert([speed; WINDOW_SAMPLES]);
        speeds[self.next] = speed;
        self.next = (self.next + 1) % WINDOW_SAMPLES;
        // Comparisons: `f64::max` has more instructions, for what is no number.
        let greatest = speeds.iter().copied().fold(f64::MIN, |most, speed| if speed > most { speed } else { most });
        let least = speeds.iter().copied().fold(f64::MAX, |least, speed| if speed < least { speed } else { least });
        let (is_over, is_new) = (greatest - least > self.most, self.quiet == 0);
        self.quiet = if is_over { EPISODE } else { self.quiet.saturating_sub(1) };
        (is_over && is_new).then_some(greatest - least)
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
            Line { lead: group.lead, weights, count: 0, last: None, end: None, ways: [0.0; GATHERED] }
        };
        let lines = Groups::new(&s.mechanism).iter().filter(|group| !group.motors().is_empty()).map(line).collect();
        let judged = if limits.is_judged { 2 } else { 0 };
        Self { lines, axes: limits.of.iter().take(judged).map(Axis::new).collect(), next: 0 }
    }

    pub fn event(&mut self, findings: &mut Findings, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.advance(findings, tick);
        for line in &mut self.lines {
            if steps.has(line.lead) {
                line.event(tick, forward.has(line.lead), self.next);
            }
        }
    }

    /// Checks all samples that are fully known at `tick`.
    pub fn advance(&mut self, findings: &mut Findings, tick: u64) {
        while self.next + SAMPLE_TICKS + REST < tick {
            if self.lines.iter().all(|line| line.rests(self.next)) {
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
            let way = line.take_way(from);
            ways.iter_mut().zip(line.weights).for_each(|(sum, weight)| *sum += weight * way);
        }
        for (axis, way) in self.axes.iter_mut().zip(ways) {
            if let Some(change) = axis.measure(way * f64::from(TICKS_PER_SECOND) / SAMPLE_TICKS as f64) {
                let Axis { name, most, .. } = &*axis;
                findings.add(to, || {
                    format!("{name} changes its speed by {change:.1} mm/s within 4 ms, {most:.1} is the most")
                });
            }
        }
    }
}
