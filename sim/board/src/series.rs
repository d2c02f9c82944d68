//! Series: a quantity over time in bounded memory.
//!
//! Bins begin short; when there are too many, every two become one. A print of seconds is thus drawn in
//! milliseconds, one of a day in minutes, and both look the same size to the report.

use crate::sampler::SAMPLE_TICKS;

/// Most bins that are kept.
const MOST_BINS: usize = 4096;

/// One stretch of time.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Bin {
    /// Length of path in mm.
    pub path: f32,
    /// Greatest speed in mm/s.
    pub peak_speed: f32,
    /// Step events.
    pub events: u32,
}

impl Bin {
    /// The tool goes on by `path` mm at `speed` mm/s.
    pub fn go(&mut self, path: f32, speed: f32) {
        self.path += path;
        self.peak_speed = self.peak_speed.max(speed);
    }

    fn join(self, other: Self) -> Self {
        Self {
            path: self.path + other.path,
            peak_speed: self.peak_speed.max(other.peak_speed),
            events: self.events + other.events,
        }
    }
}

/// Speed and event rate over motion time.
#[derive(Clone, PartialEq, Debug)]
pub struct Series {
    bin_ticks: u64,
    bins: Vec<Bin>,
}

impl Default for Series {
    fn default() -> Self {
        Self { bin_ticks: 20 * SAMPLE_TICKS, bins: Vec::new() }
    }
}

/// A bin that was found last, near which the next one is: a division of ticks a sample would take longer than all else.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Cursor {
    /// The length of the bins then; 0 before the first one.
    bin_ticks: u64,
    begin: u64,
    index: usize,
}

impl Cursor {
    /// The bin of a tick, where bins are so long.
    #[inline]
    fn find(&mut self, tick: u64, bin_ticks: u64) -> usize {
        if self.bin_ticks == bin_ticks && tick >= self.begin && tick - self.begin < 2 * bin_ticks {
            if tick - self.begin >= bin_ticks {
                self.begin += bin_ticks;
                self.index += 1;
            }
        } else {
            let index = tick / bin_ticks;
            *self = Self { bin_ticks, begin: index * bin_ticks, index: index as usize };
        }
        self.index
    }
}

impl Series {
    /// Ticks in a bin.
    #[must_use]
    pub const fn bin_ticks(&self) -> u64 {
        self.bin_ticks
    }

    /// The bins, from tick 0 on.
    #[must_use]
    pub fn bins(&self) -> &[Bin] {
        &self.bins
    }

    /// Adds to the bin at `tick`. The caller keeps a cursor for each of the quantities that it adds in order of time.
    #[inline]
    pub fn add(&mut self, cursor: &mut Cursor, tick: u64, add: impl FnOnce(&mut Bin)) {
        while tick >= MOST_BINS as u64 * self.bin_ticks {
            self.halve();
        }
        let index = cursor.find(tick, self.bin_ticks);
        if index >= self.bins.len() {
            self.bins.resize(index + 1, Bin::default());
        }
        if let Some(bin) = self.bins.get_mut(index) {
            add(bin);
        }
    }

    fn halve(&mut self) {
        self.bins =
            self.bins.chunks(2).map(|pair| pair.iter().copied().reduce(Bin::join).unwrap_or_default()).collect();
        self.bin_ticks *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_fits_and_nothing_is_lost() {
        let (mut series, mut cursor) = (Series::default(), Cursor::default());
        for second in 0..86_400u64 {
            series.add(&mut cursor, second * 10_000_000, |bin| {
                bin.go(1.0, second as f32);
                bin.events += 3;
            });
        }
        assert!(series.bins().len() <= MOST_BINS);
        assert_eq!(series.bins().iter().map(|b| b.events).sum::<u32>(), 3 * 86_400);
        assert_eq!(series.bins().iter().map(|b| b.peak_speed).fold(0.0, f32::max), 86_399.0);
        assert!(series.bin_ticks() * series.bins().len() as u64 > 86_399 * 10_000_000);
    }

    #[test]
    fn a_cursor_finds_the_bin_of_a_division() {
        let mut cursor = Cursor::default();
        // On in small and large steps, back, and with longer bins.
        let ticks = [0, 1, 99, 100, 199, 200, 450, 449, 300, 0, 1_000_000, 1_000_099, 1_000_100, 1_000_299];
        for (bin_ticks, tick) in [100, 200, 100].into_iter().flat_map(|ticks_each| ticks.map(|tick| (ticks_each, tick)))
        {
            assert_eq!(cursor.find(tick, bin_ticks) as u64, tick / bin_ticks, "{tick} in bins of {bin_ticks}");
        }
    }
}
