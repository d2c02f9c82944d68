//! Spectrum: power spectral density by Welch's method, with Klipper's window and length.
//!
//! Klipper, `shaper_calibrate.py`: windows of half a second, rounded up to a power of two, Kaiser with beta 6, half
//! overlapped, the mean removed from each. Kaiser: J. F. Kaiser, "Nonrecursive digital filter design using the
//! I0-sinh window function", 1974.

use crate::label::Axis;
use crate::recording::Recording;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use serde::Serialize;

/// Klipper's window in s.
pub const WINDOW_S: f64 = 0.5;

/// Kaiser's beta.
const BETA: f64 = 6.0;

/// Lowest frequency of a sweep in Hz, for [`Spectrum::normalised`].
const LEAST_HZ: f64 = 5.0;

/// Power spectral density of three axes and their sum, in (mm/s^2)^2/Hz.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spectrum {
    /// Distance of the frequencies; the first is 0.
    #[serde(rename = "step_Hz")]
    pub step_hz: f64,
    /// Along x, y and z.
    #[serde(rename = "xyz_mm2_s4_Hz")]
    pub axes: [Vec<f64>; 3],
    /// All together.
    #[serde(rename = "sum_mm2_s4_Hz")]
    pub sum: Vec<f64>,
}

/// A spectrum that was stored instead of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// Its values. Where a file has sums alone, the axes are empty.
    pub spectrum: Spectrum,
    /// Whether it is over frequency already, as [`Spectrum::normalised`] makes it.
    pub is_normalised: bool,
}

impl Density {
    /// The sum as Klipper chooses shapers by it.
    #[must_use]
    pub fn normalised(&self) -> Vec<f64> {
        if self.is_normalised { self.spectrum.sum.clone() } else { self.spectrum.normalised() }
    }

    /// The density along an axis, or of all where the file has no axes.
    pub(crate) fn along(&self, axis: Option<Axis>) -> Vec<f64> {
        let [x, y, z] = &self.spectrum.axes;
        let own = match axis {
            Some(Axis::X) => x.clone(),
            Some(Axis::Y) => y.clone(),
            Some(Axis::Z) => z.clone(),
            Some(Axis::A | Axis::B) => x.iter().zip(y).map(|(x, y)| x + y).collect(),
            None => Vec::new(),
        };
        let own = if own.is_empty() { self.spectrum.sum.clone() } else { own };
        let raw = |(i, psd): (usize, f64)| {
            if self.is_normalised { psd / normalising(i as f64 * self.spectrum.step_hz) } else { psd }
        };
        own.into_iter().enumerate().map(raw).collect()
    }
}

/// What a density is multiplied by at a frequency: a sweep has an acceleration in proportion to it, and below 10 Hz
/// less counts.
fn normalising(hz: f64) -> f64 {
    let shifted = hz + 0.1;
    let low = if hz < 2.0 * LEAST_HZ { (1.0 - (2.0 * LEAST_HZ / shifted).powi(2)).exp() } else { 1.0 };
    low / shifted
}

impl Spectrum {
    /// With windows of about this length; nothing if the recording is shorter than one.
    #[must_use]
    pub fn new(recording: &Recording, window_s: f64) -> Option<Self> {
        let size = size(recording.rate_hz, window_s);
        if recording.axes[0].len() <= size {
            return None;
        }
        let axes = recording.axes.each_ref().map(|axis| welch(axis, recording.rate_hz, size));
        let sum = axes[0].iter().zip(&axes[1]).zip(&axes[2]).map(|((x, y), z)| x + y + z).collect();
        Some(Self { step_hz: recording.rate_hz / size as f64, axes, sum })
    }

    /// The sum as Klipper chooses shapers by it: over frequency, for a sweep has an acceleration in proportion to it,
    /// and with less below 10 Hz.
    #[must_use]
    pub fn normalised(&self) -> Vec<f64> {
        let value = |(i, psd): (usize, &f64)| psd * normalising(i as f64 * self.step_hz);
        self.sum.iter().enumerate().map(value).collect()
    }

    /// The sum at a frequency, between two of its own on a straight line.
    #[must_use]
    pub fn at(&self, hz: f64) -> f64 {
        between(&self.sum, hz / self.step_hz)
    }
}

/// A curve at a place between two of its points.
fn between(curve: &[f64], place: f64) -> f64 {
    let (below, part) = (place.floor().max(0.0) as usize, place.fract());
    let Some(from) = curve.get(below) else { return 0.0 };
    curve.get(below + 1).map_or(*from, |to| from + (to - from) * part)
}

