//! Step time solver: the times at which a motor's position crosses from one step to the next.
//!
//! In one piece a motor's position is a quadratic in time. Seen from the slower end of the piece, with the speed v
//! there, a distance of d steps is covered after
//!
//! ```text
//! t = 2 d / (v + u),    u = sqrt(v^2 + 4 h d),    h = (D - v T) / T^2
//! ```
//!
//! D is the length of the piece, T its time, and u the speed there. Nothing cancels, and both ends are exact. Nothing
//! is summed from piece to piece, so errors cannot grow.
//!
//! Step times are solved in cubic runs of n. The first time of a run uses this formula. The others lie on the cubic
//! with the right slope 1/u at both ends of the run, at three sums a step. Hermite's remainder, f n^4 / 384 with the
//! fourth derivative f = 120 h^3 / u^7 of the slow end, gives the error. With r = 4 h n / u^2, the fraction by which
//! u^2 changes over the run, it is
//!
//! ```text
//! 15 / 3072 r^3 n / u ticks
//! ```
//!
//! If that is too much, a run is shorter, down to a single step.

use super::cubic_run::{CubicRun, FINE, HALF, fine, finer};
use crate::motion::number::{root, root_in_place, ticks, to_f32};
use crate::motion::ticks::MIN_STEP_INTERVAL;
use crate::motion::trajectory::phase::Curve;
use crate::settings::ranges::STEP_RATE;
use crate::units::{Steps, SubTicks, TICKS_PER_SECOND};

/// Time and speed at the begin or end of a piece.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct Endpoint {
    /// In ticks times 2^16.
    pub time: SubTicks,
    pub position: Steps,
    /// In steps a tick.
    pub speed: f32,
}

/// The longest run with changing speed; all lengths are powers of two.
const LONGEST_CURVED: u8 = 32;

/// Maximum error of interpolation in ticks. Fixed point adds less than a 30th. A run of 32 sums twice a value rounded
/// to half a bit of [`FINE`], and three times a value cut to a bit of [`FINER`](super::cubic_run::FINER).
const MOST_ERROR: f32 = 0.125;

/// From the formula above, squared.
const MOST_ROUGHNESS: f32 = (MOST_ERROR * 3072.0 / 15.0) * (MOST_ERROR * 3072.0 / 15.0);

/// A longer run than this, in ticks, would overflow 32 bits.
const LONGEST_RUN: f32 = (1 << (31 - FINE)) as f32;

/// At this step rate or below, in steps a tick, two pulses cannot come too close to each other. Rounding and
/// interpolation take less than 2 ticks of 19.
const SPARSE: f32 = 1.0 / (MIN_STEP_INTERVAL + ROUNDING) as f32;

/// Ticks by which rounding and interpolation may move two steps closer to each other.
const ROUNDING: u64 = 2;
// The highest legal step rate is sparse, so that none of its steps is ever late.
const _: () = assert!((MIN_STEP_INTERVAL + ROUNDING) * STEP_RATE.whole() as u64 <= TICKS_PER_SECOND as u64);

/// A piece is steady if the change of its speed shifts no step by more than a quarter of this, in ticks.
const LEAST_SHIFT: f32 = 0.2;

/// The step times of one piece, in order.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct StepTimeSolver {
    curve: Curve,
    /// Distance of the next step from the slow end: whole steps, counted, and a fraction. A sum would lose significant
    /// digits where few steps are left.
    whole: i32,
    part: f32,
    /// v, or the time of a step if it is constant.
    slow: f32,
    /// h
    rise: f32,
    /// Time of the slow end from the whole tick `base`, and half a tick for rounding.
    offset: f32,
    base: u32,
    /// Speed at the next step.
    fast: f32,
    /// Length of the runs while speed changes, as long as the piece and the caller's room last. It never more than
    /// doubles at once, because a run that is slightly too long is easily much too long.
    run: u8,
    /// Whether two pulses may come too close: the piece is fast, or rounding has left a late step from the previous
    /// piece.
    pub is_dense: bool,
}

