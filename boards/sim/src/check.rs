//! Checker: holds every step of a run to physics and to the mechanism.
//!
//! At every event:
//!
//! - time does not fall;
//! - two pulses of a motor are at least [`MIN_STEP_INTERVAL`] apart;
//! - motors with equal rows in the mechanism have equal counts, and motors with opposite rows have opposite counts. On
//!   the CoreH-bot these are 1 and 8, 4 and 11, so that the belt is not strained, and both ball screws.
//!
//! Where four coordinates hold three axes, one sum of counts should be 0 (A - B + C - D of a CoreXYZ). Rounding decides
//! its value: each count is within half a step of its coordinate, so the sum of four is below two steps. A step's tick
//! is rounded as well, so in between the sum may reach two. At the end it is below two, and the counts are the expected
//! ones.
//!
//! Speeds and accelerations are measured on positions sampled every 0.5 ms. With window T and step q:
//!
//! - speed: `|p(t) - p(t-T)| <= V T + Q`, where Q = 1.5 q is the error that quantisation can cause;
//! - acceleration: the second difference `|p(t) - 2 p(t-T) + p(t-2T)|` is at most `sqrt2 A T^2 + J T + 2 Q`. It is the
//!   acceleration averaged with a triangular weight times T^2. The factor sqrt2 (x, y and belt only) allows for an axis
//!   that brakes at its limit and turns at its limit at the same time. J is one corner's jump of speed (see
//!   [`limits`](crate::limits)). Several corners within one window stay within the bound if the planner lets no chain
//!   of corners turn faster than a curve at the limit would.
//!
//! A long window (T = V / 5A) finds, on the belt axes, an acceleration of twice the limit before the axis reaches its
//! speed limit. A short window (T = sqrt(2Q / A)), where the sum of the three terms is smallest, finds a jump. For 80
//! steps/mm, 5 m/s2 and d = 0.013 mm it finds any jump above 65 mm/s. Within 4 ms the speeds of x and y are checked
//! step by step (`changes.rs`), which finds an oscillation that is too short for both windows.

use self::changes::Changes;
use crate::limits::{Limit, Limits, belts};
use crate::sampler::{Counts, LONGEST_WINDOW, SAMPLE_TICKS, SAMPLES_PER_SECOND, Sample, Sampler};
use corehbot::kinematics::{ForwardKinematics, Group, Groups, Residual, Residuals};
use corehbot::motion::MIN_STEP_INTERVAL;
use corehbot::motors::{MOST_GROUPS, MOTORS, Motor, MotorName, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::TICKS_PER_SECOND;
use std::f64::consts::SQRT_2;

/// Violations that are kept in words; the others are only counted.
const KEPT: usize = 10;

/// Steps that quantisation can fake in a position difference: one, and a half for uneven rounding.
const QUANTISATION: f64 = 1.5;

/// The factor of the acceleration limit of a coordinate by its place in [`Limits::of`]. Only x, y and the belts see
/// curves; z and e get five percent for the rounding of times to whole ticks.
const fn bend(coordinate: usize) -> f64 {
    if matches!(coordinate, 2 | 3) { 1.05 } else { SQRT_2 }
}

/// A line of violations that follow each other within this many samples is one violation.
const EPISODE: u32 = SAMPLES_PER_SECOND / 10;

/// Something that a sound firmware would not do.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Violation {
    /// When, in motion time.
    pub tick: u64,
    /// The violation in words.
    pub text: String,
}

/// Motors that may turn alone.
fn trims(s: &Settings, limits: &Limits) -> MotorSet {
    let belt = if limits.trims { Residuals::new(&s.mechanism, s.belt.is_closed).motors() } else { MotorSet::NONE };
    let screws = s.screw_motors().into_iter().filter(|_| limits.levels);
    screws.fold(belt, |motors, screw| motors.with(MotorSet::of(screw)))
}

impl std::fmt::Display for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "at {:.4} s (tick {}): {}", self.tick as f64 / f64::from(TICKS_PER_SECOND), self.tick, self.text)
    }
}

/// The checker's findings.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Findings {
    /// The first few violations.
    pub first: Vec<Violation>,
    /// How many there were.
    pub total: u64,
}

