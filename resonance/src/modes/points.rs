//! Points: recordings and spectra to bands of frequencies, each with its commanded and measured power.
//!
//! A recording is transformed whole. Then the measured power of a band is the commanded power of its lines times |H|^2,
//! however sharp a mode is, and no window widens it. A file with a spectrum has windows: there each line of the command
//! adds to its neighbours by the power of Kaiser's window.
//!
//! Only the motion along the swept axis counts: a mode across it would move the frequencies.

use super::knots::at_bins;
use super::model::{Data, Line, Point};
use super::search::fitted;
use super::{Modes, Unfitted};
use crate::gcode::direction;
use crate::label::Axis;
use crate::recording::Recording;
use crate::spectrum::{Density, Spectrum, WINDOW_S, kaiser};
use crate::sweep::Sweep;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// Width of a band as a part of its frequency, and lines in it.
const BAND: f64 = 0.012;
const LINES: usize = 4;

/// Fewest bins of the transform in a band.
const FEWEST_BINS: usize = 3;

/// Fewest bands.
const FEWEST: usize = 20;

/// A point counts by this much at least.
const LEAST_WEIGHT: f64 = 0.05;

/// Up to this factor over the first frequency the tool still follows its command: this tells its direction.
const SLOW: f64 = 2.5;

/// The named axis must have this part of the slow motion.
const ALONG: f64 = 0.3;

/// Lines to a bin of a spectrum, and bins to each side that a window reaches (Kaiser with beta 6 has its first zeros
/// 2.2 bins from the middle).
const FINE: usize = 8;
const REACH: usize = 3;

/// Ends of a fit: near those of the sweep the pulses have other harmonics, and below is the slow swing.
fn ends(sweep: &Sweep) -> [f64; 2] {
    [(1.5 * sweep.from_hz).max(8.0), sweep.to_hz - 3.0]
}

/// The direction in which the tool was shaken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Direction {
    /// The named axis.
    Named([f64; 3]),
    /// The one that moves most: no axis is named, or the sensor does not move along it.
    Strongest([f64; 3], bool),
}

impl Direction {
    pub(crate) const fn unit(self) -> [f64; 3] {
        match self {
            Self::Named(unit) | Self::Strongest(unit, _) => unit,
        }
    }

    /// The direction of a sweep along an axis.
    pub(crate) fn of(recording: &Recording, axis: Option<Axis>, sweep: &Sweep) -> Self {
        let size = recording.axes[0].len().next_power_of_two();
        let transforms = recording.axes.each_ref().map(|axis| transformed(axis, size));
        let step = recording.rate_hz / size as f64;
        let [from, _] = ends(sweep);
        let mut powers = Matrix3::<f64>::zeros();
        for bin in (from / step) as usize..(SLOW * from / step) as usize {
            let at = transforms.each_ref().map(|one| one.get(bin).copied().unwrap_or_default());
            for (i, a) in at.iter().enumerate() {
                for (k, b) in at.iter().enumerate() {
                    powers[(i, k)] += (a * b.conj()).re;
                }
            }
        }
        let named = axis.map(|axis| direction(axis).map_or([0.0, 0.0, 1.0], |[x, y]| [x, y, 0.0]));
        let along = |unit: [f64; 3]| (Vector3::from(unit).transpose() * powers * Vector3::from(unit))[0];
        if let Some(unit) = named.filter(|unit| along(*unit) >= ALONG * powers.trace()) {
            return Self::Named(unit);
        }
        let found = SymmetricEigen::new(powers);
        let (most, _) = found.eigenvalues.argmax();
        let unit = found.eigenvectors.column(most);
        Self::Strongest([unit[0], unit[1], unit[2]], axis.is_some())
    }
}

/// The transform of samples without their mean, with zeros up to a size.
fn transformed(samples: &[f64], size: usize) -> Vec<Complex<f64>> {
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(size.max(2));
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    input.iter_mut().zip(samples).for_each(|(to, from)| *to = from - mean);
    // The buffers are of the plan's own lengths, so it cannot fail.
    let _ = transform.process(&mut input, &mut output);
    output
}

