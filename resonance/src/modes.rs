//! Modes: frequencies and dampings, fitted to the response of the tool to a sweep.
//!
//! The response is measured over commanded density of power, |H|^2. Its logarithm is fitted by a sum of modes
//!
//! ```text
//! H = sum g / (1 - r^2 + 2 i z r),   r = f / f_mode
//! ```
//!
//! with Levenberg's and Marquardt's method (D. Marquardt, 1963). Only magnitudes count: the phase depends on when the
//! sensor's clock sampled. A peak of the density alone would be at the nearest of its frequencies, and its width is the
//! width of the window: a half width gives half of the damping or twice of it.
//!
//! Points of several sources of unknown strength, as the motors of [`crate::motors`] are, get a mean difference of zero
//! each (variable projection: G. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 1973). Their modes add up by power,
//! because those along different axes do.

use crate::recording::Recording;
use crate::spectrum::Spectrum;
use crate::sweep::Sweep;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Windows for the fit in s: twice as fine as Klipper's, or damping is found too high.
const WINDOW_S: f64 = 1.0;

/// Most modes.
const MOST: usize = 3;

/// A further mode must lower the root mean square of the differences by this factor.
const WORTH: f64 = 0.75;

/// Dampings of a mode. Beyond, it is the slope of a foot or a line of the mains.
const DAMPINGS: [f64; 2] = [0.002, 0.6];

/// Two modes closer than this part of their frequency are one.
const APART: f64 = 0.03;

/// Start values of the damping.
const STARTS: [f64; 2] = [0.03, 0.1];

/// A mode with less than this part of the strongest one's peak is left out: it is a bend of the curve.
const LEAST_PEAK: f64 = 0.03;

/// A mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// Its frequency.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Standard error of the frequency by the fit.
    #[serde(rename = "frequency_error_Hz")]
    pub frequency_error_hz: f64,
    /// Damping as a ratio to critical damping.
    pub damping_ratio: f64,
    /// Standard error of the damping by the fit.
    pub damping_ratio_error: f64,
    /// Its part in the slow motion of the tool; all parts add up to 1. A negative part moves against the command.
    pub part: f64,
}

/// Result of a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Modes {
    /// The modes, the strongest peak first.
    pub modes: Vec<Mode>,
    /// Root mean square of the fit's differences, in dB.
    #[serde(rename = "fit_error_dB")]
    pub fit_error_db: f64,
    /// The fitted frequencies.
    #[serde(rename = "frequencies_Hz")]
    pub frequencies_hz: Vec<f64>,
    /// Measured |H| at each.
    pub measured: Vec<f64>,
    /// The fitted one.
    pub fitted: Vec<f64>,
}

/// Why there are no modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfitted {
    /// The recording or the sweep is too short.
    Short,
    /// The response is no higher at any frequency than around it.
    Flat,
}

impl std::fmt::Display for Unfitted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Short => "the recording or the sweep is too short for a fit",
            Self::Flat => "no mode was found: the response has no peak within the sweep",
        })
    }
}

impl std::error::Error for Unfitted {}

/// A frequency of the fit.
#[derive(Clone, Copy)]
pub(crate) struct Point {
    pub hz: f64,
    /// Commanded density.
    pub commanded: f64,
    /// Logarithm of the measured density.
    pub measured: f64,
    /// The source that shakes here, from 0 on.
    pub source: usize,
}

/// The points and the sensor's noise.
struct Data {
    points: Vec<Point>,
    noise: f64,
    /// Sources of unknown strength; 0 if the strength is known.
    sources: usize,
}

impl Data {
    /// Frequencies and dampings no further than the limits: a step that goes far beyond does not come back.
    fn kept_within(&self, mut numbers: Numbers) -> Numbers {
        let [first, last] = self.ends();
        for mode in numbers.as_mut_slice().chunks_exact_mut(3) {
            mode[0] = mode[0].clamp(first.ln(), last.ln());
            mode[1] = mode[1].clamp(DAMPINGS[0].ln(), DAMPINGS[1].ln());
        }
        numbers
    }