impl Findings {
    fn add(&mut self, tick: u64, text: impl FnOnce() -> String) {
        self.total += 1;
        if self.first.len() < KEPT {
            self.first.push(Violation { tick, text: text() });
        }
    }
}

/// Checks a run event by event.
pub struct Checker {
    sampler: Sampler,
    /// Names of the motors.
    names: [MotorName; MOTORS],
    groups: Groups,
    gauge: Gauge,
    changes: Changes,
    last_tick: u64,
    /// The constraint from [`Groups::constraint`].
    constraint: Option<[i32; MOST_GROUPS]>,
    /// Tick of each motor's last pulse.
    last_pulse: [Option<u64>; MOTORS],
    /// The strain of a closed belt.
    residuals: Option<Residuals>,
    /// Motors that may be trimmed, and how far each was trimmed: a motor that steps alone in an instant.
    trims: MotorSet,
    trimmed: [i64; MOTORS],
    is_consistent: bool,
    findings: Findings,
}

impl Checker {
    /// A checker for a machine at rest with these settings and limits.
    #[must_use]
    pub fn new(s: &Settings, limits: &Limits) -> Self {
        Self {
            sampler: Sampler::default(),
            names: s.motor_names,
            groups: Groups::new(&s.mechanism),
            gauge: Gauge::new(s, limits),
            changes: Changes::new(s, limits),
            constraint: Groups::new(&s.mechanism).constraint(),
            last_tick: 0,
            last_pulse: [None; MOTORS],
            residuals: limits.circulates.then(|| Residuals::new(&s.mechanism, true)),
            trims: trims(s, limits),
            trimmed: [0; MOTORS],
            is_consistent: true,
            findings: Findings::default(),
        }
    }

    /// One instant in which `steps` move, each forward or backward.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        if tick < self.last_tick {
            let before = self.last_tick;
            self.findings.add(tick, || format!("time falls from tick {before}"));
        }
        self.last_tick = tick;
        self.check_spacing(tick, steps);
        let Self { sampler, gauge, changes, findings, .. } = self;
        changes.event(findings, tick, steps, forward);
        sampler.event(tick, steps, forward, |sample| gauge.measure(findings, sample));
        self.note_trim(steps, forward);
        self.check_mechanism(tick, steps);
    }

    fn note_trim(&mut self, steps: MotorSet, forward: MotorSet) {
        for (motor, trimmed) in Motor::ALL.into_iter().zip(&mut self.trimmed) {
            if self.trims.has(motor) && steps == MotorSet::of(motor) {
                *trimmed += if forward.has(motor) { 1 } else { -1 };
            }
        }
    }

    /// The steps of each motor without its trims.
    fn untrimmed(&self) -> Counts {
        let counts = self.sampler.counts();
        std::array::from_fn(|motor| counts[motor] - self.trimmed[motor])
    }

    /// Ends the run, which should have made `expected` steps.
    #[must_use]
    pub fn finish(mut self, expected: Option<[i32; MOTORS]>) -> Findings {
        let counts = self.untrimmed();
        let (strain, residual) = (self.strain(&counts), self.residual(&counts));
        if residual != 0 {
            self.findings.add(self.last_tick, || format!("motors rest {residual} steps against each other"));
        }
        let Self { sampler, names, gauge, changes, findings, last_tick, .. } = &mut self;
        let rest = *last_tick + LONGEST_WINDOW as u64 * SAMPLE_TICKS;
        changes.advance(findings, rest);
        sampler.advance(rest, |sample| gauge.measure(findings, sample));
        if let Some((sum, most)) = strain
            && sum.abs() >= most
        {
            findings.add(*last_tick, || format!("motors rest {sum} steps against each other"));
        }
        let expected = expected.map(|counts| counts.map(i64::from));
        for (i, name) in names.iter().enumerate() {
            let counted = sampler.counts()[i];
            if let Some(due) = expected.map(|e| e[i])
                && due != counted
            {
                findings.add(*last_tick, || format!("{name} ends at step {counted} instead of {due}"));
            }
        }
        self.findings
    }

    fn check_spacing(&mut self, tick: u64, steps: MotorSet) {
        for ((motor, last), name) in Motor::ALL.into_iter().zip(&mut self.last_pulse).zip(self.names) {
            if !steps.has(motor) {
                continue;
            }
            if let Some(before) = last.replace(tick) {
                let gap = tick.saturating_sub(before);
                if gap < MIN_STEP_INTERVAL {
                    self.findings.add(tick, || {
                        format!("two pulses of {name} are {gap} ticks apart, {MIN_STEP_INTERVAL} is the least")
                    });
                }
            }
        }
    }

    fn check_mechanism(&mut self, tick: u64, steps: MotorSet) {
        let counts = self.untrimmed();
        let is_consistent = match &self.residuals {
            // Four counts are rounded to half a step each.
            Some(_) => self.residual(&counts) <= 2,
            None => {
                let is_strained = self.strain(&counts).is_some_and(|(sum, most)| sum.abs() > most);
                // Groups that were together and rest still are.
                let may_differ = |group: &&Group| !self.is_consistent || group.motors().intersects(steps);
                let mut groups = self.groups.iter().filter(may_differ);
                !is_strained && groups.all(|group| is_together(group, &counts))
            }
        };
        // Once per episode: a lost step strains the machine until the end.
        if self.is_consistent && !is_consistent {
            let counts = self.names.iter().zip(counts).filter(|(name, _)| !name.is_none());
            let counts = counts.map(|(name, count)| format!(" {name} {count}"));
            let counts: String = counts.collect();
            self.findings.add(tick, || format!("motors out of step:{counts}"));
        }
        self.is_consistent = is_consistent;
    }

    /// The greatest residual of a belt that may run round, in steps.
    fn residual(&self, counts: &Counts) -> i64 {
        let sum =
            |residual: &Residual| residual.iter().zip(counts).map(|(times, count)| i64::from(*times) * count).sum();
        self.residuals.iter().flat_map(Residuals::iter).map(sum).map(i64::abs).max().unwrap_or_default()
    }

    /// The sum of counts that no position changes, if the mechanism has one, and its bound by rounding.
    fn strain(&self, counts: &Counts) -> Option<(i64, i64)> {
        let constraint = self.constraint?;
        let parts =
            self.groups.iter().zip(constraint).map(|(group, times)| i64::from(times) * counts[group.lead.index()]);
        let most = constraint.iter().map(|times| i64::from(times.abs())).sum::<i64>() / 2;
        Some((parts.sum(), most))
    }
}