impl StepTimeSolver {
    /// No piece.
    pub const NONE: Self = Self {
        curve: Curve::Steady,
        whole: 0,
        part: 0.0,
        slow: 0.0,
        rise: 0.0,
        offset: 0.0,
        base: 0,
        fast: 0.0,
        run: 1,
        is_dense: true,
    };

    /// Step times between `from` and `to`, with the first step at `first` and no reversal in between.
    pub fn new(from: &Endpoint, to: &Endpoint, first: Steps, is_forward: bool, shape: Option<(Curve, f32)>) -> Self {
        let distance = |from: Steps, to: Steps| {
            if is_forward { to.wrapping_sub(from) } else { from.wrapping_sub(to) }
        };
        let time = ticks(to.time - from.time);
        let way = to_f32(distance(from.position, to.position));
        // If the motor's path is one span, its curve is the span's curve. The difference of two large speeds would be
        // less accurate.
        let (v0, v1) = (from.speed.abs(), to.speed.abs());
        let even = if v0 <= v1 { Curve::Speeding } else { Curve::Slowing };
        let (curve, covered) = match shape {
            Some((Curve::Steady, _)) => (Curve::Steady, way),
            Some((curve, share)) => (curve, way * share),
            None => (even, v0.min(v1) * time),
        };
        let gain = way - covered;
        let offset = ((from.time.0 & 0xFFFF) as u32) as f32 * const { 1.0 / 65536.0 } + 0.5;
        let base = from.time.whole_ticks() as u32;
        // The gain moves a place by a quarter of itself at most, in the middle. It may be less than 0 by rounding:
        // steady, too.
        let is_steady = gain * time < LEAST_SHIFT * way;
        let is_slowing = !is_steady && curve != Curve::Speeding;
        let solver = if is_steady {
            let is_dense = way > time * SPARSE;
            Self { slow: time / way, offset, base, is_dense, ..Self::NONE }
        } else {
            let (slow, rise) = (covered / time, gain / (time * time));
            let is_dense = slow + 2.0 * (rise * time) > SPARSE;
            // Time is reckoned back from the slow end. Runs begin long at the fast end, and from one step at the slow
            // end.
            let (offset, run) = if is_slowing { (offset + time, LONGEST_CURVED) } else { (offset, 1) };
            Self { curve, slow, rise, offset, base, run, is_dense, ..Self::NONE }
        };
        let from_slow_end = if is_slowing { distance(first, to.position) } else { distance(from.position, first) };
        solver.seen_from_slow_end(from_slow_end)
    }

    /// Sets the distance of the first step from the slow end.
    #[inline(always)]
    fn seen_from_slow_end(mut self, distance: Steps) -> Self {
        let bits = distance.to_bits();
        self.part = ((bits as u32) as f32) * const { 1.0 / 4_294_967_296.0 };
        self.whole = (bits >> 32) as i32;
        self.fast = root(self.square(self.whole as f32 + self.part));
        self
    }

    /// The speed squared at a distance from the slow end.
    #[inline(always)]
    fn square(&self, distance: f32) -> f32 {
        self.slow * self.slow + 4.0 * (self.rise * distance)
    }

    /// All steps at once.
    pub fn at_once(time: SubTicks) -> Self {
        Self { base: time.whole_ticks() as u32, ..Self::NONE }
    }

    /// Fills in the ticks of the next steps; there may be more ticks than the piece has steps.
    #[inline(always)]
    pub fn fill(&mut self, ticks: &mut [u32]) {
        let mut left = ticks;
        while !left.is_empty() {
            let (run, count) = match self.curve {
                Curve::Steady => self.steady(left.len()),
                Curve::Speeding | Curve::Slowing => self.curved(left.len()),
            };
            let Some((now, following)) = left.split_at_mut_checked(count) else { return };
            run.write(now);
            left = following;
        }
    }

