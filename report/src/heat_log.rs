//! HeatLog: temperatures and duties over the time of a print, in bounded memory.
//!
//! A bin keeps the least, the greatest and the mean of each quantity. Bins begin as short as a control period.
//! When there are too many, every two become one. A peak of one period is still there after a day.

use corehbot::connectors::{FANS, HEATERS};
use corehbot::thermal::PERIOD_MS;
use corehbot::units::{Celsius, TICKS_PER_MS};
use corehbot_sim::world::{HeatPeriod, HeaterPeriod};

/// Most bins that are kept: a screen has fewer columns.
const MOST_BINS: usize = 2048;

/// The range of a quantity during a bin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Range {
    /// The least.
    pub low: f32,
    /// The greatest.
    pub high: f32,
    sum: f64,
    count: u32,
}

impl Range {
    /// Nothing was measured.
    const NONE: Self = Self { low: f32::INFINITY, high: f32::NEG_INFINITY, sum: 0.0, count: 0 };

    const fn of(value: f32) -> Self {
        Self { low: value, high: value, sum: value as f64, count: 1 }
    }

    fn join(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            sum: self.sum + other.sum,
            count: self.count + other.count,
        }
    }

    /// The mean, if anything was measured.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / f64::from(self.count))
    }
}

/// A heater during a bin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HeaterBin {
    /// Measured temperature in C.
    pub measured: Range,
    /// Target in C; 0 is off.
    pub target: Range,
    /// Duty in percent.
    pub duty: Range,
}

impl HeaterBin {
    fn of(period: &HeaterPeriod) -> Self {
        let celsius = |value: Celsius| Range::of(value.to_num());
        Self {
            measured: period.measured.map_or(Range::NONE, celsius),
            target: celsius(period.target),
            duty: Range::of(percent(period.duty)),
        }
    }

    fn join(self, other: Self) -> Self {
        Self {
            measured: self.measured.join(other.measured),
            target: self.target.join(other.target),
            duty: self.duty.join(other.duty),
        }
    }
}

/// Heaters and fans during a bin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HeatBin {
    /// Motion time at its end, in ticks.
    pub tick: u64,
    /// The fitted heaters.
    pub heaters: [Option<HeaterBin>; HEATERS],
    /// Duty of each fan in percent.
    pub fans: [Range; FANS],
}

impl HeatBin {
    fn join(self, other: Self) -> Self {
        let heaters = std::array::from_fn(|i| match (self.heaters[i], other.heaters[i]) {
            (Some(a), Some(b)) => Some(a.join(b)),
            (a, b) => a.or(b),
        });
        let fans = std::array::from_fn(|i| self.fans[i].join(other.fans[i]));
        Self { tick: self.tick.max(other.tick), heaters, fans }
    }
}

impl From<&HeatPeriod> for HeatBin {
    fn from(period: &HeatPeriod) -> Self {
        let heaters = period.heaters.map(|heater| heater.as_ref().map(HeaterBin::of));
        Self { tick: period.tick, heaters, fans: period.fans.map(|duty| Range::of(percent(duty))) }
    }
}

fn percent(duty: u16) -> f32 {
    f32::from(duty) * (100.0 / 65_535.0)
}

/// The heat of a print.
#[derive(Clone, PartialEq, Debug)]
pub struct HeatLog {
    /// Control periods in a bin.
    periods: usize,
    /// Control periods in the last bin.
    filled: usize,
    bins: Vec<HeatBin>,
    end: u64,
}

impl Default for HeatLog {
    fn default() -> Self {
        Self { periods: 1, filled: 0, bins: Vec::new(), end: 0 }
    }
}

impl HeatLog {
    /// Ticks in a bin.
    #[must_use]
    pub const fn bin_ticks(&self) -> u64 {
        self.periods as u64 * PERIOD_MS as u64 * TICKS_PER_MS as u64
    }

    /// The bins from the start on; `None` on a machine without heaters.
    #[must_use]
    pub fn bins(&self) -> &[HeatBin] {
        &self.bins
    }

    /// When the last period was over, in ticks.
    #[must_use]
    pub const fn end(&self) -> u64 {
        self.end
    }

    /// Adds a control period.
    pub fn add(&mut self, period: &HeatPeriod) {
        self.end = period.now;
        let bin = HeatBin::from(period);
        match self.bins.last_mut() {
            Some(last) if self.filled < self.periods => *last = last.join(bin),
            _ => {
                if self.bins.len() == MOST_BINS {
                    self.bins = self.bins.chunks_exact(2).map(|pair| pair[0].join(pair[1])).collect();
                    self.periods *= 2;
                }
                self.bins.push(bin);
                self.filled = 0;
            }
        }
        self.filled += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::units::TICKS_PER_SECOND;

    #[test]
    fn a_day_fits_and_a_peak_of_one_period_is_kept() {
        let mut log = HeatLog::default();
        let periods = 86_400 * 50u64;
        for i in 1..=periods {
            let is_peak = i == 2_000_001;
            let heater = HeaterPeriod {
                measured: Some(Celsius::from_num(if is_peak { 290 } else { 200 })),
                target: Celsius::from_num(200),
                duty: if is_peak { 0 } else { 65_535 },
            };
            let now = i * u64::from(PERIOD_MS * TICKS_PER_MS);
            log.add(&HeatPeriod { now, tick: now / 2, heaters: [Some(heater), None, None], fans: [0; FANS] });
        }
        let bins = log.bins();
        assert!((MOST_BINS / 2..=MOST_BINS).contains(&bins.len()), "{}", bins.len());
        assert_eq!(log.end(), 86_400 * u64::from(TICKS_PER_SECOND));
        assert!(bins.len() as u64 * log.bin_ticks() >= log.end());
        let hotend: Vec<_> = bins.iter().map(|bin| bin.heaters[0].unwrap()).collect();
        let peaks: Vec<_> = hotend.iter().enumerate().filter(|(_, bin)| bin.measured.high == 290.0).collect();
        let [(place, peak)] = peaks[..] else { panic!("{peaks:?}") };
        assert_eq!(place as u64, 2_000_000 * u64::from(PERIOD_MS * TICKS_PER_MS) / log.bin_ticks());
        assert_eq!((peak.measured.low, peak.duty.low, peak.duty.high), (200.0, 0.0, 100.0));
        let counted: u32 = hotend.iter().map(|bin| bin.duty.count).sum();
        assert_eq!(u64::from(counted), periods);
        let mean = hotend[0].duty.mean().unwrap();
        assert!((mean - 100.0).abs() < 1e-4, "{mean}");
    }
}
