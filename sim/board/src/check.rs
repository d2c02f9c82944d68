//! Checker: holds every step of a run to physics and to the mechanism.
//!
//! At every event:
//!
//! - time does not fall;
//! - two pulses of a motor are at least [`MIN_STEP_INTERVAL`](corehbot::motion::MIN_STEP_INTERVAL) apart;
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
//! steps/mm, 5 m/s2 and d = 0.013 mm it finds any jump above 65 mm/s. Within 4 ms the speeds of all axes and belt
//! motors are checked step by step (`changes.rs`). That finds an oscillation that is too short for both windows, and an
//! axis that starts without its ramp.
//!
//! A switch or the probe may stop an axis at once. That counts in windows in which something has ended all motion
//! ([`Checker::stopped`]), and in no other.

use self::changes::Changes;
use self::gauge::Gauge;
use self::spacing::Spacing;
use self::together::Together;
use crate::limits::Limits;
use crate::sampler::{LONGEST_WINDOW, SAMPLE_TICKS, SAMPLES_PER_SECOND, Sample, Sampler};
use corehbot::motors::{MOTORS, MotorName, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::TICKS_PER_SECOND;

/// Violations that are kept in words; the others are only counted.
const KEPT: usize = 10;

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
    gauge: Gauge,
    changes: Changes,
    spacing: Spacing,
    together: Together,
    /// The last event's tick, and the latest of all: where time falls, steps count as made then.
    last_tick: u64,
    latest: u64,
    stops: Stops,
    findings: Findings,
}

/// When something has ended all motion at once, the last two times: samples are judged a little later.
#[derive(Clone, Copy, Debug, Default)]
struct Stops([Option<u64>; 2]);

impl Stops {
    /// Whether it was within so many ticks before `tick`.
    fn is_within(self, tick: u64, ticks: u64) -> bool {
        self.0.into_iter().flatten().any(|stop| stop <= tick && tick <= stop + ticks)
    }
}

impl Checker {
    /// A checker for a machine at rest with these settings and limits.
    #[must_use]
    pub fn new(s: &Settings, limits: &Limits) -> Self {
        Self {
            sampler: Sampler::new(&s.mechanism),
            names: s.motor_names,
            gauge: Gauge::new(s, limits),
            changes: Changes::new(s, limits),
            spacing: Spacing::default(),
            together: Together::new(s, limits),
            last_tick: 0,
            latest: 0,
            stops: Stops::default(),
            findings: Findings::default(),
        }
    }

    /// One instant in which `steps` move, each forward or backward.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        self.event_between(tick, steps, forward, |_| {});
    }

    /// One instant like [`Checker::event`]; `each` sees the samples before it too.
    #[inline]
    pub fn event_between(&mut self, tick: u64, steps: MotorSet, forward: MotorSet, mut each: impl FnMut(&Sample)) {
        let Self { sampler, names, gauge, changes, spacing, together, last_tick, latest, stops, findings } = self;
        let before = std::mem::replace(last_tick, tick);
        if tick < before {
            findings.add(tick, || format!("time falls from tick {before}"));
        }
        let tick = tick.max(*latest);
        *latest = tick;
        spacing.event(findings, names, tick, steps);
        changes.event(findings, *stops, tick, steps, forward);
        sampler.event(tick, steps, forward, |sample| {
            gauge.measure(findings, *stops, sample);
            each(sample);
        });
        together.event(findings, tick, steps, forward, sampler.counts());
    }

    /// A switch, the probe or a halt has just ended all motion at once.
    pub const fn stopped(&mut self, tick: u64) {
        self.stops = Stops([self.stops.0[1], Some(tick)]);
    }

    /// The sampler, after the last event.
    #[must_use]
    pub const fn sampler(&self) -> &Sampler {
        &self.sampler
    }

    /// Ends the run, which should have made `expected` steps.
    #[must_use]
    pub fn finish(mut self, expected: Option<[i32; MOTORS]>) -> Findings {
        let Self { sampler, names, gauge, changes, together, findings, latest, stops, .. } = &mut self;
        let (strain, residual) = together.at_rest(sampler.counts());
        if residual != 0 {
            findings.add(*latest, || format!("motors rest {residual} steps against each other"));
        }
        let rest = *latest + LONGEST_WINDOW as u64 * SAMPLE_TICKS;
        changes.advance(findings, *stops, rest);
        sampler.advance(rest, |sample| gauge.measure(findings, *stops, sample));
        if let Some((sum, most)) = strain
            && sum.abs() >= most
        {
            findings.add(*latest, || format!("motors rest {sum} steps against each other"));
        }
        let expected = expected.map(|counts| counts.map(i64::from));
        for (i, name) in names.iter().enumerate() {
            let counted = sampler.counts()[i];
            if let Some(due) = expected.map(|e| e[i])
                && due != counted
            {
                findings.add(*latest, || format!("{name} ends at step {counted} instead of {due}"));
            }
        }
        self.findings
    }
}

mod changes;
mod gauge;
mod spacing;
#[cfg(test)]
mod tests;
mod together;
