//! Search: the modes with the least differences, by Levenberg's and Marquardt's method (D. Marquardt, 1963), and how
//! many there are.
//!
//! Each number of modes is tried from several starts. The first ones are the peaks of the response; a further mode
//! starts where the response is most above or below the fit.

use super::model::{Data, Numbers, differences, modes, response, share, with_slopes};
use super::{Mode, Modes, Unfitted};
use nalgebra::DVector;

/// Most modes.
const MOST: usize = 6;

/// A further mode must lower the root mean square of the differences by this factor.
pub const WORTH: f64 = 0.75;

/// No further mode is looked for below this root mean square, in dB.
const ENOUGH_DB: f64 = 0.05;

/// Dampings of a mode. Beyond, it is the slope of a foot or a line of the mains.
const DAMPINGS: [f64; 2] = [0.002, 0.6];

/// Two modes closer than this part of their frequency are one.
const APART: f64 = 0.03;

/// Start values of the damping, and of the share.
const STARTS: [f64; 2] = [0.03, 0.12];
const SHARE: f64 = 0.5;

/// The share at a start. Powers of several sources do not tell it.
fn first_share(data: &Data) -> f64 {
    if data.sources == 0 { SHARE } else { 0.0 }
}

/// A mode with less than this part of the strongest one's peak is left out: it is a bend of the curve.
const LEAST_PEAK: f64 = 0.03;

/// Places to each side over which a response is averaged before its peaks are looked for.
const AVERAGED: usize = 1;
/// Height of a peak over the valleys on both sides, in logarithms of a power: 1 dB.
const CLEAR: f64 = 0.23;

/// A response that rises by more rings at the end of the sweep, or beyond it: 3 dB.
const RISE: f64 = 0.69;

/// Steps of a first look from a start, and at most.
const LOOK: usize = 12;
const STEPS: usize = 80;

const DECIBELS: f64 = 10.0 / std::f64::consts::LN_10;

/// Numbers, and the mean square of their differences.
#[derive(Clone)]
struct Found {
    numbers: Numbers,
    cost: f64,
}

/// The modes of the points, which must be much better than none.
pub(super) fn fitted(data: &Data) -> Result<Modes, Unfitted> {
    let curve = logarithms(data);
    let peaks = peaks_of(data, &curve);
    let mut all: Vec<Option<Found>> = Vec::new();
    let mut before: Option<Found> = None;
    for count in 1..=MOST {
        let Some(next) = with_one_more(data, before.as_ref(), &peaks, count) else { break };
        let is_enough = DECIBELS * next.cost.sqrt() < ENOUGH_DB;
        let is_legal = is_within(&next.numbers, data) && are_apart(&next.numbers);
        all.push(Some(next.clone()).filter(|_| is_legal));
        let is_worse = count > peaks.len() && all.iter().rev().take(2).all(Option::is_none);
        before = Some(next);
        if is_enough || is_worse {
            break;
        }
    }
    let flat = mean(&differences(&DVector::zeros(0), data), data);
    let best = chosen(&all).filter(|best| best.cost < WORTH * WORTH * flat);
    let rise = curve.iter().copied().fold(f64::NEG_INFINITY, f64::max) - curve.first().copied().unwrap_or(0.0);
    let none = if peaks.is_empty() && rise < RISE { Unfitted::Flat } else { Unfitted::Unclear };
    best.map(|best| told(data, best)).ok_or(none)
}

/// The fewest modes, unless more are worth it.
fn chosen(all: &[Option<Found>]) -> Option<&Found> {
    let mut best: Option<(usize, &Found)> = None;
    for (count, found) in all.iter().enumerate().filter_map(|(count, found)| Some((count, found.as_ref()?))) {
        let worth = |before: usize| WORTH.powi(2 * (count - before) as i32);
        if best.is_none_or(|(before, least)| found.cost < least.cost * worth(before)) {
            best = Some((count, found));
        }
    }
    best.map(|(_, found)| found)
}

fn mean(differences: &DVector<f64>, data: &Data) -> f64 {
    let weights = data.points.iter().map(|point| point.weight * point.weight).sum::<f64>();
    differences.norm_squared() / weights.max(f64::MIN_POSITIVE)
}

/// Logarithms of |H|^2 as measured.
fn logarithms(data: &Data) -> Vec<f64> {
    let of = |p: &super::model::Point| {
        let power = p.measured.exp() - data.noise;
        power.max(data.noise / 10.0).max(f64::MIN_POSITIVE).ln() - p.commanded().ln()
    };
    data.points.iter().map(of).collect()
}

