//! Checker: holds every step of a run to physics and to the mechanism.
//!
//! At every event: time does not fall; two pulses of a motor are at least [`MIN_STEP_INTERVAL`] apart; motors
//! 1 and 8 mirror each other, 4 and 11 too, so the belt is not strained (`n1 - n4 + n8 - n11 = 0`); the two
//! ball screws stand equally high. At the end: the counts are the expected ones.
//!
//! Speeds and accelerations are measured on positions sampled every 0.5 ms. With window T and step q:
//!
//! - speed: `|p(t) - p(t-T)| <= V T + Q`, where Q = 1.5 q is what quantisation can fake;
//! - acceleration: the second difference `|p(t) - 2 p(t-T) + p(t-2T)|`, which is the acceleration averaged
//!   with a triangular weight times T^2, is at most `sqrt2 A T^2 + J T + 2 Q`. The factor sqrt2 (x, y and belt
//!   only) is an axis that brakes at its limit and rounds a curve at the limit as well; J is one corner's jump of speed (see
//!   [`limits`](crate::limits)). More corners within one window are within the bound if the planner lets no
//!   chain of corners turn faster than a curve at the limit would.
//!
//! A long window (T = V / 5A) finds, on the belt axes, an acceleration of twice the limit before the axis is
//! as fast as its speed limit; a short one (T = sqrt(2Q / A)), where the three terms are least together, finds a jump: for
//! 80 steps/mm, 5 m/s2 and d = 0.013 mm any jump above 65 mm/s.

use crate::limits::{Limit, Limits};
use crate::sampler::{Counts, LONGEST_WINDOW, SAMPLE_TICKS, SAMPLES_PER_SECOND, Sample, Sampler};
use corehbot::motion::MIN_STEP_INTERVAL;
use corehbot::motors::{Motor, MotorSet};
use corehbot::units::TICKS_PER_SECOND;
use std::f64::consts::SQRT_2;

/// Violations that are kept in words; the rest is counted.
const KEPT: usize = 10;

/// Steps that quantisation can fake in a position difference: one, and a half for uneven rounding.
const QUANTISATION: f64 = 1.5;

/// The factor of the acceleration limit in the order of [`Limits::of`]. Only x, y and the belt see curves; the
/// others get five percent for the rounding of times to whole ticks.
const BEND: [f64; 6] = [SQRT_2, SQRT_2, 1.05, 1.05, SQRT_2, SQRT_2];

/// A line of violations that follow each other within this many samples is one violation.
const EPISODE: u32 = SAMPLES_PER_SECOND / 10;

/// Something that a sound firmware would not do.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Violation {
    /// When, in motion time.
    pub tick: u64,
    /// What, in words.
    pub text: String,
}

impl std::fmt::Display for Violation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "at {:.4} s (tick {}): {}", self.tick as f64 / f64::from(TICKS_PER_SECOND), self.tick, self.text)
    }
}

/// What the checker found.
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
    coordinates: Vec<Coordinate>,
    last_tick: u64,
    /// Tick of each motor's last pulse.
    last_pulse: [Option<u64>; Motor::ALL.len()],
    is_consistent: bool,
    findings: Findings,
}

