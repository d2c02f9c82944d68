//! Sampler: the position of every motor, in even steps of time.
//!
//! Speeds and accelerations are differences of positions over time windows, so the sinks that want them
//! need positions on a regular grid. A pause longer than any such window is cut short: every difference in
//! it is zero anyway, and a print may dwell for minutes.

use corehbot::motors::{MOTORS, MotorSet};
use corehbot::units::TICKS_PER_SECOND;

/// Samples a second.
pub const SAMPLES_PER_SECOND: u32 = 2000;

/// Ticks between two samples.
pub const SAMPLE_TICKS: u64 = (TICKS_PER_SECOND / SAMPLES_PER_SECOND) as u64;

/// Samples of a pause that are shown; no sink may look back further than this.
pub const LONGEST_WINDOW: usize = 512;

/// Steps of each motor since the start, in the order of [`Motor::ALL`](corehbot::motors::Motor::ALL).
pub type Counts = [i64; MOTORS];

/// Motors whose steps are looked up together.
pub(crate) const HALF: usize = MOTORS / 2;

/// Steps of four motors, by the motors that step (low four bits) and those that would go forward (high four bits).
pub(crate) const STEPS: [[i64; HALF]; 1 << MOTORS] = {
    let mut table = [[0; HALF]; 1 << MOTORS];
    let mut index = 0;
    while index < table.len() {
        let mut motor = 0;
        while motor < HALF {
            if index >> motor & 1 != 0 {
                table[index][motor] = if index >> (HALF + motor) & 1 != 0 { 1 } else { -1 };
            }
            motor += 1;
        }
        index += 1;
    }
    table
};

/// The places of an event's lower and upper motors in [`STEPS`].
#[inline]
pub(crate) fn places(steps: MotorSet, forward: MotorSet) -> [usize; 2] {
    let (s, f) = (usize::from(steps.0), usize::from(forward.0));
    [s & 0xF | (f & 0xF) << HALF, s >> HALF | f & 0xF0]
}

/// Adds an event to the counts: looked up, because this runs several times an event.
#[inline]
pub fn count(counts: &mut Counts, steps: MotorSet, forward: MotorSet) {
    let (low, high) = counts.split_at_mut(HALF);
    for (counts, place) in [low, high].into_iter().zip(places(steps, forward)) {
        for (count, step) in counts.iter_mut().zip(&STEPS[place]) {
            *count += step;
        }
    }
}

/// Positions at one instant.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Sample {
    /// The instant in motion time; events of the very same tick are included.
    pub tick: u64,
    /// Where the motors stand.
    pub counts: Counts,
}

/// Counts steps and shows the counts in even steps of time.
#[derive(Clone, Debug)]
pub struct Sampler {
    now: Sample,
}

impl Default for Sampler {
    fn default() -> Self {
        Self { now: Sample { tick: 0, counts: [0; MOTORS] } }
    }
}

impl Sampler {
    /// Where the motors stand now.
    #[must_use]
    pub const fn counts(&self) -> &Counts {
        &self.now.counts
    }

    /// Shows `each` sample before `tick`, then counts the event.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet, each: impl FnMut(&Sample)) {
        if tick > self.now.tick {
            self.advance(tick, each);
        }
        count(&mut self.now.counts, steps, forward);
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
        let mut sampler = Sampler::default();
        let mut seen = Vec::new();
        for i in 1..=10 {
            sampler.event(i * 2000, MotorSet::of(prototype::E0), prototype::E, |s| seen.push((s.tick, s.counts[6])));
        }
        assert_eq!(seen, [(0, 0), (5000, 2), (10_000, 5), (15_000, 7)]);
        assert_eq!(sampler.counts()[6], 10);
    }

    #[test]
    fn every_set_of_motors_is_counted() {
        for (steps, forward) in (0..=u8::MAX).flat_map(|steps| (0..=u8::MAX).map(move |forward| (steps, forward))) {
            let mut counts = [7; MOTORS];
            count(&mut counts, MotorSet(steps), MotorSet(forward));
            for (motor, count) in corehbot::motors::Motor::ALL.into_iter().zip(counts) {
                let way = if MotorSet(forward).has(motor) { 1 } else { -1 };
                assert_eq!(count, if MotorSet(steps).has(motor) { 7 + way } else { 7 });
            }
        }
    }

    #[test]
    fn a_long_pause_is_cut_short_but_time_is_kept() {
        let mut sampler = Sampler::default();
        let mut shown = 0;
        sampler.advance(3_600 * u64::from(TICKS_PER_SECOND) + 1, |_| shown += 1);
        assert!(shown <= LONGEST_WINDOW + 1);
        let mut last = 0;
        sampler.advance(3_601 * u64::from(TICKS_PER_SECOND), |s| last = s.tick);
        assert!(last % SAMPLE_TICKS == 0 && last > 3_600 * u64::from(TICKS_PER_SECOND));
    }
}