/// Places of the peaks of a curve, the highest first: higher than the valleys to both sides.
fn peaks_of(data: &Data, curve: &[f64]) -> Vec<f64> {
    let smooth = |i: usize| {
        let part = &curve[i.saturating_sub(AVERAGED)..(i + AVERAGED + 1).min(curve.len())];
        part.iter().sum::<f64>() / part.len() as f64
    };
    let curve: Vec<f64> = (0..curve.len()).map(smooth).collect();
    let valley = |places: &mut dyn Iterator<Item = usize>, top: f64| {
        let mut least = top;
        for value in places.map(|i| curve[i]) {
            if value > top {
                break;
            }
            least = least.min(value);
        }
        top - least
    };
    let is_peak = |i: &usize| {
        let sides = [valley(&mut (0..*i).rev(), curve[*i]), valley(&mut (*i + 1..curve.len()), curve[*i])];
        sides.iter().all(|depth| *depth > CLEAR)
    };
    let mut found: Vec<usize> = (0..curve.len()).filter(is_peak).collect();
    found.sort_by(|a, b| curve[*b].total_cmp(&curve[*a]));
    found.into_iter().filter_map(|i| data.points.get(i)).map(|point| point.hz).collect()
}

/// The best fit with so many modes, from several starts.
fn with_one_more(data: &Data, before: Option<&Found>, peaks: &[f64], count: usize) -> Option<Found> {
    let mut starts = Vec::new();
    if count > 1 && count <= peaks.len() {
        let places = &peaks[..count];
        let gain = 1.0 / count as f64;
        for damping in STARTS {
            let all = places.iter().flat_map(|hz| [hz.ln(), damping.ln(), gain]);
            starts.push(DVector::from_iterator(3 * count + 1, all.chain([first_share(data)])));
        }
    }
    for hz in places(data, before, peaks) {
        for damping in STARTS {
            let gains: &[f64] = if before.is_some() { &[0.3, -0.3] } else { &[1.0] };
            for gain in gains {
                let old = before.map_or(&[][..], |found| found.numbers.as_slice());
                let (old, share) = old.split_at(old.len().saturating_sub(1));
                let share = share.first().copied().unwrap_or(first_share(data));
                let all = old.iter().copied().chain([hz.ln(), damping.ln(), *gain, share]);
                starts.push(DVector::from_iterator(old.len() + 4, all));
            }
        }
    }
    let looks = starts.into_iter().map(|start| minimum(data, start, LOOK));
    let best = looks.filter(|found| found.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    Some(minimum(data, best.numbers, STEPS))
}

/// Where a further mode may be.
fn places(data: &Data, before: Option<&Found>, peaks: &[f64]) -> Vec<f64> {
    let [first, last] = ends(data);
    let Some(found) = before else {
        let spread = (1..6).map(|i| first * (last / first).powf(f64::from(i) / 6.0));
        // A peak at the end of the sweep has no valley behind it.
        return highest(data, &logarithms(data))
            .into_iter()
            .chain(peaks.iter().copied().take(2))
            .chain(spread)
            .collect();
    };
    let left: Vec<f64> = differences(&found.numbers, data).iter().map(|v| -v).collect();
    let above = peaks_of(data, &left).into_iter().take(2);
    let below = peaks_of(data, &left.iter().map(|v| -v).collect::<Vec<f64>>()).into_iter().take(1);
    let spread = [0.25, 0.5, 0.75].map(|part| first * (last / first).powf(part));
    above.chain(below).chain(spread).collect()
}

/// The frequency at which a curve is highest.
fn highest(data: &Data, curve: &[f64]) -> Option<f64> {
    let (point, _) = data.points.iter().zip(curve).max_by(|a, b| a.1.total_cmp(b.1))?;
    Some(point.hz)
}

/// First and last frequency.
fn ends(data: &Data) -> [f64; 2] {
    let hz = |point: Option<&super::model::Point>| point.map_or(1.0, |point| point.hz);
    [hz(data.points.first()), hz(data.points.last())]
}

/// Frequencies, dampings and the share no further than the limits: a step that goes far beyond does not come back.
fn kept_within(data: &Data, mut numbers: Numbers) -> Numbers {
    let [first, last] = ends(data);
    let end = numbers.len().saturating_sub(1);
    for mode in numbers.as_mut_slice().chunks_exact_mut(3) {
        mode[0] = mode[0].clamp(first.ln(), last.ln());
        mode[1] = mode[1].clamp(DAMPINGS[0].ln(), DAMPINGS[1].ln());
    }
    if let Some(share) = numbers.get_mut(end) {
        *share = share.clamp(0.0, 1.0);
    }
    numbers
}

/// The nearest minimum, in so many steps.
fn minimum(data: &Data, start: Numbers, steps: usize) -> Found {
    let (mut numbers, mut trust) = (start, 1e-2);
    let (mut now, mut slopes) = with_slopes(&numbers, data);
    for _ in 0..steps {
        let square = slopes.tr_mul(&slopes);
        let downhill = slopes.tr_mul(&now);
        let before = now.norm_squared();
        let mut better = None;
        while trust < 1e9 && better.is_none() {
            let mut damped = square.clone();
            for i in 0..damped.nrows() {
                damped[(i, i)] = damped[(i, i)] * (1.0 + trust) + 1e-12;
            }
            let step = damped.lu().solve(&downhill);
            let next = step.map(|step| kept_within(data, &numbers - step));
            let next = next.filter(|next| next.iter().all(|v| v.is_finite()));
            better = next.filter(|next| differences(next, data).norm_squared() < before);
            trust = if better.is_some() { (trust / 10.0).max(1e-9) } else { trust * 10.0 };
        }
        let Some(next) = better else { break };
        numbers = next;
        (now, slopes) = with_slopes(&numbers, data);
        if now.norm_squared() > before * (1.0 - 1e-6) {
            break;
        }
    }
    Found { cost: mean(&now, data), numbers }
}

/// Whether every mode lies within the sweep and has a possible damping. A fit that ended at a limit found none there.
fn is_within(numbers: &Numbers, data: &Data) -> bool {
    let [first, last] = ends(data);
    modes(numbers).all(|[frequency, damping, _]| {
        let (hz, damping) = (frequency.exp(), damping.exp());
        hz > 1.001 * first && hz < 0.999 * last && damping > 1.01 * DAMPINGS[0] && damping < 0.99 * DAMPINGS[1]
    })
}

/// Height of a mode's own peak.
fn peak([_, damping, gain]: [f64; 3]) -> f64 {
    gain.abs() / (2.0 * damping.exp())
}

/// Whether no two modes are one, and none is only a bend.
fn are_apart(numbers: &Numbers) -> bool {
    let all: Vec<[f64; 3]> = modes(numbers).collect();
    let highest = all.iter().map(|mode| peak(*mode)).fold(0.0, f64::max);
    all.iter().enumerate().all(|(i, one)| {
        peak(*one) >= LEAST_PEAK * highest && all.iter().skip(i + 1).all(|two| (one[0] - two[0]).abs() >= APART)
    })
}

fn told(data: &Data, Found { numbers, cost }: &Found) -> Modes {
    let (_, slopes) = with_slopes(numbers, data);
    let free = (data.points.len() - numbers.len()).max(1) as f64;
    let variance = cost * data.points.len() as f64 / free;
    let mut square = slopes.tr_mul(&slopes);
    // All gains together are as good as the strengths of the sources, and a share at its end is held by no equation.
    (0..square.nrows()).for_each(|i| square[(i, i)] += 1e-9);
    let covariance = square.try_inverse();
    let whole: f64 = modes(numbers).map(|[_, _, gain]| gain).sum();
    let sign = if whole < 0.0 { -1.0 } else { 1.0 };
    // Without slow motion there are no parts of it; the strongest gets them all.
    let strongest = modes(numbers).map(|[_, _, gain]| gain.abs()).fold(0.0, f64::max);
    let scale = if whole.abs() > 0.1 * strongest { whole.abs() } else { strongest.max(f64::MIN_POSITIVE) };
    let error = |k: usize| covariance.as_ref().map_or(0.0, |c| (c[(k, k)] * variance).max(0.0).sqrt());
    let one = |(i, mode): (usize, [f64; 3])| {
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
    let mut all: Vec<(f64, Mode)> = modes(numbers).enumerate().map(one).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let measured = logarithms(data).into_iter().map(|logarithm| (logarithm / 2.0).exp() / scale).collect();
    Modes {
        modes: all.into_iter().map(|(_, mode)| mode).collect(),
        belt_damping_share: share(numbers),
        belt_damping_share_error: error(numbers.len().saturating_sub(1)),
        fit_error_db: DECIBELS * cost.sqrt(),
        frequencies_hz: data.points.iter().map(|p| p.hz).collect(),
        measured,
        fitted: data.points.iter().map(|p| response(numbers, p.hz, data.sources).sqrt() / scale).collect(),
    }
}