/// Whether the motors of a group have made the same steps, and motors in the opposite direction the opposite ones.
fn is_together(group: &Group, counts: &Counts) -> bool {
    let at = counts[group.lead.index()];
    // A loop, because it runs at every event.
    for (motor, count) in Motor::ALL.into_iter().zip(counts) {
        if (group.with.has(motor) && *count != at) || (group.against.has(motor) && *count != -at) {
            return false;
        }
    }
    true
}

/// The measurement of the coordinates.
struct Gauge {
    back: ForwardKinematics<{ MOTORS }>,
    belts: Vec<Group>,
    /// In the order of [`Limits::of`]; empty if there is nothing to judge.
    coordinates: Vec<Coordinate>,
}

impl Gauge {
    fn new(s: &Settings, limits: &Limits) -> Self {
        let back = s.mechanism.forward_kinematics().unwrap_or(ForwardKinematics::NONE);
        let parts = back.fractions(&[0; MOTORS]).map(|(_, over)| over);
        let parts = parts.into_iter().chain(std::iter::repeat(1));
        let judged = if limits.is_judged { &limits.of[..] } else { &[] };
        let both = judged.iter().zip(parts).enumerate();
        let coordinates = both.map(|(i, (limit, parts))| Coordinate::new(limit.clone(), bend(i), parts)).collect();
        Self { back, belts: belts(s), coordinates }
    }

    fn measure(&mut self, findings: &mut Findings, sample: &Sample) {
        let axes = self.back.fractions(&sample.counts).map(|(sum, _)| sum);
        let belts = self.belts.iter().map(|belt| sample.counts[belt.lead.index()]);
        for (coordinate, at) in self.coordinates.iter_mut().zip(axes.into_iter().chain(belts)) {
            if let Some(excess) = coordinate.measure(at) {
                findings.add(sample.tick, || excess.to_string());
            }
        }
    }
}

