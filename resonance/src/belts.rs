//! Belts: comparison of the responses along two belt paths.
//!
//! On machines with crossed or looped belts a diagonal pulls one belt, or one pair of spans. Paths that respond alike
//! are tensioned alike. Peaks are compared by the fitted modes and not by their frequencies in the spectrum, which are
//! a Hz and more apart.

use crate::axis::Measured;
use crate::modes::Mode;
use serde::Serialize;

/// Frequencies of the correlation: as many, up to so many Hz.
const PLACES: usize = 500;
const UP_TO_HZ: f64 = 200.0;

/// Peaks further apart than this are no pair.
const PAIR_HZ: f64 = 10.0;

/// A peak of less than this part of the highest is left out.
const LEAST_PEAK: f64 = 0.1;

/// Frequencies within this part are alike; belts are tensioned by hand.
const ALIKE: f64 = 0.02;

/// Spectra with this correlation are alike.
const SIMILAR: f64 = 0.9;

/// A peak of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// Its frequency, by a parabola through its three highest points.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Its density.
    #[serde(rename = "density_mm2_s4_Hz")]
    pub density: f64,
}

/// What two paths have in common.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Files of both paths.
    pub files: [String; 2],
    /// Pearson's correlation of both spectra, no less than 0, in percent.
    pub similarity_percent: f64,
    /// Strongest mode of each path.
    pub modes: [Option<Mode>; 2],
    /// Frequency of A over the frequency of B, less 1, in percent.
    pub frequency_difference_percent: Option<f64>,
    /// Stiffness of A over the stiffness of B, less 1, in percent, if both move the same mass.
    pub stiffness_difference_percent: Option<f64>,
    /// Total vibration of A over the vibration of B, in dB.
    #[serde(rename = "level_difference_dB")]
    pub level_difference_db: f64,
    /// Peaks that both have.
    pub pairs: Vec<[Peak; 2]>,
    /// Peaks that only one has.
    pub alone: [Vec<Peak>; 2],
    /// The result in words.
    pub verdict: String,
}

/// Compares two paths, A and B.
#[must_use]
pub fn compare(a: &Measured, b: &Measured) -> Comparison {
    let both = [a, b];
    let curves = both.map(|m| (0..PLACES).map(|i| m.spectrum.at(UP_TO_HZ * i as f64 / (PLACES - 1) as f64)).collect());
    let similarity = correlation(&curves).max(0.0);
    let modes = both.map(|m| m.fit.as_ref().and_then(|fit| fit.modes.first().copied()));
    let ratio = match modes {
        [Some(a), Some(b)] => Some(a.frequency_hz / b.frequency_hz),
        _ => None,
    };
    let level = |curve: &Vec<f64>| curve.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let (pairs, alone) = pair(both.map(peaks));
    Comparison {
        files: both.map(|m| m.file.clone()),
        similarity_percent: 100.0 * similarity,
        modes,
        frequency_difference_percent: ratio.map(|r| 100.0 * (r - 1.0)),
        stiffness_difference_percent: ratio.map(|r| 100.0 * (r * r - 1.0)),
        level_difference_db: 10.0 * (level(&curves[0]) / level(&curves[1])).log10(),
        verdict: verdict(similarity, ratio, &alone),
        pairs,
        alone,
    }
}

fn verdict(similarity: f64, ratio: Option<f64>, alone: &[Vec<Peak>; 2]) -> String {
    let mut words = match ratio {
        None => "No mode was found along one of the paths.".to_owned(),
        Some(r) if (r - 1.0).abs() <= ALIKE && similarity >= SIMILAR => "Both paths respond alike.".to_owned(),
        Some(r) if (r - 1.0).abs() <= ALIKE => {
            "Both paths have the same frequency, but not the same response: look for friction, loose screws or a worn \
             pulley rather than at the tension."
                .to_owned()
        }
        Some(r) => {
            let (soft, stiff) = if r < 1.0 { ("A", "B") } else { ("B", "A") };
            let part = 100.0 * (1.0 - r.min(1.0 / r));
            format!(
                "Path {soft} rings {part:.1} % slower than {stiff}: its belt is looser or longer. Tension {soft}, or \
                 loosen {stiff}, and measure again."
            )
        }
    };
    for (path, peaks) in ["A", "B"].into_iter().zip(alone).filter(|(_, peaks)| !peaks.is_empty()) {
        let all: Vec<String> = peaks.iter().map(|peak| format!("{:.1} Hz", peak.frequency_hz)).collect();
        words.push_str(&format!(" Only path {path} has a peak at {}.", all.join(", ")));
    }
    words
}

/// Pearson's correlation.
pub(crate) fn correlation([a, b]: &[Vec<f64>; 2]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
    let (ma, mb) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        ab += (x - ma) * (y - mb);
        aa += (x - ma).powi(2);
        bb += (y - mb).powi(2);
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

/// Peaks of a spectrum, the lowest frequency first.
fn peaks(measured: &Measured) -> Vec<Peak> {
    let psd = &measured.spectrum.sum;
    let floor = LEAST_PEAK * psd.iter().copied().fold(0.0, f64::max);
    let one = |(i, three): (usize, &[f64])| {
        let [before, top, after] = *three else { return None };
        if top < floor || top < before || top <= after {
            return None;
        }
        let [l, c, r] = [before, top, after].map(|v| v.max(f64::MIN_POSITIVE).ln());
        let bend = l - 2.0 * c + r;
        let shift = if bend < 0.0 { 0.5 * (l - r) / bend } else { 0.0 };
        Some(Peak { frequency_hz: ((i + 1) as f64 + shift) * measured.spectrum.step_hz, density: top })
    };
    let all: Vec<Peak> = psd.windows(3).enumerate().filter_map(one).collect();
    // A dip of less than a fifth between two tops is noise of one peak.
    let mut kept: Vec<Peak> = Vec::new();
    for peak in all {
        match kept.last_mut() {
            Some(last) if dip(measured, last, &peak) > 0.8 * last.density.min(peak.density) => {
                if peak.density > last.density {
                    *last = peak;
                }
            }
            _ => kept.push(peak),
        }
    }
    kept
}

/// Least density between two peaks.
fn dip(measured: &Measured, from: &Peak, to: &Peak) -> f64 {
    let bin = |hz: f64| (hz / measured.spectrum.step_hz).round() as usize;
    let between = measured.spectrum.sum.get(bin(from.frequency_hz)..=bin(to.frequency_hz));
    between.unwrap_or_default().iter().copied().fold(f64::INFINITY, f64::min)
}

/// Pairs the nearest peaks first.
fn pair([mut a, mut b]: [Vec<Peak>; 2]) -> (Vec<[Peak; 2]>, [Vec<Peak>; 2]) {
    let mut pairs = Vec::new();
    loop {
        let all = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j)));
        let apart = |(i, j): (usize, usize)| Some((a.get(i)?.frequency_hz - b.get(j)?.frequency_hz).abs());
        let nearest = all.filter_map(|at| Some((at, apart(at)?))).min_by(|x, y| x.1.total_cmp(&y.1));
        let Some(((i, j), _)) = nearest.filter(|(_, apart)| *apart <= PAIR_HZ) else { break };
        pairs.push([a.remove(i), b.remove(j)]);
    }
    pairs.sort_by(|x, y| x[0].frequency_hz.total_cmp(&y[0].frequency_hz));
    (pairs, [a, b])
}