/// Mean of the squares from one bin to another, without the last.
fn mean_power(bins: &[Complex<f64>], from: usize, to: usize) -> f64 {
    let part = bins.get(from..to.min(bins.len())).unwrap_or_default();
    part.iter().map(Complex::norm_sqr).sum::<f64>() / part.len().max(1) as f64
}

/// What the mean over a sample leaves of a power: the command is known as means, and a sensor tells single values.
fn of_mean(hz: f64, rate_hz: f64) -> f64 {
    let angle = std::f64::consts::PI * hz / rate_hz;
    if angle > 0.0 { (angle.sin() / angle).powi(2) } else { 1.0 }
}

/// Bands of a recording along a direction.
pub(super) fn of_recording(recording: &Recording, sweep: &Sweep, direction: [f64; 3]) -> Option<Data> {
    let [x, y, z] = &recording.axes;
    let [a, b, c] = direction;
    let along: Vec<f64> = x.iter().zip(y).zip(z).map(|((x, y), z)| a * x + b * y + c * z).collect();
    let command = sweep.recording(recording.rate_hz);
    let size = along.len().max(command.axes[0].len()).next_power_of_two();
    let (measured, commanded) = (transformed(&along, size), transformed(&command.axes[0], size));
    let step = recording.rate_hz / size as f64;
    // A recording that is much shorter than its transform has fewer frequencies than bins.
    let fewest = FEWEST_BINS * size / along.len().max(1);
    let ([mut from, to], mut points) = (ends(sweep), Vec::new());
    while from < to {
        let first = (from / step).round() as usize;
        let next = ((from * (1.0 + BAND) / step).round() as usize).max(first + fewest);
        let edge = |i: usize| first + (next - first) * i / LINES;
        let line = |i: usize| {
            let (begin, end) = (edge(i), edge(i + 1));
            let hz = ((begin + end) as f64 - 1.0) / 2.0 * step;
            let power = mean_power(&commanded, begin, end) / of_mean(hz, recording.rate_hz);
            Line { hz, power: power * (end - begin) as f64 / (next - first) as f64 }
        };
        let lines: Vec<Line> = (0..LINES).map(line).filter(|line| line.power > 0.0).collect();
        let hz = ((first + next) as f64 - 1.0) / 2.0 * step;
        points.push((hz, lines, mean_power(&measured, first, next)));
        from = next as f64 * step;
    }
    let noise = noise(&Recording { axes: [along, Vec::new(), Vec::new()], ..recording.clone() });
    // A density has twice the power of a bin, by the rate and the number of samples.
    Some(data(points, noise * recording.rate_hz * recording.axes[0].len() as f64 / 2.0)).filter(is_enough)
}

/// Density of the sensor's noise. Far above the sweep there is noise, and little else: a tenth is quieter than
/// harmonics.
fn noise(recording: &Recording) -> f64 {
    let Some(spectrum) = Spectrum::new(recording, WINDOW_S) else { return 0.0 };
    let (density, half) = (&spectrum.axes[0], recording.rate_hz / 2.0);
    let above = |i: &usize| (0.5 * half..0.95 * half).contains(&(*i as f64 * spectrum.step_hz));
    let mut quiet: Vec<f64> = (0..density.len()).filter(above).filter_map(|i| density.get(i).copied()).collect();
    quiet.sort_by(f64::total_cmp);
    quiet.get(quiet.len() / 10).copied().unwrap_or(0.0)
}

/// Noises that are tried, as parts of the least power of a file, and the one that weighs its points.
pub(super) const NOISES: [f64; 4] = [0.0, 0.5, 0.8, 0.95];
const WEIGHED: f64 = 0.5;