impl Checker {
    /// A checker for a machine with these limits, which stands still.
    #[must_use]
    pub fn new(limits: &Limits) -> Self {
        let judged = if limits.is_judged { &limits.of[..] } else { &[] };
        Self {
            sampler: Sampler::default(),
            coordinates: judged.iter().zip(BEND).map(|(&limit, bend)| Coordinate::new(limit, bend)).collect(),
            last_tick: 0,
            last_pulse: [None; Motor::ALL.len()],
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
        let Self { sampler, coordinates, findings, .. } = self;
        sampler.event(tick, steps, forward, |sample| measure(coordinates, findings, sample));
        self.check_mechanism(tick);
    }

    /// Ends the run, which should have made `expected` steps.
    #[must_use]
    pub fn finish(mut self, expected: Option<[i32; Motor::ALL.len()]>) -> Findings {
        let Self { sampler, coordinates, findings, last_tick, .. } = &mut self;
        let rest = *last_tick + LONGEST_WINDOW as u64 * SAMPLE_TICKS;
        sampler.advance(rest, |sample| measure(coordinates, findings, sample));
        let expected = expected.map(|counts| counts.map(i64::from));
        for (i, motor) in Motor::ALL.iter().enumerate() {
            let counted = sampler.counts()[i];
            if let Some(due) = expected.map(|e| e[i])
                && due != counted
            {
                let name = motor.name();
                findings.add(*last_tick, || format!("{name} ends at step {counted} instead of {due}"));
            }
        }
        self.findings
    }

    fn check_spacing(&mut self, tick: u64, steps: MotorSet) {
        for (motor, last) in Motor::ALL.into_iter().zip(&mut self.last_pulse) {
            if !steps.has(motor) {
                continue;
            }
            if let Some(before) = last.replace(tick) {
                let gap = tick.saturating_sub(before);
                if gap < MIN_STEP_INTERVAL {
                    let name = motor.name();
                    self.findings.add(tick, || {
                        format!("two pulses of {name} are {gap} ticks apart, {MIN_STEP_INTERVAL} is the least")
                    });
                }
            }
        }
    }

    fn check_mechanism(&mut self, tick: u64) {
        let &[m1, m4, m8, m11, z1, z2, _] = self.sampler.counts();
        let is_consistent = m1 == -m8 && m4 == -m11 && m1 - m4 + m8 - m11 == 0 && z1 == z2;
        // Once per episode: a lost step strains the belt until the end.
        if self.is_consistent && !is_consistent {
            self.findings
                .add(tick, || format!("motors out of step: m1 {m1} m8 {m8}, m4 {m4} m11 {m11}, z1 {z1} z2 {z2}"));
        }
        self.is_consistent = is_consistent;
    }
}

fn measure(coordinates: &mut [Coordinate], findings: &mut Findings, sample: &Sample) {
    for (i, coordinate) in coordinates.iter_mut().enumerate() {
        if let Some(excess) = coordinate.measure(half_steps(&sample.counts, i)) {
            findings.add(sample.tick, || excess.to_string());
        }
    }
}

/// Twice a coordinate in steps, in the order of [`Limits::of`]; twice, because x is half of u + v.
fn half_steps(counts: &Counts, coordinate: usize) -> i64 {
    let &[_, _, v, u, z, _, e] = counts;
    match coordinate {
        0 => u + v,
        1 => u - v,
        2 => 2 * z,
        3 => 2 * e,
        4 => 2 * u,
        _ => 2 * v,
    }
}

/// A limit that was not kept.
struct Excess {
    limit: Limit,
    kind: Kind,
    /// What was measured.
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
    /// The last [`LONGEST_WINDOW`] positions in half steps; `next` is the oldest.
    past: [i64; LONGEST_WINDOW],
    next: usize,
    long: usize,
    short: usize,
    /// Samples for which a further excess belongs to the last one.
    quiet: u32,
}

impl Coordinate {
    fn new(limit: Limit, bend: f64) -> Self {
        let samples =
            |seconds: f64| ((seconds * f64::from(SAMPLES_PER_SECOND)) as usize).clamp(2, LONGEST_WINDOW / 2 - 1);
        let long = samples(limit.speed / (5.0 * limit.acceleration));
        let short = samples((2.0 * QUANTISATION * limit.step / limit.acceleration).sqrt()).min(long);
        Self { limit, bend, past: [0; LONGEST_WINDOW], next: 0, long, short, quiet: 0 }
    }

    /// Takes in the next position and says what is newly wrong with the recent ones.
    fn measure(&mut self, half_steps: i64) -> Option<Excess> {
        self.past[self.next] = half_steps;
        self.next = (self.next + 1) % LONGEST_WINDOW;
        let excess = self.speed().or_else(|| self.acceleration(self.short)).or_else(|| self.acceleration(self.long));
        let is_new = self.quiet == 0;
        self.quiet = if excess.is_some() { EPISODE } else { self.quiet.saturating_sub(1) };
        excess.filter(|_| is_new)
    }

    fn speed(&self) -> Option<Excess> {
        let limit = self.limit;
        let window = self.seconds(self.long);
        let way = self.travel(0, self.long).abs();
        // Half a percent for the rounding of a move's times to whole ticks.
        let is_over = way > limit.speed * window * 1.005 + QUANTISATION * limit.step;
        is_over.then(|| Excess { limit, kind: Kind::Speed, value: way / window, window })
    }

    fn acceleration(&self, samples: usize) -> Option<Excess> {
        let limit = self.limit;
        let window = self.seconds(samples);
        let (before, after) = (self.travel(samples, 2 * samples), self.travel(0, samples));
        // An endstop at the low end stops a motion towards it.
        let hits_endstop = limit.hard_stop > 0.0 && (before < 0.0 && after > before || limit.hard_stop.is_infinite());
        let jump = if hits_endstop { limit.jump + limit.hard_stop } else { limit.jump };
        let most = self.bend * limit.acceleration * window * window + jump * window + 2.0 * QUANTISATION * limit.step;
        let change = (after - before).abs();
        (change > most).then(|| Excess { limit, kind: Kind::Acceleration, value: change / (window * window), window })
    }

    /// The way in mm from `from` samples ago to `to` samples ago.
    fn travel(&self, to: usize, from: usize) -> f64 {
        let at = |ago: usize| self.past[(self.next + LONGEST_WINDOW - 1 - ago) % LONGEST_WINDOW];
        (at(to) - at(from)) as f64 * 0.5 * self.limit.step
    }

    fn seconds(&self, samples: usize) -> f64 {
        samples as f64 / f64::from(SAMPLES_PER_SECOND)
    }
}

#[cfg(test)]
mod tests;
