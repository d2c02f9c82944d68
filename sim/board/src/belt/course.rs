//! Course: torque shares and residual over motion time, in bounded memory, for the report.

use super::layout::MOST_MOTORS;
use corehbot::units::TICKS_PER_SECOND;

/// Most bins that are kept; of more, every two become one.
const MOST_BINS: usize = 2048;

/// The first length of a bin, in ticks: 10 ms, as in the report's other curves.
const FIRST_BIN: u64 = 100_000;

/// A stretch of motion time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CourseBin {
    /// The greatest torque share of each motor, of 1.
    pub shares: [f32; MOST_MOTORS],
    /// The greatest residual, in mm, without its sign.
    pub residual_mm: f32,
}

impl CourseBin {
    fn join(mut self, other: Self) -> Self {
        for (share, more) in self.shares.iter_mut().zip(other.shares) {
            *share = share.max(more);
        }
        Self { residual_mm: self.residual_mm.max(other.residual_mm), ..self }
    }
}

/// Bins from the beginning of motion on.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    bin_ticks: u64,
    bins: Vec<CourseBin>,
}

impl Default for Course {
    fn default() -> Self {
        Self { bin_ticks: FIRST_BIN, bins: Vec::new() }
    }
}

impl Course {
    /// Length of a bin, in s.
    #[must_use]
    pub fn bin_s(&self) -> f64 {
        self.bin_ticks as f64 / f64::from(TICKS_PER_SECOND)
    }

    /// The bins.
    #[must_use]
    pub fn bins(&self) -> &[CourseBin] {
        &self.bins
    }

    /// Adds the values at a motion time in ticks.
    pub(super) fn add(&mut self, motion: u64, seen: CourseBin) {
        while motion / self.bin_ticks >= MOST_BINS as u64 {
            let pairs =
                self.bins.chunks(2).map(|pair| pair.iter().copied().fold(CourseBin::default(), CourseBin::join));
            self.bins = pairs.collect();
            self.bin_ticks *= 2;
        }
        let index = (motion / self.bin_ticks) as usize;
        if index >= self.bins.len() {
            // At rest, each motor's share was the one that it has when the rest ends.
            self.bins.resize(index + 1, seen);
        }
        if let Some(bin) = self.bins.get_mut(index) {
            *bin = bin.join(seen);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rest_is_as_it_ends_and_peaks_stay() {
        let mut course = Course::default();
        let seen = |share, residual_mm| CourseBin { shares: [share; MOST_MOTORS], residual_mm };
        for (motion, seen) in
            [(0, seen(0.9, 0.0)), (3 * FIRST_BIN, seen(0.1, 0.6)), (3 * FIRST_BIN + 1, seen(0.2, 0.5))]
        {
            course.add(motion, seen);
        }
        assert_eq!(course.bins(), [seen(0.9, 0.0), seen(0.1, 0.6), seen(0.1, 0.6), seen(0.2, 0.6)]);
    }

    #[test]
    fn an_hour_fits() {
        let mut course = Course::default();
        for second in 0..3600_u64 {
            let share = if second == 1234 { 0.9 } else { 0.2 };
            let seen =
                CourseBin { shares: [share, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], residual_mm: second as f32 / 1e4 };
            course.add(second * u64::from(TICKS_PER_SECOND), seen);
        }
        assert!(course.bins().len() <= MOST_BINS && course.bin_s() * course.bins().len() as f64 > 3599.0);
        // A bin was shorter than a second then, so the previous one may have been filled, too.
        assert!((1..=2).contains(&course.bins().iter().filter(|bin| bin.shares[0] == 0.9).count()));
        assert_eq!(course.bins()[(1234.0 / course.bin_s()) as usize].shares[..4], [0.9, 0.1, 0.0, 0.0]);
        assert!((course.bins().iter().map(|b| b.residual_mm).fold(0.0, f32::max) - 0.3599).abs() < 1e-6);
    }
}
