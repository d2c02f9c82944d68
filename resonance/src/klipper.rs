//! Klipper's choice: the shaper that Klipper's calibration would suggest for a spectrum.
//!
//! Klipper, `shaper_calibrate.py`. It counts the vibration that is left, for three dampings, and how much the shaper
//! alone rounds a corner. A score joins both:
//!
//! ```text
//! v = sum max(|S(f)| PSD - t, 0) / sum max(PSD - t, 0),   t = max(PSD) / 20
//! score = smoothing (v^1.5 + 0.2 v + 0.01)
//! ```

use crate::shapers::Shaper;
use corehbot_twin::shaping::shaper::{CORNER_SPEED, Impulse, SMOOTHED_ACCELERATION, residual, smoothing_at_mm};
use serde::Serialize;

/// Damping that Klipper's shapers are made for.
pub const DAMPING: f64 = 0.1;

/// Dampings for which the vibration is computed; the worst counts.
const TESTED: [f64; 3] = [0.075, 0.1, 0.15];

/// Vibration below this part of the greatest does not count.
const THRESHOLD: f64 = 1.0 / 20.0;

/// Highest frequency of a shaper, and the distance of those that are tried.
const HIGHEST_HZ: f64 = 150.0;
const STEP_HZ: f64 = 0.2;

/// The spectrum counts up to this.
pub const SPECTRUM_HZ: f64 = 200.0;

/// Smoothing at the suggested acceleration.
const TARGET_MM: f64 = 0.12;

/// A shaper as Klipper rates it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rated {
    /// Which.
    pub shaper: Shaper,
    /// Whether this firmware has it.
    pub in_firmware: bool,
    /// Its frequency.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Part of the vibration that is left, of 1.
    pub remaining_vibration: f64,
    /// Corner rounding of the shaper alone at 5000 mm/s^2.
    pub smoothing_mm: f64,
    /// Less is better.
    pub score: f64,
    /// Acceleration up to which corners are rounded by at most 0.12 mm.
    pub suggested_acceleration_mm_s2: f64,
}

/// Ratings of all shapers, and Klipper's choice among its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// The best frequency of each shaper.
    pub shapers: Vec<Rated>,
    /// Klipper's suggestion.
    pub suggestion: Option<Rated>,
    /// The same law among the shapers of this firmware.
    pub in_firmware: Option<Rated>,
}

/// Lowest frequency that is tried.
const fn lowest_hz(shaper: Shaper) -> f64 {
    use corehbot_twin::shaping::shaper::ShaperKind::{Ei, Mzv, TwoHumpEi, Zv, Zvd};
    match shaper {
        Shaper::Own(Zv) => 21.0,
        Shaper::Own(Mzv) => 23.0,
        Shaper::Own(Zvd | Ei) => 29.0,
        Shaper::Own(TwoHumpEi) => 39.0,
        Shaper::ThreeHumpEi => 48.0,
    }
}

/// A normalised spectrum: the distance of its frequencies, and its values.
#[derive(Clone, Copy, Debug)]
pub struct Normalised<'p> {
    /// Distance of the frequencies; the first is 0.
    pub step_hz: f64,
    /// Values.
    pub psd: &'p [f64],
}

/// Frequency, value, and the value that does not count, of every frequency up to [`SPECTRUM_HZ`].
struct Bins {
    bins: Vec<(f64, f64)>,
    threshold: f64,
    /// The sum of all that counts.
    all: f64,
}

impl Bins {
    fn new(spectrum: Normalised) -> Self {
        let hz = |i: usize| i as f64 * spectrum.step_hz;
        let bins: Vec<(f64, f64)> = spectrum.psd.iter().enumerate().map(|(i, psd)| (hz(i), *psd)).collect();
        let bins: Vec<(f64, f64)> = bins.into_iter().filter(|(hz, _)| *hz <= SPECTRUM_HZ).collect();
        let threshold = bins.iter().map(|(_, psd)| *psd).fold(0.0, f64::max) * THRESHOLD;
        let all = bins.iter().map(|(_, psd)| (psd - threshold).max(0.0)).sum();
        Self { bins, threshold, all }
    }