/// Bins of a spectrum that was computed with windows.
pub(super) fn of_density(density: &Density, sweep: &Sweep, axis: Option<Axis>, noise: f64) -> Option<Data> {
    let found = at_bins(density);
    let density = found.as_ref().unwrap_or(density);
    let (spectrum, step) = (&density.spectrum, density.spectrum.step_hz);
    let window = kaiser(1024);
    let rate_hz = step * window.len() as f64;
    let command = sweep.recording(rate_hz);
    let size = command.axes[0].len().next_power_of_two();
    let commanded = transformed(&command.axes[0], size);
    let kernel = kernel(&window);
    let along = density.along(axis);
    let [from, to] = ends(sweep);
    let point = |bin: usize| {
        let (hz, measured) = (bin as f64 * step, along.get(bin).copied().filter(|v| *v > 0.0)?);
        let line = |(i, part): (usize, &f64)| {
            let hz = hz + step * (i as f64 / FINE as f64 - REACH as f64);
            let bins = |hz: f64| (hz.max(0.0) * size as f64 / rate_hz) as usize;
            let half = step / FINE as f64 / 2.0;
            let power = mean_power(&commanded, bins(hz - half), bins(hz + half) + 1) / of_mean(hz, rate_hz);
            Line { hz, power: part * power }
        };
        let lines = kernel.iter().enumerate().map(line).filter(|line| line.hz > 0.0).collect();
        (from..=to).contains(&hz).then_some((hz, lines, measured))
    };
    let points: Vec<(f64, Vec<Line>, f64)> = (0..spectrum.sum.len()).filter_map(point).collect();
    // The file ends far below the frequencies that would tell the noise: it is a part of the least power at most.
    let beyond = along.iter().skip((to / step) as usize).copied().filter(|v| *v > 0.0);
    let least = points.iter().map(|(_, _, measured)| *measured).chain(beyond).fold(f64::INFINITY, f64::min);
    Some(with_weights(points, noise * least, WEIGHED * least)).filter(is_enough)
}

/// Power of a window at even parts of a bin, from `-REACH` to `REACH` bins; the sum is 1.
fn kernel(window: &[f64]) -> Vec<f64> {
    let at = |i: usize| {
        let off = i as f64 / FINE as f64 - REACH as f64;
        let turn = std::f64::consts::TAU * off / window.len() as f64;
        let sum = window.iter().enumerate().map(|(n, w)| Complex::from_polar(*w, turn * n as f64));
        sum.sum::<Complex<f64>>().norm_sqr()
    };
    let all: Vec<f64> = (0..=2 * REACH * FINE).map(at).collect();
    let sum: f64 = all.iter().sum();
    all.into_iter().map(|power| power / sum).collect()
}

fn is_enough(data: &Data) -> bool {
    data.points.len() >= FEWEST
}

/// Points of one source. The search begins at a gain of 1: the strength of the sweep, and the unit of the file, do not
/// count.
fn data(points: Vec<(f64, Vec<Line>, f64)>, noise: f64) -> Data {
    with_weights(points, noise, noise)
}

/// The same with another noise for the weights: fits with several noises are compared by the same ones.
fn with_weights(points: Vec<(f64, Vec<Line>, f64)>, noise: f64, of_weights: f64) -> Data {
    let made = |(hz, lines, power): (f64, Vec<Line>, f64)| {
        let weight = (1.0 - of_weights / power).max(LEAST_WEIGHT);
        let point = Point { hz, lines, measured: power.ln(), source: 0, weight };
        (power > 0.0 && point.commanded() > 0.0).then_some(point)
    };
    let mut points: Vec<Point> = points.into_iter().filter_map(made).collect();
    let noise = noise * (-level(&mut points)).exp();
    Data { points, noise, sources: 0 }
}

/// Takes the mean of measured over commanded away, and returns it.
fn level(points: &mut [Point]) -> f64 {
    let ratio = points.iter().map(|p| p.measured - p.commanded().ln()).sum::<f64>();
    let mean = ratio / points.len().max(1) as f64;
    points.iter_mut().for_each(|p| p.measured -= mean);
    mean
}

/// Modes that so many sources of unknown strength excited: a frequency, the logarithm of the measured power, and the
/// source of each point, by frequency.
pub(crate) fn fit_sources(points: &[(f64, f64, usize)], sources: usize) -> Result<Modes, Unfitted> {
    let made = |(hz, measured, source): &(f64, f64, usize)| Point {
        hz: *hz,
        lines: vec![Line { hz: *hz, power: 1.0 }],
        measured: *measured,
        source: *source,
        weight: 1.0,
    };
    let mut points: Vec<Point> = points.iter().map(made).collect();
    level(&mut points);
    fitted(&Data { points, noise: 0.0, sources })
}
