//! Changes of speed: how much the speeds of all axes and belt motors vary within 4 ms.
//!
//! Sampled positions are only exact to one step of length q. Over 4 ms that error would hide a curve driven several
//! times too fast. The instants of steps are known to a tick, and between two of them a motor goes one step. So its
//! mean speed is known there, and the motor has had that speed at some moment. Where a motor reverses or starts, up to
//! `sqrt(A q)` of its speed cannot be seen.
//!
//! Within a window T a coordinate may change its speed by `f A T + J + sqrt(A q)`. A is its own acceleration. J is what
//! may change at once, from a table that is computed from the print's words (see [`limits`](crate::limits)). The factor
//! f leaves room for braking in a curve (x, y and belts: 1.3) or for the rounding of times (z and e). A touch adds its
//! speed in the windows in which something ends all motion, and in no other.
//!
//! Where motors of z turn alone (G34), each of them is held to the limits of z.

use super::{EPISODE, Findings, Stops};
use crate::limits::{Limit, Limits, belts};
use crate::sampler::{SAMPLE_TICKS, SAMPLES_PER_SECOND};
use corehbot::kinematics::{Group, Groups};
use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;

/// Samples of the window: 4 ms.
const WINDOW_SAMPLES: usize = 8;

/// A change of speed may exceed the one by the acceleration by this factor, where the tool may curve.
const BEND: f64 = 1.3;

/// And for z and e.
const STRAIGHT: f64 = 1.05;

/// Two steps farther apart than this are a rest.
const REST: u64 = 20 * SAMPLES_PER_SECOND as u64 * SAMPLE_TICKS / 1000;

/// Instants between samples at which places are kept: those of a rest, and of the steps at its ends.
const KEPT: usize = 64;
const _: () = assert!(KEPT as u64 >= REST / SAMPLE_TICKS + 3);