    /// First and last frequency; `data` makes no set without points.
    fn ends(&self) -> [f64; 2] {
        let hz = |point: Option<&Point>| point.map_or(1.0, |point| point.hz);
        [hz(self.points.first()), hz(self.points.last())]
    }
}

/// Three numbers a mode: logarithms of frequency and damping, and the gain.
type Numbers = DVector<f64>;

/// Modes of the tool that this sweep excited.
///
/// # Errors
/// Nothing can be fitted.
pub fn fit(recording: &Recording, sweep: &Sweep) -> Result<Modes, Unfitted> {
    fitted(&data(recording, sweep).ok_or(Unfitted::Short)?)
}

/// Modes that so many sources of unknown strength excited.
pub(crate) fn fit_sources(points: Vec<Point>, sources: usize) -> Result<Modes, Unfitted> {
    let mean = points.iter().map(|p| p.measured - p.commanded.ln()).sum::<f64>() / points.len().max(1) as f64;
    let points = points.into_iter().map(|p| Point { measured: p.measured - mean, ..p }).collect();
    let data = Data { points, noise: 0.0, sources };
    let flat = differences(&DVector::zeros(0), &data).norm_squared() / data.points.len().max(1) as f64;
    let modes = fitted(&data)?;
    let decibels = |cost: f64| 10.0 / std::f64::consts::LN_10 * cost.sqrt();
    if modes.fit_error_db < WORTH * decibels(flat) { Ok(modes) } else { Err(Unfitted::Flat) }
}

fn fitted(data: &Data) -> Result<Modes, Unfitted> {
    let mut best: Option<(Numbers, f64)> = None;
    for count in 1..=MOST {
        let Some(next) = with_one_more(data, best.as_ref().map(|(numbers, _)| numbers)) else { break };
        let is_worth = best.as_ref().is_none_or(|(_, before)| next.1 < before * WORTH * WORTH);
        if !is_worth || count > 1 && !(are_apart(&next.0) && is_within(&next.0, data)) {
            break;
        }
        best = Some(next);
    }
    let (numbers, cost) = best.ok_or(Unfitted::Flat)?;
    if !is_within(&numbers, data) {
        return Err(Unfitted::Flat);
    }
    Ok(told(data, &numbers, cost))
}

/// Points between the ends of the sweep: near them the pulses have other harmonics, and below is the slow swing.
fn data(recording: &Recording, sweep: &Sweep) -> Option<Data> {
    let (measured, commanded) = (Spectrum::new(recording, WINDOW_S)?, sweep.recording(recording.rate_hz));
    let commanded = Spectrum::new(&commanded, WINDOW_S)?;
    let (from, to) = ((1.5 * sweep.from_hz).max(8.0), sweep.to_hz - 3.0);
    let step = measured.step_hz;
    let point = |i: usize| {
        let hz = i as f64 * step;
        let psd = measured.sum.get(i).copied().filter(|psd| *psd > 0.0)?;
        (from..=to).contains(&hz).then(|| Point { hz, commanded: commanded.at(hz), measured: psd.ln(), source: 0 })
    };
    let mut points: Vec<Point> = (0..measured.sum.len()).filter_map(point).filter(|p| p.commanded > 0.0).collect();
    // Far above the sweep there is noise, and little else: a tenth is quieter than harmonics.
    let half = recording.rate_hz / 2.0;
    let above = |i: &usize| (0.5 * half..0.95 * half).contains(&(*i as f64 * step));
    let mut quiet: Vec<f64> =
        (0..measured.sum.len()).filter(above).filter_map(|i| measured.sum.get(i).copied()).collect();
    quiet.sort_by(f64::total_cmp);
    let noise = quiet.get(quiet.len() / 10).copied().unwrap_or(0.0);
    // The search begins at a gain of 1: the strength of the sweep, and the unit of the file, do not count.
    let strength = points.iter().map(|p| p.measured - p.commanded.ln()).sum::<f64>() / points.len().max(1) as f64;
    points.iter_mut().for_each(|p| p.measured -= strength);
    (points.len() >= 20).then_some(Data { points, noise: noise * (-strength).exp(), sources: 0 })
}

