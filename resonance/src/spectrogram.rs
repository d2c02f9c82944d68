//! Spectrogram: power over time and frequency, to see at which moment of a sweep what rings.
//!
//! Windows are those of the [spectrum](crate::spectrum). Levels are coarse, since they are only looked at: 64 over
//! 50 dB, each a digit of base64 (RFC 4648), with a line of digits for each time.

use crate::recording::Recording;
use crate::spectrum::{WINDOW_S, each_window, kaiser, size};
use serde::Serialize;

/// Digits of the levels, from the least to the greatest.
const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// From the least level to the greatest one; below is what sensors add by themselves.
const RANGE_DB: f64 = 50.0;

/// Most times: a row of pixels each.
const MOST_TIMES: usize = 200;

/// Power of all axes together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spectrogram {
    /// Distance of the times; the first is half a window.
    pub step_s: f64,
    /// The first time.
    pub first_s: f64,
    /// Distance of the frequencies; the first is 0.
    #[serde(rename = "step_Hz")]
    pub step_hz: f64,
    /// From the least level to the greatest one.
    #[serde(rename = "range_dB")]
    pub range_db: f64,
    /// A line for each time, a digit for each frequency.
    pub levels: Vec<String>,
}

impl Spectrogram {
    /// Up to a frequency.
    #[must_use]
    pub fn new(recording: &Recording, most_hz: f64) -> Self {
        let rate = recording.rate_hz;
        let window = kaiser(size(rate, WINDOW_S));
        let long = window.len();
        let samples = recording.axes[0].len();
        let step = (long / 2).max(samples.saturating_sub(long).div_ceil(MOST_TIMES));
        let step_hz = rate / long as f64;
        let count = ((most_hz / step_hz) as usize + 1).min(long / 2 + 1);
        let mut powers: Vec<Vec<f64>> = Vec::new();
        for axis in &recording.axes {
            each_window(axis, &window, step, |number, transformed| {
                if powers.len() <= number {
                    powers.push(vec![0.0; count]);
                }
                for (sum, value) in powers.iter_mut().skip(number).take(1).flatten().zip(transformed) {
                    *sum += value.norm_sqr();
                }
            });
        }
        let most = powers.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
        let digit = |power: &f64| {
            let db = 10.0 * (power / most).max(f64::MIN_POSITIVE).log10();
            let level = ((1.0 + db / RANGE_DB) * 63.0).clamp(0.0, 63.0);
            char::from(DIGITS.get(level as usize).copied().unwrap_or(b'A'))
        };
        let levels = powers.iter().map(|line| line.iter().map(digit).collect()).collect();
        let first_s = long as f64 / 2.0 / rate;
        Self { step_s: step as f64 / rate, first_s, step_hz, range_db: RANGE_DB, levels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A sweep of 10 Hz a second is at its frequency at each time.
    #[test]
    fn a_sweep_is_a_slope() {
        let at = |i: usize| i as f64 / 1600.0;
        let sweep: Vec<f64> = (0..16_000).map(|i| (TAU * (20.0 + 5.0 * at(i)) * at(i)).sin()).collect();
        let still = vec![0.0; sweep.len()];
        let seen = Spectrogram::new(
            &Recording { rate_hz: 1600.0, axes: [sweep, still.clone(), still], remarks: Vec::new() },
            200.0,
        );
        assert!(seen.levels.len() > 20 && seen.levels.iter().all(|line| line.len() == seen.levels[0].len()));
        for (i, line) in seen.levels.iter().enumerate() {
            let level = |byte: u8| DIGITS.iter().position(|digit| *digit == byte).unwrap();
            let top = (0..line.len()).max_by_key(|k| level(line.as_bytes()[*k])).unwrap();
            let hz = 20.0 + 10.0 * (seen.first_s + seen.step_s * i as f64);
            assert!((top as f64 * seen.step_hz - hz).abs() <= 3.0 * seen.step_hz, "{i}: {top} for {hz} Hz");
        }
    }
}
