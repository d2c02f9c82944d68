//! Sampler: the position of every motor, in even steps of time.
//!
//! Speeds and accelerations are differences of positions over time windows, so the sinks that want them
//! need positions on a regular grid. A pause longer than any such window is cut short: every difference in
//! it is zero anyway, and a print may dwell for minutes.

use crate::axis_sums::AxisSums;
use crate::counts::{Counts, count};
use corehbot::kinematics::Mechanism;
use corehbot::motors::{MOTORS, MotorSet};
use corehbot::units::TICKS_PER_SECOND;

/// Samples a second.
pub const SAMPLES_PER_SECOND: u32 = 2000;

/// Ticks between two samples.
pub const SAMPLE_TICKS: u64 = (TICKS_PER_SECOND / SAMPLES_PER_SECOND) as u64;

/// Samples of a pause that are shown; no sink may look back further than this.
pub const LONGEST_WINDOW: usize = 512;

/// Positions at one instant.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Sample {
    /// The instant in motion time; events of the very same tick are included.
    pub tick: u64,
    /// Where the motors stand.
    pub counts: Counts,
    /// x, y, z and e there, in parts of a step as [`AxisSums`] has them.
    pub sums: [i64; 4],
}

/// Counts steps and shows the counts in even steps of time.
#[derive(Clone)]
pub struct Sampler {
    axes: AxisSums,
    now: Sample,
}

impl Sampler {
    /// A sampler of this mechanism's motors, which stand at 0.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        Self { axes: AxisSums::new(mechanism), now: Sample { tick: 0, counts: [0; MOTORS], sums: [0; 4] } }
    }

    /// Where the motors stand now.
    #[must_use]
    pub const fn counts(&self) -> &Counts {
        &self.now.counts
    }

    /// Shows `each` sample before `tick`, then counts the event.
    #[inline]
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet, each: impl FnMut(&Sample)) {
        if tick > self.now.tick {
            self.advance(tick, each);
        }
        count(&mut self.now.counts, steps, forward);
        self.axes.add_event(&mut self.now.sums, steps, forward);
    }

    /// Shows `each` sample before `tick`.
    pub fn advance(&mut self, tick: u64, mut each: impl FnMut(&Sample)) {
        let pause = tick.saturating_sub(self.now.tick) / SAMPLE_TICKS;
        let shown = pause.min(LONGEST_WINDOW as u64);
        for _ in 0..shown {
            each(&self.now);
            self.now.tick += SAMPLE_TICKS;
        }
        self.now.tick += (pause - shown) * SAMPLE_TICKS;
        while self.now.tick < tick {
            each(&self.now);
            self.now.tick += SAMPLE_TICKS;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype;

    #[test]
    fn samples_are_evenly_spaced_and_hold_what_happened_before() {
        let mut sampler = Sampler::new(&Mechanism::corehbot());
        let mut seen = Vec::new();
        for i in 1..=10 {
            let show = |s: &Sample| seen.push((s.tick, s.counts[6], s.sums));
            sampler.event(i * 2000, MotorSet::of(prototype::E0), prototype::E, show);
        }
        let sums = |counts: &Counts| AxisSums::new(&Mechanism::corehbot()).at(counts);
        let expected = [(0, 0), (5000, 2), (10_000, 5), (15_000, 7)];
        assert_eq!(seen, expected.map(|(tick, e)| (tick, e, sums(&[0, 0, 0, 0, 0, 0, e, 0]))));
        assert_eq!(sampler.counts()[6], 10);
    }

    #[test]
    fn a_long_pause_is_cut_short_but_time_is_kept() {
        let mut sampler = Sampler::new(&Mechanism::corehbot());
        let mut shown = 0;
        sampler.advance(3_600 * u64::from(TICKS_PER_SECOND) + 1, |_| shown += 1);
        assert!(shown <= LONGEST_WINDOW + 1);
        let mut last = 0;
        sampler.advance(3_601 * u64::from(TICKS_PER_SECOND), |s| last = s.tick);
        assert!(last % SAMPLE_TICKS == 0 && last > 3_600 * u64::from(TICKS_PER_SECOND));
    }
}