/// |H|^2. Without modes the tool follows its command.
fn response(numbers: &Numbers, hz: f64, data: &Data) -> f64 {
    if numbers.is_empty() {
        return 1.0;
    }
    let (mut re, mut im, mut powers) = (0.0, 0.0, 0.0);
    for mode in numbers.as_slice().chunks_exact(3) {
        let [frequency, damping, gain] = [mode[0].exp(), mode[1].exp(), mode[2]];
        let r = hz / frequency;
        let (a, b) = (1.0 - r * r, 2.0 * damping * r);
        let power = gain / (a * a + b * b);
        re += power * a;
        im -= power * b;
        powers += gain * power;
    }
    if data.sources == 0 { re * re + im * im } else { powers }
}

fn difference(numbers: &Numbers, point: &Point, data: &Data) -> f64 {
    let power = point.commanded * response(numbers, point.hz, data) + data.noise;
    power.max(f64::MIN_POSITIVE).ln() - point.measured
}

fn differences(numbers: &Numbers, data: &Data) -> DVector<f64> {
    let all = data.points.iter().map(|p| difference(numbers, p, data));
    let mut all = DVector::from_iterator(data.points.len(), all);
    for source in 0..data.sources {
        let own = || data.points.iter().enumerate().filter(move |(_, p)| p.source == source).map(|(i, _)| i);
        let mean = own().map(|i| all[i]).sum::<f64>() / own().count().max(1) as f64;
        own().for_each(|i| all[i] -= mean);
    }
    all
}

/// Derivatives by each number.
fn derivatives(numbers: &Numbers, data: &Data) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(data.points.len(), numbers.len());
    for column in 0..numbers.len() {
        let step = 1e-5 * (1.0 + numbers[column].abs());
        let moved = |by: f64| {
            let mut other = numbers.clone();
            other[column] += by;
            differences(&other, data)
        };
        matrix.set_column(column, &((moved(step) - moved(-step)) / (2.0 * step)));
    }
    matrix
}

/// The nearest minimum, and its mean square.
fn minimum(data: &Data, start: Numbers) -> (Numbers, f64) {
    let mean = |d: &DVector<f64>| d.norm_squared() / data.points.len() as f64;
    let (mut numbers, mut trust) = (start, 1e-2);
    let mut now = differences(&numbers, data);
    for _ in 0..60 {
        let slopes = derivatives(&numbers, data);
        let square = slopes.tr_mul(&slopes);
        let downhill = slopes.tr_mul(&now);
        let before = mean(&now);
        let mut is_better = false;
        while trust < 1e9 {
            let mut damped = square.clone();
            for i in 0..damped.nrows() {
                damped[(i, i)] *= 1.0 + trust;
                damped[(i, i)] += 1e-12;
            }
            let step = damped.lu().solve(&downhill);
            let next = step.map(|step| data.kept_within(&numbers - step)).filter(|n| n.iter().all(|v| v.is_finite()));
            let then = next.as_ref().map(|next| differences(next, data));
            if let (Some(next), Some(then)) = (next, then)
                && mean(&then) < before
            {
                (numbers, now, is_better) = (next, then, true);
                trust = (trust / 10.0).max(1e-9);
                break;
            }
            trust *= 10.0;
        }
        if !is_better || mean(&now) > before * (1.0 - 1e-9) {
            break;
        }
    }
    let cost = mean(&now);
    (numbers, cost)
}

/// The best fit with one mode more, from several starts: where the measured response is most above the fitted one, and
/// at places all over the sweep.
fn with_one_more(data: &Data, before: Option<&Numbers>) -> Option<(Numbers, f64)> {
    // The first: the highest |H|^2.
    let scores = match before {
        None => -differences(&DVector::zeros(0), data),
        Some(numbers) => -differences(numbers, data),
    };
    let (highest, _) = data.points.iter().zip(scores.iter()).max_by(|a, b| a.1.total_cmp(b.1))?;
    let [first, last] = data.ends();
    let spread = (1..8).map(|i| first * (last / first).powf(f64::from(i) / 8.0));
    let gains: &[f64] = if before.is_some() { &[0.3, -0.3] } else { &[1.0] };
    let mut best: Option<(Numbers, f64)> = None;
    for hz in std::iter::once(highest.hz).chain(spread) {
        for damping in STARTS {
            for gain in gains {
                let old = before.map_or(&[][..], |numbers| numbers.as_slice());
                let all = old.iter().copied().chain([hz.ln(), damping.ln(), *gain]);
                let found = minimum(data, DVector::from_iterator(old.len() + 3, all));
                let is_better = best.as_ref().is_none_or(|(_, cost)| found.1 < *cost);
                if found.1.is_finite() && is_better {
                    best = Some(found);
                }
            }
        }
    }
    best
}

