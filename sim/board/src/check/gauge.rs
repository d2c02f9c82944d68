//! Gauge: speeds and accelerations of all coordinates, measured on samples. The head of [`check`](super) has the rules.
//!
//! Nearly all samples are far from any limit. Whole numbers tell so: a difference of positions that is a step smaller
//! than the bound keeps it, whatever the rounding of the comparison in floating point. Only the others are compared.

use super::{EPISODE, Findings, Stops};
use crate::axis_sums::AxisSums;
use crate::limits::{Limit, Limits, belts};
use crate::sampler::{LONGEST_WINDOW, SAMPLE_TICKS, SAMPLES_PER_SECOND, Sample};
use corehbot::motors::Motor;
use corehbot::settings::Settings;
use std::f64::consts::SQRT_2;

/// Steps that quantisation can fake in a position difference: one, and a half for uneven rounding.
const QUANTISATION: f64 = 1.5;

/// The factor of the acceleration limit of a coordinate by its place in [`Limits::of`]. Only x, y and the belts see
/// curves; z and e get five percent for the rounding of times to whole ticks.
const fn bend(coordinate: usize) -> f64 {
    if matches!(coordinate, 2 | 3) { 1.05 } else { SQRT_2 }
}

/// Positions further apart than this, in parts of a step, are always compared in floating point, which holds such
/// numbers and their products to an eighth of a part.
const WIDEST: f64 = (1u64 << 48) as f64;

const _: () = assert!(LONGEST_WINDOW > EPISODE as usize);

/// The measurement of the coordinates.
pub(super) struct Gauge {
    /// Motors with the coordinates of belts.
    belts: Vec<Motor>,
    /// In the order of [`Limits::of`]; empty if there is nothing to judge.
    pub(super) coordinates: Vec<Coordinate>,
}

impl Gauge {
    pub fn new(s: &Settings, limits: &Limits) -> Self {
        let parts = AxisSums::new(&s.mechanism).over().into_iter().chain(std::iter::repeat(1));
        let judged = if limits.is_judged { &limits.of[..] } else { &[] };
        let both = judged.iter().zip(parts).enumerate();
        let coordinates = both.map(|(i, (limit, parts))| Coordinate::new(limit.clone(), bend(i), parts)).collect();
        Self { belts: belts(s).into_iter().map(|belt| belt.lead).collect(), coordinates }
    }

    /// Measures what the next sample shows.
    #[inline]
    pub fn measure(&mut self, findings: &mut Findings, stops: Stops, sample: &Sample) {
        let axes = self.coordinates.len().min(sample.sums.len());
        let (axes, belts) = self.coordinates.split_at_mut(axes);
        for (axis, at) in axes.iter_mut().zip(sample.sums) {
            axis.measure(findings, stops, sample.tick, at);
        }
        for (belt, lead) in belts.iter_mut().zip(&self.belts) {
            belt.measure(findings, stops, sample.tick, sample.counts[lead.index()]);
        }
    }
}

/// A limit that was not kept.
pub(super) struct Excess {
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

/// Differences of positions, in parts of a step, up to which a coordinate certainly keeps its limits.
#[derive(Clone, Copy)]
struct Harmless {
    /// Its way within the long window.
    way: i64,
    /// The change of its way from one short window to the next, and from one long window.
    short: i64,
    long: i64,
}

/// Whether a difference is no greater in any direction, by one comparison.
#[inline(always)]
const fn is_within(difference: i64, most: i64) -> bool {
    most >= 0 && difference.wrapping_add(most) as u64 <= most as u64 * 2
}

/// One coordinate, its recent positions and its measuring windows in samples.
pub(super) struct Coordinate {
    limit: Limit,
    /// How much the acceleration limit is exceeded by braking in a curve.
    bend: f64,
    /// mm of a unit of its positions: an axis may be a part of a sum of counts.
    unit: f64,
    /// The last [`LONGEST_WINDOW`] positions; `next` is the oldest.
    past: [i64; LONGEST_WINDOW],
    next: usize,
    /// For how many samples it has rested, the last one included.
    resting: usize,
    long: usize,
    short: usize,
    harmless: Harmless,
    /// Samples for which a further excess belongs to the last one.
    quiet: u32,
}

impl Coordinate {
    /// A coordinate with positions known in `parts` parts of a step.
    pub fn new(limit: Limit, bend: f64, parts: i64) -> Self {
        let samples =
            |seconds: f64| ((seconds * f64::from(SAMPLES_PER_SECOND)) as usize).clamp(2, LONGEST_WINDOW / 2 - 1);
        let long = samples(limit.speed / (5.0 * limit.acceleration));
        let short = samples((2.0 * QUANTISATION * limit.step / limit.acceleration).sqrt()).min(long);
        let unit = limit.step / parts as f64;
        let (past, harmless) = ([0; LONGEST_WINDOW], Harmless { way: 0, short: 0, long: 0 });
        let mut coordinate =
            Self { limit, bend, unit, past, next: 0, resting: LONGEST_WINDOW, long, short, harmless, quiet: 0 };
        // A part less, which is more than all rounding.
        let parts = |mm: f64| (mm / unit).min(WIDEST) as i64 - 1;
        coordinate.harmless = Harmless {
            way: parts(coordinate.most_way()),
            short: parts(coordinate.most_change(short, 0.0)),
            long: parts(coordinate.most_change(long, 0.0)),
        };
        coordinate
    }

    /// Takes in the next position, and finds a new excess of the recent ones.
    #[inline(always)]
    fn measure(&mut self, findings: &mut Findings, stops: Stops, tick: u64, at: i64) {
        if self.resting >= LONGEST_WINDOW && at == self.past(0) {
            // All positions are the same, and the last excess is long ago.
            return;
        }
        self.put(at);
        if self.is_harmless() {
            self.quiet = self.quiet.saturating_sub(1);
        } else {
            self.judge(findings, stops, tick);
        }
    }