/// A coordinate of motors. Between two steps it has a mean speed, and so a place at each instant.
struct Line {
    lead: Motor,
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
    fn new(lead: Motor) -> Self {
        let (tick, direction, place, end, ahead) = (0, 0, 0, None, 0);
        Self { lead, tick, direction, place, end, ahead, passed: [0.0; KEPT], judged: 0.0 }
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

/// A coordinate with its last speeds: an axis, or a motor that makes a sum of them.
struct Judged {
    name: String,
    /// The lines that it consists of, each with mm for half a step.
    parts: Vec<(usize, f64)>,
    /// The most that its speeds may differ, and that a touch adds.
    most: f64,
    stop: f64,
    /// The last speeds in a ring; the first one fills it.
    speeds: Option<[f64; WINDOW_SAMPLES]>,
    oldest: usize,
    /// In so many of the last samples no speed has changed by much.
    calm: usize,
    /// Samples for which a further excess belongs to the last one.
    quiet: u32,
}

impl Judged {
    fn new(limit: &Limit, bend: f64, parts: Vec<(usize, f64)>, unseen: f64) -> Self {
        let window = WINDOW_SAMPLES as f64 / f64::from(SAMPLES_PER_SECOND);
        let most = bend * limit.acceleration * window + limit.jump + unseen;
        let (name, stop) = (limit.name.clone(), limit.hard_stop.max(limit.hard_stop_up));
        Self { name, parts, most, stop, speeds: None, oldest: 0, calm: 0, quiet: 0 }
    }

    /// Takes in the next speed.
    #[inline(always)]
    fn put(&mut self, speed: f64) {
        let speeds = self.speeds.get_or_insert([speed; WINDOW_SAMPLES]);
        let before = speeds[(self.oldest + WINDOW_SAMPLES - 1) % WINDOW_SAMPLES];
        // Eight changes of less than an eighth are less than all.
        let is_calm = (speed - before).abs() * WINDOW_SAMPLES as f64 <= self.most;
        speeds[self.oldest] = speed;
        self.oldest = (self.oldest + 1) % WINDOW_SAMPLES;
        self.calm = if is_calm { self.calm + 1 } else { 0 };
    }

    /// The greatest change of speed within the window.
    fn change(&self) -> f64 {
        let speeds = self.speeds.iter().flatten().copied();
        speeds.clone().fold(f64::MIN, f64::max) - speeds.fold(f64::MAX, f64::min)
    }

    /// Looks at the sample that ends at `tick`.
    #[inline(always)]
    fn judge(&mut self, findings: &mut Findings, stops: Stops, tick: u64) {
        if self.calm >= WINDOW_SAMPLES {
            self.quiet = self.quiet.saturating_sub(1);
        } else {
            self.compare(findings, stops, tick);
        }
    }

    #[cold]
    #[inline(never)]
    fn compare(&mut self, findings: &mut Findings, stops: Stops, tick: u64) {
        let has_stopped = stops.is_within(tick, (WINDOW_SAMPLES as u64 + 1) * SAMPLE_TICKS);
        let (change, most) = (self.change(), if has_stopped { self.most + self.stop } else { self.most });
        let (is_over, is_new) = (change > most, self.quiet == 0);
        self.quiet = if is_over { EPISODE } else { self.quiet.saturating_sub(1) };
        if is_over && is_new {
            let name = &self.name;
            findings.add(tick, || {
                format!("{name} changes its speed by {change:.1} mm/s within 4 ms, {most:.1} is the most")
            });
        }
    }
}

/// Measures the changes of speed.
pub(super) struct Changes {
    lines: Vec<Line>,
    /// Their ways in the present sample.
    ways: Vec<f64>,
    /// Empty if there is nothing to judge.
    judged: Vec<Judged>,
    /// Begin of the next sample.
    next: u64,
}

/// The motors that are followed: one of each group, and those that turn alone.
fn followed(s: &Settings, limits: &Limits) -> (Vec<Group>, Vec<Motor>) {
    let groups: Vec<Group> =
        Groups::new(&s.mechanism).iter().filter(|group| !group.motors().is_empty()).copied().collect();
    let makes_z = |motor: &Motor| {
        let mut of_z = groups.iter().filter(|group| group.row[2] != 0);
        of_z.next().is_some_and(|group| group.lead == *motor) && of_z.next().is_none()
    };
    let screws = s.screw_motors().into_iter().filter(|motor| limits.levels && !makes_z(motor)).collect();
    (groups, screws)
}

/// The coordinates that are judged: each axis with its limit, each motor that makes a sum of axes, with that of its
/// belt, and each motor that turns alone.
fn judged(s: &Settings, limits: &Limits, lines: &[Group], screws: &[Motor]) -> Vec<Judged> {
    let back = s.mechanism.forward_kinematics();
    let scale = s.axes.map(|axis| axis.steps_per_mm.to_num::<f64>()).to_array();
    let weights = lines.iter().map(|group| {
        let counts = Motor::ALL.map(|motor| i64::from(group.with.has(motor)) - i64::from(group.against.has(motor)));
        let axes = back.as_ref().map_or([(0, 1); 4], |back| back.fractions(&counts));
        std::array::from_fn(|i| 0.5 * axes[i].0 as f64 / axes[i].1 as f64 / scale[i])
    });
    let weights: Vec<[f64; 4]> = weights.collect();
    // mm of a motor for half a step of it.
    let half = |line: usize| 0.5 / s.steps_per_mm(lines[line].lead).to_num::<f64>();
    let (of_axes, of_belts) = limits.of.split_at(4);
    let axes = of_axes.iter().enumerate().map(|(axis, limit)| {
        let parts: Vec<_> = (0..lines.len()).map(|line| (line, weights[line][axis])).collect();
        let parts: Vec<_> = parts.into_iter().filter(|(_, weight)| *weight != 0.0).collect();
        let own = (limit.acceleration * limit.step).sqrt();
        // Of a z that several belts make, each hides a part.
        let hidden = |(line, weight): &(usize, f64)| {
            let belt = of_belts.first().map_or(limit.acceleration, |belt| belt.acceleration);
            weight.abs() * (belt * 2.0 * half(*line)).sqrt() / half(*line)
        };
        let unseen = if axis == 2 && parts.len() > 1 { parts.iter().map(hidden).sum::<f64>().max(own) } else { own };
        Judged::new(limit, if axis < 2 { BEND } else { STRAIGHT }, parts, unseen)
    });
    let sums = belts(s).into_iter().zip(of_belts).filter_map(|(belt, limit)| {
        let line = lines.iter().position(|group| group.lead == belt.lead)?;
        let is_sum = weights[line].iter().filter(|weight| **weight != 0.0).count() > 1;
        let unseen = (limit.acceleration * limit.step).sqrt();
        is_sum.then(|| Judged::new(limit, BEND, vec![(line, half(line))], unseen))
    });
    let alone = screws.iter().zip(lines.len()..).map(|(motor, line)| {
        let (name, mm) = (s.name_of(*motor).as_str().to_owned(), 1.0 / s.steps_per_mm(*motor).to_num::<f64>());
        let limit = Limit { name, ..of_axes[2].clone() };
        let unseen = (limit.acceleration * mm).sqrt();
        Judged::new(&limit, STRAIGHT, vec![(line, 0.5 * mm)], unseen)
    });
    axes.chain(sums).chain(alone).collect()
}

impl Changes {
    pub fn new(s: &Settings, limits: &Limits) -> Self {
        let (groups, screws) = followed(s, limits);
        let lines: Vec<_> =
            groups.iter().map(|group| group.lead).chain(screws.iter().copied()).map(Line::new).collect();
        let judged = if limits.is_judged { judged(s, limits, &groups, &screws) } else { Vec::new() };
        Self { ways: vec![0.0; lines.len()], lines, judged, next: 0 }
    }

    #[inline]
    pub fn event(&mut self, findings: &mut Findings, stops: Stops, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.advance(findings, stops, tick);
        for line in &mut self.lines {
            if steps.has(line.lead) {
                line.event(tick, forward.has(line.lead), self.next);
            }
        }
    }

    /// Checks all samples that are fully known at `tick`.
    #[inline]
    pub fn advance(&mut self, findings: &mut Findings, stops: Stops, tick: u64) {
        while self.next + SAMPLE_TICKS + REST < tick {
            if self.lines.iter().all(|line| line.rests(self.next)) {
                // It rests: nothing begins before the last of these samples.
                let skipped = ((tick - REST - self.next) / SAMPLE_TICKS).saturating_sub(1);
                self.next += skipped * SAMPLE_TICKS;
                for judged in &mut self.judged {
                    judged.quiet = judged.quiet.saturating_sub(u32::try_from(skipped).unwrap_or(u32::MAX));
                }
            }
            self.sample(findings, stops);
        }
    }

    fn sample(&mut self, findings: &mut Findings, stops: Stops) {
        self.next += SAMPLE_TICKS;
        for (way, line) in self.ways.iter_mut().zip(&mut self.lines) {
            *way = line.take_way(self.next) * f64::from(SAMPLES_PER_SECOND);
        }
        for judged in &mut self.judged {
            let speed = judged.parts.iter().map(|(line, weight)| weight * self.ways[*line]).sum();
            judged.put(speed);
            judged.judge(findings, stops, self.next);
        }
    }
}