/// Whether every mode lies within the sweep and has a possible damping. A fit that ended at a limit found none there.
fn is_within(numbers: &Numbers, data: &Data) -> bool {
    let [first, last] = data.ends();
    numbers.as_slice().chunks_exact(3).all(|mode| {
        let (hz, damping) = (mode[0].exp(), mode[1].exp());
        hz > 1.001 * first && hz < 0.999 * last && damping > 1.01 * DAMPINGS[0] && damping < 0.99 * DAMPINGS[1]
    })
}

/// Height of a mode's own peak.
fn peak(mode: &[f64]) -> f64 {
    mode[2].abs() / (2.0 * mode[1].exp())
}

/// Whether no two modes are one, and none is only a bend.
fn are_apart(numbers: &Numbers) -> bool {
    let modes: Vec<&[f64]> = numbers.as_slice().chunks_exact(3).collect();
    let highest = modes.iter().map(|mode| peak(mode)).fold(0.0, f64::max);
    modes.iter().enumerate().all(|(i, one)| {
        peak(one) >= LEAST_PEAK * highest && modes.iter().skip(i + 1).all(|two| (one[0] - two[0]).abs() >= APART)
    })
}

fn told(data: &Data, numbers: &Numbers, cost: f64) -> Modes {
    let slopes = derivatives(numbers, data);
    let free = (data.points.len() - numbers.len()).max(1) as f64;
    let variance = cost * data.points.len() as f64 / free;
    let mut square = slopes.tr_mul(&slopes);
    if data.sources > 0 {
        // All gains together are as good as the strengths of the sources, so no equation holds them.
        (0..square.nrows()).for_each(|i| square[(i, i)] += 1e-9);
    }
    let covariance = square.try_inverse();
    let whole: f64 = numbers.as_slice().chunks_exact(3).map(|mode| mode[2]).sum();
    let sign = if whole < 0.0 { -1.0 } else { 1.0 };
    // Without slow motion there are no parts of it; the strongest gets them all.
    let strongest = numbers.as_slice().chunks_exact(3).map(|mode| mode[2].abs()).fold(0.0, f64::max);
    let scale = if whole.abs() > 0.1 * strongest { whole.abs() } else { strongest.max(f64::MIN_POSITIVE) };
    let one = |(i, mode): (usize, &[f64])| {
        let error = |k: usize| covariance.as_ref().map_or(0.0, |c| (c[(k, k)] * variance).max(0.0).sqrt());
        let (frequency_hz, damping_ratio) = (mode[0].exp(), mode[1].exp());
        let mode_told = Mode {
            frequency_hz,
            frequency_error_hz: error(3 * i) * frequency_hz,
            damping_ratio,
            damping_ratio_error: error(3 * i + 1) * damping_ratio,
            part: sign * mode[2] / scale,
        };
        (peak(mode), mode_told)
    };
    let mut modes: Vec<(f64, Mode)> = numbers.as_slice().chunks_exact(3).enumerate().map(one).collect();
    modes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let measured = |p: &Point| ((p.measured.exp() - data.noise).max(0.0) / p.commanded).sqrt() / scale;
    Modes {
        modes: modes.into_iter().map(|(_, mode)| mode).collect(),
        fit_error_db: 10.0 / std::f64::consts::LN_10 * cost.sqrt(),
        frequencies_hz: data.points.iter().map(|p| p.hz).collect(),
        measured: data.points.iter().map(measured).collect(),
        fitted: data.points.iter().map(|p| response(numbers, p.hz, data).sqrt() / scale).collect(),
    }
}