/// The power of two that is at least as long as this.
pub(crate) fn size(rate_hz: f64, window_s: f64) -> usize {
    ((rate_hz * window_s) as usize).max(2).next_power_of_two()
}

/// Power spectral density with windows of `size` samples: one value each `rate / size` Hz.
fn welch(samples: &[f64], rate_hz: f64, size: usize) -> Vec<f64> {
    let window = kaiser(size);
    let scale = 1.0 / (rate_hz * window.iter().map(|w| w * w).sum::<f64>());
    let mut psd = vec![0.0; size / 2 + 1];
    let mut count = 0.0_f64;
    each_window(samples, &window, size / 2, |_, transformed| {
        for (sum, value) in psd.iter_mut().zip(transformed) {
            *sum += value.norm_sqr();
        }
        count += 1.0;
    });
    // One-sided: twice everything that has a negative frequency too.
    let last = psd.len() - 1;
    for (i, value) in psd.iter_mut().enumerate() {
        let sides = if i == 0 || i == last { 1.0 } else { 2.0 };
        *value *= sides * scale / count.max(1.0);
    }
    psd
}

/// Gives the number and the transform of each window, every `step` samples, with its mean removed.
pub(crate) fn each_window(samples: &[f64], window: &[f64], step: usize, mut each: impl FnMut(usize, &[Complex<f64>])) {
    let size = window.len();
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let mut scratch = transform.make_scratch_vec();
    for (number, begin) in (0..=samples.len().saturating_sub(size)).step_by(step.max(1)).enumerate() {
        let Some(part) = samples.get(begin..begin + size) else { break };
        let mean = part.iter().sum::<f64>() / size as f64;
        for ((to, from), weight) in input.iter_mut().zip(part).zip(window) {
            *to = (from - mean) * weight;
        }
        // The buffers are of the plan's own lengths, so it cannot fail.
        if transform.process_with_scratch(&mut input, &mut output, &mut scratch).is_err() {
            break;
        }
        each(number, &output);
    }
}

/// Kaiser's window.
pub(crate) fn kaiser(size: usize) -> Vec<f64> {
    let top = bessel(BETA);
    let one = |i: usize| {
        let x = 2.0 * i as f64 / (size - 1) as f64 - 1.0;
        bessel(BETA * (1.0 - x * x).max(0.0).sqrt()) / top
    };
    (0..size).map(one).collect()
}

/// The modified Bessel function of order 0, by its series (Abramowitz and Stegun, 9.6.12).
fn bessel(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    while term > 1e-17 * sum {
        term *= quarter / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn recording(rate_hz: f64, seconds: f64, of: impl Fn(f64) -> f64) -> Recording {
        let samples: Vec<f64> = (0..(rate_hz * seconds) as usize).map(|i| of(i as f64 / rate_hz)).collect();
        let still = vec![9806.65; samples.len()];
        Recording { rate_hz, axes: [samples, still.clone(), still], remarks: Vec::new() }
    }

    /// By the integral of Bessel's function (Abramowitz and Stegun, 9.6.16), in 2000 steps.
    #[test]
    fn the_window_is_kaisers() {
        let known = [0.014_873_34, 0.482_955_61, 1.0, 0.482_955_61, 0.014_873_34];
        assert!(kaiser(5).iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-8), "{:?}", kaiser(5));
    }

    #[test]
    fn the_integral_of_the_density_is_the_mean_square() {
        let tone = recording(3200.0, 8.0, |t| 100.0 * (TAU * 61.3 * t).sin());
        let spectrum = Spectrum::new(&tone, WINDOW_S).unwrap();
        assert_eq!((spectrum.sum.len(), spectrum.step_hz), (1025, 1.5625));
        let power: f64 = spectrum.sum.iter().sum::<f64>() * spectrum.step_hz;
        assert!((power / 5000.0 - 1.0).abs() < 0.01, "{power}");
        let top = (0..1025).max_by(|a, b| spectrum.sum[*a].total_cmp(&spectrum.sum[*b])).unwrap();
        assert_eq!(top, 39, "61.3 Hz is nearest to 39 times 1.5625 Hz");
    }

    #[test]
    fn lengths_are_klippers_at_usual_rates() {
        assert_eq!([3200.0, 1344.0, 1600.0, 3205.7].map(|rate| size(rate, WINDOW_S)), [2048, 1024, 1024, 2048]);
    }
}