    /// The next run at constant speed, and its length.
    #[inline(always)]
    fn steady(&mut self, most: usize) -> (CubicRun, usize) {
        let at = self.offset + (self.whole as f32 + self.part) * self.slow;
        let mut count = if at < 0.0 { 1 } else { most };
        while count > 1 && self.slow * count as f32 >= LONGEST_RUN {
            count /= 2;
        }
        self.is_dense |= at < 0.0;
        self.whole += count as i32;
        (CubicRun { pace: fine(self.slow), ..CubicRun::at(self.base, at) }, count)
    }

    /// The next run with changing speed, and its length.
    #[inline(always)]
    fn curved(&mut self, most: usize) -> (CubicRun, usize) {
        let distance = self.whole as f32 + self.part;
        let fast = self.fast;
        let from_slow_end = if distance > 0.0 { (distance + distance) / (self.slow + fast) } else { 0.0 };
        let is_slowing = self.curve == Curve::Slowing;
        let at = if is_slowing { self.offset - from_slow_end } else { self.offset + from_slow_end };
        // Rounding may leave a step that was due before the piece. It comes alone and at once, and the caller spaces
        // the pulses.
        let is_within = distance > 0.0 && at >= 0.0;
        let count = if is_within { self.length(distance, most) } else { 1 };
        self.is_dense |= !is_within;
        self.whole += if is_slowing { -(count as i32) } else { count as i32 };
        self.fast = root_in_place(self.square(self.whole as f32 + self.part));
        let single = CubicRun::at(self.base, at);
        if count == 1 {
            return (single, 1);
        }
        // The mean pace is the most accurate value, because speed changes evenly with time. The slopes at the ends are
        // `change * self.fast` more and `change * fast` less.
        let gain = self.fast - fast;
        let mean = 2.0 / (fast + self.fast);
        let change = 0.5 * (gain * mean) / (fast * self.fast);
        // Hermite's cubic over the run as forward differences: `square` and `cube` are its coefficients of i^2 and i^3.
        let share = 1.0 / count as f32;
        let square = change * (fast - (self.fast + self.fast)) * share;
        let cube = change * gain * (share * share);
        let pace = mean + change * self.fast + (square + cube);
        let jerk = 6.0 * cube;
        (CubicRun { pace: fine(pace), bend: finer(square + square + jerk) + HALF, jerk: finer(jerk), ..single }, count)
    }

    /// Possible length of the next run, which begins at a distance from the slow end. While speed rises, what was
    /// smooth stays so, and while it falls, what was not smooth never is again. So one rule serves both.
    #[inline(always)]
    fn length(&mut self, distance: f32, most: usize) -> usize {
        let length = |run: u8| most.min(usize::from(run));
        while self.run > 1 && !self.is_smooth(distance, length(self.run)) {
            self.run /= 2;
        }
        if length(self.run) < most.min(LONGEST_CURVED.into()) && self.is_smooth(distance, 2 * length(self.run)) {
            self.run *= 2;
        }
        length(self.run)
    }

