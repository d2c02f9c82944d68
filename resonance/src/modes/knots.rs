//! Knots: the bins of a spectrum that a file has on a finer grid.
//!
//! Klipper writes a file of several sensors on a grid of 0.2 Hz, with straight lines from bin to bin (`np.interp`,
//! `shaper_calibrate.py`). The bins themselves are wider, as wide as their windows, and only they tell the window. The
//! grid bends at a bin and nowhere else, so the distance of the bins is the one without bends between them.

use crate::spectrum::{Density, Spectrum};

/// A window of Klipper lasts from half a second to a second.
const BINS_HZ: [f64; 2] = [0.95, 2.05];

/// Steps of the search, and of its end near the best one.
const COARSE_HZ: f64 = 5e-4;
const FINE_HZ: f64 = 1e-5;
const NEAR_HZ: f64 = 3e-3;

/// Bends that decimals of a file make, as a part of the bends at the bins.
const FLAT: f64 = 0.1;

/// Fewest points of the grid.
const FEWEST: usize = 60;

/// The spectrum at its bins, if it has other ones than the grid of its file.
pub(super) fn at_bins(density: &Density) -> Option<Density> {
    let (step_hz, sum) = (density.spectrum.step_hz, &density.spectrum.sum);
    let has_axes = density.spectrum.axes.iter().any(|axis| !axis.is_empty());
    if has_axes || step_hz >= BINS_HZ[0] || sum.len() < FEWEST {
        return None;
    }
    let bin_hz = distance(step_hz, sum)?;
    let sum = values(step_hz, sum, bin_hz);
    let spectrum = Spectrum { step_hz: bin_hz, sum, ..density.spectrum.clone() };
    Some(Density { spectrum, is_normalised: density.is_normalised })
}

/// The distance of the bins.
fn distance(step_hz: f64, grid: &[f64]) -> Option<f64> {
    let bends: Vec<f64> =
        grid.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).abs() / (v[0] + v[2]).max(1e-30)).collect();
    // The mean bend where a line from bin to bin has none.
    let between = |bin_hz: f64| {
        let is_between = |i: &usize| {
            let off = ((i + 1) as f64 * step_hz / bin_hz).fract();
            off.min(1.0 - off) * bin_hz >= step_hz
        };
        let all = (0..bends.len()).filter(is_between).filter_map(|i| bends.get(i));
        let (count, sum) = all.fold((0_u32, 0.0), |(count, sum), bend| (count + 1, sum + bend));
        sum / f64::from(count.max(1))
    };
    let all = |from: f64, to: f64, step: f64| {
        let count = ((to - from) / step) as usize;
        (0..count).map(|i| from + i as f64 * step).map(|bin_hz| (bin_hz, between(bin_hz))).collect::<Vec<_>>()
    };
    let least = |tried: &[(f64, f64)]| tried.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1));
    let (near, _) = least(&all(BINS_HZ[0], BINS_HZ[1], COARSE_HZ))?;
    let mean = bends.iter().sum::<f64>() / bends.len() as f64;
    let nearer = |near: f64| {
        let fine = all(near - NEAR_HZ, near + NEAR_HZ, FINE_HZ);
        least(&fine).map(|(best, bend)| (fine, best, bend))
    };
    let found = nearer(near)?;
    // Halves of the distance have no bends between them either.
    let double = Some(2.0 * near).filter(|double| *double < BINS_HZ[1]).and_then(nearer);
    let (fine, best, bend) = double.filter(|(.., bend)| *bend < FLAT * mean).unwrap_or(found);
    // Bins that lie on the grid leave some room to both sides: the middle is theirs.
    let is_good = |(_, other): &&(f64, f64)| *other <= 2.0 * bend;
    let [above, below] = [1.0, -1.0].map(|side| {
        let mut beyond: Vec<_> = fine.iter().filter(|(bin_hz, _)| (bin_hz - best) * side >= 0.0).collect();
        beyond.sort_by(|a, b| (a.0 - best).abs().total_cmp(&(b.0 - best).abs()));
        beyond.into_iter().take_while(is_good).last().map_or(best, |(bin_hz, _)| *bin_hz)
    });
    (bend < FLAT * mean).then_some(f64::midpoint(above, below))
}

/// The values at the bins: the line through the points of the grid between two bins meets both.
fn values(step_hz: f64, grid: &[f64], bin_hz: f64) -> Vec<f64> {
    let mut found = Vec::new();
    for bin in 0.. {
        let (first, last) =
            ((bin as f64 * bin_hz / step_hz).ceil() as usize, ((bin + 1) as f64 * bin_hz / step_hz) as usize);
        let (Some(from), Some(to)) = (grid.get(first), grid.get(last)) else { break };
        let slope = (to - from) / (last - first).max(1) as f64;
        found.push((from - slope * (first as f64 - bin as f64 * bin_hz / step_hz)).max(0.0));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A spectrum with peaks and noise at its bins.
    fn bins(count: usize) -> Vec<f64> {
        let mut seed = 7_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as f64 / (1_u64 << 31) as f64
        };
        (0..count).map(|i| 1e4 * (1.0 + 50.0 / (1.0 + (i as f64 - 30.0).powi(2))) * (0.5 + noise())).collect()
    }

    /// The text of a number with four digits, as files have it.
    fn rounded(value: f64) -> f64 {
        format!("{value:.3e}").parse().unwrap_or(value)
    }

    fn on_grid(bin_hz: f64, bins: &[f64], step_hz: f64) -> Density {
        let value = |i: usize| {
            let at = i as f64 * step_hz / bin_hz;
            let (k, part) = (at as usize, at.fract());
            rounded(bins[k] * (1.0 - part) + bins[k + 1] * part)
        };
        let sum = (0..(190.0 / step_hz) as usize).map(value).collect();
        Density { spectrum: Spectrum { step_hz, axes: [const { Vec::new() }; 3], sum }, is_normalised: false }
    }

    #[test]
    fn bins_behind_a_finer_grid_are_found() {
        for bin_hz in [1.5625, 1.0, 1.953_125, 3216.0 / 2048.0, 1.234_56] {
            let bins = bins(230);
            let found = at_bins(&on_grid(bin_hz, &bins, 0.2)).unwrap();
            assert!((found.spectrum.step_hz - bin_hz).abs() < 1e-3, "{bin_hz}: {}", found.spectrum.step_hz);
            for (k, value) in found.spectrum.sum.iter().enumerate() {
                assert!((value / bins[k] - 1.0).abs() < 0.05, "{bin_hz}, {k}: {value} {}", bins[k]);
            }
        }
    }

    #[test]
    fn a_spectrum_at_its_own_bins_stays() {
        let bins = bins(1000);
        assert!(at_bins(&on_grid(0.2, &bins, 0.2)).is_none());
        assert!(at_bins(&on_grid(1.5625, &bins, 1.5625)).is_none());
    }
}