    /// Part of the vibration that is left.
    fn remaining(&self, impulses: &[Impulse]) -> f64 {
        let of = |damping: f64| {
            // A shaper does not enlarge, so small values cannot count.
            let loud = self.bins.iter().filter(|(_, psd)| *psd > self.threshold);
            let left = loud.map(|(hz, psd)| (residual(impulses, *hz, damping) * psd - self.threshold).max(0.0));
            left.sum::<f64>() / self.all.max(f64::MIN_POSITIVE)
        };
        TESTED.into_iter().map(of).fold(0.0, f64::max)
    }
}

fn rate(shaper: Shaper, frequency_hz: f64, damping: f64, spectra: &[Bins]) -> Rated {
    let impulses = shaper.impulses(frequency_hz, damping);
    let remaining_vibration = spectra.iter().map(|bins| bins.remaining(&impulses)).fold(0.0, f64::max);
    let smoothing_mm = smoothing_at_mm(&impulses, SMOOTHED_ACCELERATION, CORNER_SPEED);
    let v = remaining_vibration;
    Rated {
        shaper,
        in_firmware: shaper.in_firmware(),
        frequency_hz,
        remaining_vibration,
        smoothing_mm,
        score: smoothing_mm * (v.powf(1.5) + 0.2 * v + 0.01),
        suggested_acceleration_mm_s2: 0.0,
    }
}

/// All frequencies of a shaper, the lowest first, and the one that Klipper selects.
fn fit(shaper: Shaper, spectra: &[Bins]) -> Option<(Vec<Rated>, Rated)> {
    let lowest = lowest_hz(shaper);
    let count = ((HIGHEST_HZ - lowest) / STEP_HZ - 1e-9).ceil() as usize;
    let all: Vec<Rated> = (0..count).map(|i| rate(shaper, lowest + i as f64 * STEP_HZ, DAMPING, spectra)).collect();
    // Klipper tries the highest first, and keeps the first of equals.
    let calmest = *all.iter().rev().reduce(|a, b| if a.remaining_vibration > b.remaining_vibration { b } else { a })?;
    let enough = calmest.remaining_vibration * 1.1 + 0.0005;
    let better = |best: Rated, next: &Rated| {
        if next.remaining_vibration < enough && next.score < best.score { *next } else { best }
    };
    let selected = all.iter().fold(calmest, better);
    Some((all, selected))
}

/// The rating of a shaper at a frequency that is made for this damping, with its acceleration.
#[must_use]
pub fn rated(shaper: Shaper, frequency_hz: f64, damping: f64, spectra: &[Normalised]) -> Rated {
    let bins: Vec<Bins> = spectra.iter().map(|spectrum| Bins::new(*spectrum)).collect();
    with_acceleration(rate(shaper, frequency_hz, damping, &bins), damping)
}

/// A shaper, its ratings at all frequencies, and the selected one.
type Fitted = (Shaper, Vec<Rated>, Rated);

/// Klipper's choice for one or more spectra of an axis; the worst of them counts.
#[must_use]
pub fn choose(spectra: &[Normalised]) -> Choice {
    let spectra: Vec<Bins> = spectra.iter().map(|spectrum| Bins::new(*spectrum)).collect();
    let one = |shaper: Shaper| fit(shaper, &spectra).map(|(all, selected)| (shaper, all, selected));
    let fitted: Vec<Fitted> = Shaper::ALL.into_iter().filter_map(one).collect();
    let (mut shapers, suggestion) = best_of(&fitted, Shaper::in_klippers_choice);
    let (_, in_firmware) = best_of(&fitted, |shaper| shaper.in_klippers_choice() && shaper.in_firmware());
    let others = fitted.iter().filter(|(shaper, ..)| !shaper.in_klippers_choice()).map(|(_, _, selected)| *selected);
    shapers.extend(others);
    shapers.sort_by_key(|rated| Shaper::ALL.iter().position(|shaper| *shaper == rated.shaper));
    let full = |rated: Rated| with_acceleration(rated, DAMPING);
    Choice {
        shapers: shapers.into_iter().map(full).collect(),
        suggestion: suggestion.map(full),
        in_firmware: in_firmware.map(full),
    }
}

