//! Design: the shaper for an axis with different frequencies in different places.
//!
//! One shaper serves all places. Its frequency minimises the vibration at the worst place of the band. The suggested
//! kind rounds least among those that leave no more than 5 %.

use super::shaper::{Impulse, ShaperKind, impulses, residual, smoothing_mm};
use serde::Serialize;

/// Residual vibration allowed for a suggested shaper, of 1.
pub const TOLERABLE: f64 = 0.05;

/// Places of a band at which a shaper is evaluated.
const LOOKS: usize = 41;

/// The frequency search has this many steps, then once more around the best.
const STEPS: usize = 200;

/// A shaper for a band.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Design {
    /// Its kind.
    #[serde(rename = "type")]
    pub kind: ShaperKind,
    /// Its frequency.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Residual vibration at the worst place of the band, of 1.
    pub worst_residual: f64,
    /// Corner rounding at 5 m/s^2.
    pub smoothing_mm: f64,
}

/// Residual vibration that a shaper leaves at the worst place of a band of frequencies in Hz with this damping.
#[must_use]
pub fn worst_residual(impulses: &[Impulse], [low, high]: [f64; 2], damping: f64) -> f64 {
    let place = |i: usize| low + (high - low) * i as f64 / (LOOKS - 1) as f64;
    (0..LOOKS).map(|i| residual(impulses, place(i), damping)).fold(0.0, f64::max)
}

/// The best shaper of a kind for a band of frequencies in Hz.
#[must_use]
pub fn design(kind: ShaperKind, band_hz: [f64; 2], damping: f64) -> Design {
    let [low, high] = band_hz;
    let worst = |frequency: f64| worst_residual(&impulses(kind, frequency, damping), band_hz, damping);
    let best = |from: f64, to: f64| {
        let frequency = |i: usize| from + (to - from) * i as f64 / STEPS as f64;
        let tried = (0..=STEPS).map(|i| (frequency(i), worst(frequency(i))));
        tried.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((low, 1.0))
    };
    let (from, to) = (0.8 * low, 1.5 * high);
    let (coarse, _) = best(from, to);
    let width = (to - from) / STEPS as f64;
    let (frequency_hz, worst_residual) = best(coarse - width, coarse + width);
    let smoothing_mm = smoothing_mm(&impulses(kind, frequency_hz, damping));
    Design { kind, frequency_hz, worst_residual, smoothing_mm }
}

/// The best of every kind, and the suggested one.
#[must_use]
pub fn designs(band_hz: [f64; 2], damping: f64) -> (Vec<Design>, Option<Design>) {
    let all: Vec<Design> = ShaperKind::ALL.into_iter().map(|kind| design(kind, band_hz, damping)).collect();
    let enough = all.iter().filter(|design| design.worst_residual <= TOLERABLE);
    let gentlest = enough.min_by(|a, b| a.smoothing_mm.total_cmp(&b.smoothing_mm));
    let calmest = || all.iter().min_by(|a, b| a.worst_residual.total_cmp(&b.worst_residual));
    let suggested = gentlest.or_else(calmest).copied();
    (all, suggested)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frequencies rise by 13.1 % along x and 14.3 % along y from the middle of a CoreH-bot; damping 0.05.
    #[test]
    fn a_band_leaves_what_was_computed_elsewhere() {
        for (kind, x, y) in [(ShaperKind::Zv, 0.090, 0.097), (ShaperKind::Mzv, 0.053, 0.057)] {
            for (band, known) in [(1.131, x), (1.143, y)] {
                let found = design(kind, [60.0, 60.0 * band], 0.05);
                assert!((found.worst_residual - known).abs() < 0.0015, "{found:?}");
                assert!((found.frequency_hz / 60.0 - 1.065).abs() < 0.008, "{found:?}");
            }
        }
    }

    #[test]
    fn the_gentlest_that_is_good_enough_is_suggested() {
        let (all, suggested) = designs([60.0, 63.0], 0.05);
        assert_eq!(all.len(), ShaperKind::ALL.len());
        assert_eq!(suggested.map(|design| design.kind), Some(ShaperKind::Zv));
        let (_, wide) = designs([60.0, 90.0], 0.05);
        assert!(wide.is_some_and(|design| design.kind == ShaperKind::TwoHumpEi || design.kind == ShaperKind::Ei));
    }
}