    /// Whether a cubic is accurate enough for this many steps.
    #[inline(always)]
    fn is_smooth(&self, distance: f32, count: usize) -> bool {
        let count = count as f32;
        let slowest = self.square(if self.curve == Curve::Slowing { distance - count } else { distance });
        let rough = 4.0 * (self.rise * count) / slowest;
        let error = rough * rough * rough * count;
        // Both sides squared, because u is the root of `slowest`.
        slowest > 0.0
            && error * error <= MOST_ROUGHNESS * slowest
            && count * count < LONGEST_RUN * LONGEST_RUN * slowest
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::{vec, vec::Vec};

    /// Begin: not at a whole tick, and shortly before 32-bit ticks wrap.
    const BEGIN: u64 = ((1 << 32) - 1000) << 16 | 0x5555;

    /// All step times of a path from 0 with these speeds, and their exact values.
    fn step_times(v0: f64, v1: f64, time: f64, sign: f64) -> (Vec<u32>, Vec<f64>) {
        let way = (v0 + v1) / 2.0 * time;
        let endpoint = |time: u64, position: f64, speed: f64| Endpoint {
            time: SubTicks(time),
            position: Steps::from_num(sign * position),
            speed: (sign * speed) as f32,
        };
        let (from, to) = (endpoint(BEGIN, 0.0, v0), endpoint(BEGIN + (time * 65536.0) as u64, way, v1));
        let mut solver = StepTimeSolver::new(&from, &to, Steps::from_num(sign * 0.5), sign > 0.0, None);
        let count = (way + 0.5) as usize;
        let mut ticks = vec![0; count];
        for ticks in ticks.chunks_mut(crate::motion::stepgen::step_time_buffer::MOST) {
            solver.fill(ticks);
        }
        let rise = 2.0 * (v1 - v0) / time;
        let exact = |i: usize| {
            let d = i as f64 + 0.5;
            BEGIN as f64 / 65536.0 + 2.0 * d / (v0 + (v0 * v0 + rise * d).max(0.0).sqrt())
        };
        (ticks, (0..count).map(exact).collect())
    }

    #[test]
    fn each_is_where_exact_arithmetic_has_it() {
        let (mut count, mut worst) = (0, 0f64);
        for time in [900.0, 20_000.0, 150_000.0, 524_287.0] {
            for fast in [0.000_2, 0.001, 0.004, 0.02, 0.05] {
                for slow in [0.0, 0.01, 0.3, 0.9, 0.999, 1.0] {
                    for (v0, v1) in [(slow * fast, fast), (fast, slow * fast)] {
                        let (ticks, exact) = step_times(v0, v1, time, 1.0);
                        for (tick, exact) in ticks.iter().zip(exact) {
                            let error = f64::from(tick.wrapping_sub(exact as u64 as u32).cast_signed()) - exact.fract();
                            worst = worst.max(error.abs());
                            count += 1;
                        }
                        assert_eq!(ticks, step_times(v0, v1, time, -1.0).0, "backward as forward");
                    }
                }
            }
        }
        // Half a tick for rounding, an eighth for interpolation, and a tenth for single precision over 52 ms.
        let most = 0.5 + 0.125 + 0.1;
        assert!(count > 200_000 && worst <= most, "worst of {count}: {worst} ticks");
    }

    #[test]
    fn a_step_that_is_left_over_comes_at_once() {
        for (v0, v1) in [(0.001, 0.001), (0.0, 0.002), (0.002, 0.0), (0.001, 0.002), (0.002, 0.001)] {
            let from = Endpoint { time: SubTicks::of_ticks(1000), position: Steps::ZERO, speed: v0 };
            let to = Endpoint {
                time: SubTicks::of_ticks(101_000),
                position: Steps::from_num((v0 + v1) * 50_000.0),
                speed: v1,
            };
            let mut solver = StepTimeSolver::new(&from, &to, Steps::from_num(-0.01), true, None);
            let mut ticks = [0; 4];
            solver.fill(&mut ticks[..1]);
            assert_eq!((ticks[0], solver.is_dense), (1000, true), "{v0} to {v1}");
            solver.fill(&mut ticks[1..]);
            assert!(ticks.is_sorted() && ticks[1] > 1000 && ticks[3] < 101_000, "{ticks:?}");
            // Solved alone or with the others, none of them is late.
            let mut all = [0; 4];
            StepTimeSolver::new(&from, &to, Steps::from_num(-0.01), true, None).fill(&mut all);
            assert_eq!(all, ticks, "{v0} to {v1}");
            if v0 == v1 {
                assert_eq!(ticks, [1000, 1990, 2990, 3990]);
            }
        }
    }

    #[test]
    fn where_steps_are_dense_it_says_so() {
        for (speed, is_dense) in [(0.04, false), (0.0526, false), (0.0527, true), (0.2, true)] {
            for slow in [speed, speed / 2.0] {
                let to = Endpoint {
                    time: SubTicks::of_ticks(100_000),
                    position: Steps::from_num((slow + speed) * 50_000.0),
                    speed: speed as f32,
                };
                let from = Endpoint { time: SubTicks::ZERO, position: Steps::ZERO, speed: slow as f32 };
                assert_eq!(
                    StepTimeSolver::new(&from, &to, Steps::ZERO, true, None).is_dense,
                    is_dense,
                    "{slow} to {speed}"
                );
            }
        }
    }
}