/// The ratings of some shapers, and the best of them by Klipper's law.
fn best_of(fitted: &[Fitted], takes: impl Fn(Shaper) -> bool) -> (Vec<Rated>, Option<Rated>) {
    let (mut shapers, mut best): (Vec<Rated>, Option<Rated>) = (Vec::new(), None);
    for (_, all, selected) in fitted.iter().filter(|(shaper, ..)| takes(*shaper)) {
        let mut selected = *selected;
        let mut leader = match best {
            Some(best) if !is_much_better(&selected, &best) => best,
            _ => selected,
        };
        for other in all {
            if other.remaining_vibration < leader.remaining_vibration && other.smoothing_mm < leader.smoothing_mm {
                (leader, selected) = (*other, *other);
            }
        }
        best = Some(leader);
        shapers.push(selected);
    }
    if let Some(zv) = best.filter(|best| best.shaper == Shaper::ALL[0]) {
        let calmer = |s: &&Rated| s.shaper != zv.shaper && s.remaining_vibration * 1.1 < zv.remaining_vibration;
        best = shapers.iter().find(calmer).copied().or(best);
    }
    (shapers, best)
}

/// By a fifth, or by a twentieth with a tenth less rounding.
fn is_much_better(next: &Rated, best: &Rated) -> bool {
    next.score * 1.2 < best.score || next.score * 1.05 < best.score && next.smoothing_mm * 1.1 < best.smoothing_mm
}

/// With the acceleration that rounds by [`TARGET_MM`]. Smoothing grows with the acceleration on a straight line.
fn with_acceleration(rated: Rated, damping: f64) -> Rated {
    let impulses = rated.shaper.impulses(rated.frequency_hz, damping);
    let smoothing = |acceleration: f64| smoothing_at_mm(&impulses, acceleration, CORNER_SPEED);
    let (mut low, mut high) = (0.0, 1.0);
    while smoothing(high) < TARGET_MM && high < 1e9 {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if smoothing(middle) < TARGET_MM { low = middle } else { high = middle }
    }
    Rated { suggested_acceleration_mm_s2: low, ..rated }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot_twin::shaping::shaper::ShaperKind;

    /// The response of a mode, as a normalised spectrum.
    fn peak(hz: f64, damping: f64) -> Vec<f64> {
        let value = |i: usize| {
            let r = i as f64 * 1.5625 / hz;
            1.0 / ((1.0 - r * r).powi(2) + (2.0 * damping * r).powi(2))
        };
        (0..200).map(value).collect()
    }

    #[test]
    fn a_sharp_peak_takes_the_shaper_for_its_frequency() {
        let psd = peak(60.0, 0.05);
        let choice = choose(&[Normalised { step_hz: 1.5625, psd: &psd }]);
        let names: Vec<&str> = choice.shapers.iter().map(|s| s.shaper.name()).collect();
        assert_eq!(names, ["ZV", "MZV", "ZVD", "EI", "2HUMP_EI", "3HUMP_EI"]);
        let zv = choice.shapers[0];
        assert!((zv.frequency_hz - 60.0).abs() < 2.0, "{zv:?}");
        // The acceleration rounds by the target.
        let impulses = zv.shaper.impulses(zv.frequency_hz, DAMPING);
        assert!((smoothing_at_mm(&impulses, zv.suggested_acceleration_mm_s2, 5.0) - 0.12).abs() < 1e-9);
    }

    #[test]
    fn two_spectra_count_by_the_worse() {
        let (low, high) = (peak(50.0, 0.05), peak(60.0, 0.05));
        let [low, high] = [&low, &high].map(|psd| Normalised { step_hz: 1.5625, psd });
        let both = choose(&[low, high]);
        for ((alone, other), both) in choose(&[low]).shapers.iter().zip(choose(&[high]).shapers).zip(&both.shapers) {
            let least = alone.remaining_vibration.min(other.remaining_vibration);
            assert!(both.remaining_vibration >= least, "{both:?}");
        }
        let one = rated(Shaper::Own(ShaperKind::Mzv), 55.0, DAMPING, &[low, high]).remaining_vibration;
        let each = [low, high].map(|s| rated(Shaper::Own(ShaperKind::Mzv), 55.0, DAMPING, &[s]).remaining_vibration);
        assert!((one - each[0].max(each[1])).abs() < 1e-12, "{one} {each:?}");
    }
}