    #[cold]
    fn judge(&mut self, findings: &mut Findings, stops: Stops, tick: u64) {
        let (excess, is_new) = (self.excess(stops, tick), self.quiet == 0);
        self.quiet = if excess.is_some() { EPISODE } else { self.quiet.saturating_sub(1) };
        if let Some(excess) = excess.filter(|_| is_new) {
            findings.add(tick, || excess.to_string());
        }
    }

    /// Takes in the next position.
    #[inline]
    pub fn put(&mut self, at: i64) {
        self.resting = if at == self.past(0) { self.resting + 1 } else { 0 };
        self.past[self.next] = at;
        self.next = (self.next + 1) % LONGEST_WINDOW;
    }

    /// Whether there can be no excess.
    #[inline(always)]
    pub fn is_harmless(&self) -> bool {
        if self.resting > 2 * self.long {
            return true;
        }
        let Self { short, long, .. } = *self;
        let now = self.past(0);
        let (short_way, long_way) = (now - self.past(short), now - self.past(long));
        let short_change = short_way - (self.past(short) - self.past(2 * short));
        let long_change = long_way - (self.past(long) - self.past(2 * long));
        is_within(long_way, self.harmless.way)
            && is_within(short_change, self.harmless.short)
            && is_within(long_change, self.harmless.long)
    }

    /// The excess of the recent positions.
    pub fn excess(&self, stops: Stops, tick: u64) -> Option<Excess> {
        let accelerated = |samples: usize| {
            let has_stopped = stops.is_within(tick, (2 * samples as u64 + 1) * SAMPLE_TICKS);
            self.acceleration(samples, has_stopped)
        };
        self.speed().or_else(|| accelerated(self.short)).or_else(|| accelerated(self.long))
    }

    /// The greatest way in mm within the long window.
    fn most_way(&self) -> f64 {
        // Half a percent for the rounding of a move's times to whole ticks.
        self.limit.speed * self.seconds(self.long) * 1.005 + QUANTISATION * self.limit.step
    }

    /// The greatest change of way in mm from one window to the next, with an endstop that changes the speed.
    fn most_change(&self, samples: usize, stop: f64) -> f64 {
        let (limit, window) = (&self.limit, self.seconds(samples));
        let jump = limit.jump + stop;
        self.bend * limit.acceleration * window * window + jump * window + 2.0 * QUANTISATION * limit.step
    }

    fn speed(&self) -> Option<Excess> {
        let window = self.seconds(self.long);
        let way = self.travel(0, self.long).abs();
        let is_over = way > self.most_way();
        is_over.then(|| Excess { limit: self.limit.clone(), kind: Kind::Speed, value: way / window, window })
    }

    /// The excess over two windows, in which something has ended all motion or not.
    fn acceleration(&self, samples: usize, has_stopped: bool) -> Option<Excess> {
        let limit = &self.limit;
        let window = self.seconds(samples);
        let (before, after) = (self.travel(samples, 2 * samples), self.travel(0, samples));
        // An endstop at the low end stops a motion towards it, so the speed jumps upwards. The way before may be one up
        // already: the stop lies at its begin, and the way back behind it.
        let stop = if !has_stopped {
            0.0
        } else if limit.hard_stop.is_infinite() || after > before {
            limit.hard_stop
        } else {
            limit.hard_stop_up
        };
        let change = (after - before).abs();
        (change > self.most_change(samples, stop)).then(|| Excess {
            limit: limit.clone(),
            kind: Kind::Acceleration,
            value: change / (window * window),
            window,
        })
    }

    /// The way in mm from `from` samples ago to `to` samples ago.
    fn travel(&self, to: usize, from: usize) -> f64 {
        (self.past(to) - self.past(from)) as f64 * self.unit
    }

    /// The position some samples ago.
    const fn past(&self, ago: usize) -> i64 {
        self.past[(self.next + LONGEST_WINDOW - 1 - ago) % LONGEST_WINDOW]
    }

    fn seconds(&self, samples: usize) -> f64 {
        samples as f64 / f64::from(SAMPLES_PER_SECOND)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampler::SAMPLE_TICKS;

    /// Z falls at 8 mm/s onto its switch, which stops it at once, and rises at its acceleration. Whether an excess is
    /// found, with the stop known or not.
    fn finds(is_known: bool) -> bool {
        let limit = Limit {
            name: "z".to_owned(),
            step: 0.001_25,
            speed: 20.0,
            acceleration: 200.0,
            jump: 0.0,
            hard_stop: 8.0,
            hard_stop_up: 0.0,
        };
        let mut z = Coordinate::new(limit, bend(2), 1);
        let stop = 200;
        let stops = Stops([is_known.then_some(stop as u64 * SAMPLE_TICKS), None]);
        (0..400).any(|sample| {
            let seconds = f64::from(sample - stop) / f64::from(SAMPLES_PER_SECOND);
            let at = if seconds < 0.0 { -8.0 * seconds } else { 100.0 * seconds * seconds };
            z.put((at / 0.001_25).round() as i64);
            // Before, the window reaches over the begin.
            sample > 100 && z.excess(stops, sample as u64 * SAMPLE_TICKS).is_some()
        })
    }

    /// Reproducer: of two windows of 20 ms the earlier one held the stop at its begin, and the rise behind it.
    #[test]
    fn a_stop_at_the_begin_of_the_earlier_window_explains_the_rise() {
        assert_eq!([finds(true), finds(false)], [false, true]);
    }
}
