//! Chords: a path in time as few straight moves at constant speed, for a planner that takes moves and not times.
//!
//! A stretch is cut where it is furthest from its chord until it is within the tolerance everywhere. The tolerance
//! along the path is larger than across it, because the plate shows only the error across.

use corehbot_twin::contour::cut::ends;
use corehbot_twin::math::hypot;

/// Tolerance across the chord, in mm: a twelfth of a step.
const BESIDE_MM: f64 = 0.001;

/// Tolerance along the chord, in mm: at 3 m/s2 it allows a chord of 3.3 ms.
const ALONG_MM: f64 = 0.004;

/// Tolerance of Z, in mm: at 0.2 m/s2 its speed changes by 0.8 mm/s from chord to chord.
const Z_MM: f64 = 0.0004;

/// Tolerance of the filament, in mm: at 3 m/s2 its speed changes by 5 mm/s.
const E_MM: f64 = 0.001;

/// A chord shorter than this has no direction, in mm.
const LEAST_MM: f64 = 1e-6;

/// The samples at which chords begin and end, of x, y, z and e in mm at equal distances in time.
#[must_use]
pub fn vertices(samples: &[[f64; 4]]) -> Vec<usize> {
    let Some(last) = samples.len().checked_sub(1) else { return Vec::new() };
    let ends = ends(last, |begin, end| furthest(samples, begin, end));
    std::iter::once(0).chain(ends).collect()
}

/// The sample between two others that is furthest from its chord at that time, if it is too far.
fn furthest(samples: &[[f64; 4]], begin: usize, end: usize) -> Option<usize> {
    let (a, b) = (samples.get(begin)?, samples.get(end)?);
    let way: [f64; 4] = std::array::from_fn(|i| b[i] - a[i]);
    let length = hypot(way[0], way[1]);
    let mut found = (1.0, None);
    for (index, sample) in samples.iter().enumerate().take(end).skip(begin + 1) {
        let part = (index - begin) as f64 / (end - begin) as f64;
        let off: [f64; 4] = std::array::from_fn(|i| sample[i] - a[i] - part * way[i]);
        let [along, beside] = if length < LEAST_MM {
            [0.0, hypot(off[0], off[1])]
        } else {
            [(off[0] * way[0] + off[1] * way[1]) / length, (off[1] * way[0] - off[0] * way[1]) / length]
        };
        let parts = [beside / BESIDE_MM, along / ALONG_MM, off[2] / Z_MM, off[3] / E_MM];
        let far = parts.into_iter().fold(0.0, |far: f64, part| far.max(part.abs()));
        if far > found.0 {
            found = (far, Some(index));
        }
    }
    found.1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 3 m/s2 a chord that is 4 um late in its middle lasts sqrt(8 d / a) = 3.3 ms. So 100 ms take about 31, at most
    /// twice as many.
    #[test]
    fn a_ramp_is_cut_by_its_lateness_and_rest_is_one_chord() {
        let at = |sample: usize| {
            let t = (sample as f64 / 5000.0).min(0.1);
            [1500.0 * t * t, 0.0, 0.0, 0.0]
        };
        let samples: Vec<[f64; 4]> = (0..1000).map(at).collect();
        let found = vertices(&samples);
        assert!((28..64).contains(&found.len()), "{}", found.len());
        assert_eq!(found.first(), Some(&0));
        assert_eq!(found.iter().filter(|index| **index > 502).count(), 1);
    }

    #[test]
    fn a_bump_aside_is_followed_more_closely_than_one_along() {
        let bump = |axis: usize| -> Vec<[f64; 4]> {
            let at = |sample: usize| {
                let mut at = [0.02 * sample as f64, 0.0, 0.0, 0.0];
                at[axis] += 0.003 * (-((sample as f64 - 250.0) / 20.0).powi(2)).exp();
                at
            };
            (0..500).map(at).collect()
        };
        assert_eq!(vertices(&bump(0)).len(), 2);
        assert!(vertices(&bump(1)).len() > 4);
    }
}