/// A limit that was not kept.
struct Excess {
    limit: Limit,
    kind: Kind,
    /// The measured value.
    value: f64,
    /// The window in seconds.
    window: f64,
}

enum Kind {
    Speed,
    Acceleration,
}

impl std::fmt::Display for Excess {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { limit, value, window, .. } = self;
        let (verb, most, unit) = match self.kind {
            Kind::Speed => ("moves", limit.speed, "mm/s"),
            Kind::Acceleration => ("accelerates", limit.acceleration, "mm/s2"),
        };
        let ms = window * 1e3;
        write!(f, "{} {verb} at {value:.1} {unit} over {ms} ms, the limit is {most:.1}", limit.name)
    }
}

/// One coordinate, its recent positions and its measuring windows in samples.
struct Coordinate {
    limit: Limit,
    /// How much the acceleration limit is exceeded by braking in a curve.
    bend: f64,
    /// mm of a unit of its positions: an axis may be a part of a sum of counts.
    unit: f64,
    /// The last [`LONGEST_WINDOW`] positions; `next` is the oldest.
    past: [i64; LONGEST_WINDOW],
    next: usize,
    long: usize,
    short: usize,
    /// Samples for which a further excess belongs to the last one.
    quiet: u32,
}

impl Coordinate {
    /// A coordinate with positions known in `parts` parts of a step.
    fn new(limit: Limit, bend: f64, parts: i64) -> Self {
        let samples =
            |seconds: f64| ((seconds * f64::from(SAMPLES_PER_SECOND)) as usize).clamp(2, LONGEST_WINDOW / 2 - 1);
        let long = samples(limit.speed / (5.0 * limit.acceleration));
        let short = samples((2.0 * QUANTISATION * limit.step / limit.acceleration).sqrt()).min(long);
        let unit = limit.step / parts as f64;
        Self { limit, bend, unit, past: [0; LONGEST_WINDOW], next: 0, long, short, quiet: 0 }
    }

    /// Takes in the next position and returns a new excess of the recent ones.
    fn measure(&mut self, at: i64) -> Option<Excess> {
        self.past[self.next] = at;
        self.next = (self.next + 1) % LONGEST_WINDOW;
        let excess = self.speed().or_else(|| self.acceleration(self.short)).or_else(|| self.acceleration(self.long));
        let is_new = self.quiet == 0;
        self.quiet = if excess.is_some() { EPISODE } else { self.quiet.saturating_sub(1) };
        excess.filter(|_| is_new)
    }

    fn speed(&self) -> Option<Excess> {
        let limit = &self.limit;
        let window = self.seconds(self.long);
        let way = self.travel(0, self.long).abs();
        // Half a percent for the rounding of a move's times to whole ticks.
        let is_over = way > limit.speed * window * 1.005 + QUANTISATION * limit.step;
        is_over.then(|| Excess { limit: limit.clone(), kind: Kind::Speed, value: way / window, window })
    }

    fn acceleration(&self, samples: usize) -> Option<Excess> {
        let limit = &self.limit;
        let window = self.seconds(samples);
        let (before, after) = (self.travel(samples, 2 * samples), self.travel(0, samples));
        // An endstop at the low end stops a motion towards it.
        let stop = if limit.hard_stop.is_infinite() || (before < 0.0 && after > before) {
            limit.hard_stop
        } else if before > 0.0 && after < before {
            limit.hard_stop_up
        } else {
            0.0
        };
        let jump = limit.jump + stop;
        let most = self.bend * limit.acceleration * window * window + jump * window + 2.0 * QUANTISATION * limit.step;
        let change = (after - before).abs();
        (change > most).then(|| Excess {
            limit: limit.clone(),
            kind: Kind::Acceleration,
            value: change / (window * window),
            window,
        })
    }

    /// The way in mm from `from` samples ago to `to` samples ago.
    fn travel(&self, to: usize, from: usize) -> f64 {
        let at = |ago: usize| self.past[(self.next + LONGEST_WINDOW - 1 - ago) % LONGEST_WINDOW];
        (at(to) - at(from)) as f64 * self.unit
    }

    fn seconds(&self, samples: usize) -> f64 {
        samples as f64 / f64::from(SAMPLES_PER_SECOND)
    }
}

mod changes;
#[cfg(test)]
mod tests;
