//! Profile: vibration of the tool by speed and angle, from a recording of each.
//!
//! Steps of motors, teeth and pulleys shake the tool at frequencies in proportion to the speed. Where they meet a mode,
//! walls get fine ripples. A recording is taken at constant speed along one angle.

use crate::recording::Recording;
use crate::spectrum::{Spectrum, WINDOW_S};
use corehbot_twin::ripple::quiet::quiet_and_loud;
use serde::Serialize;

/// The band that counts in Hz: below, the tool's own moves; above, sound and not ripple.
const BAND_HZ: [f64; 2] = [10.0, 500.0];

/// A run at one speed along one angle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// The file.
    pub file: String,
    /// Direction, from x to y.
    pub angle_deg: f64,
    /// Speed.
    pub speed_mm_s: f64,
    /// Root mean square of the acceleration in the band.
    pub vibration_mm_s2: f64,
    /// Frequency of the strongest vibration.
    #[serde(rename = "loudest_Hz")]
    pub loudest_hz: f64,
}

/// Vibration of a speed over all angles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Speed {
    /// Speed.
    pub speed_mm_s: f64,
    /// Mean of all angles.
    pub mean_mm_s2: f64,
    /// The loudest angle.
    pub max_mm_s2: f64,
}

/// Vibration by speed and angle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Profile {
    /// All runs, by angle and speed.
    pub runs: Vec<Run>,
    /// Angles that were measured.
    pub angles_deg: Vec<f64>,
    /// Every speed.
    pub speeds: Vec<Speed>,
    /// Ranges of speed without much vibration along any angle.
    pub quiet_mm_s: Vec<[f64; 2]>,
    /// Speeds to avoid.
    pub loud_mm_s: Vec<f64>,
}

/// Vibration of a run; nothing if the recording is shorter than a window.
#[must_use]
pub fn run(file: &str, [angle_deg, speed_mm_s]: [f64; 2], recording: &Recording) -> Option<Run> {
    let spectrum = Spectrum::new(recording, WINDOW_S)?;
    let bins = spectrum.sum.iter().enumerate().map(|(i, psd)| (i as f64 * spectrum.step_hz, *psd));
    let band: Vec<(f64, f64)> = bins.filter(|(hz, _)| (BAND_HZ[0]..=BAND_HZ[1]).contains(hz)).collect();
    let power = band.iter().map(|(_, psd)| psd).sum::<f64>() * spectrum.step_hz;
    let loudest_hz = band.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(hz, _)| *hz);
    Some(Run { file: file.to_owned(), angle_deg, speed_mm_s, vibration_mm_s2: power.sqrt(), loudest_hz })
}

/// The profile of these runs.
#[must_use]
pub fn profile(mut runs: Vec<Run>) -> Profile {
    runs.sort_by(|a, b| a.angle_deg.total_cmp(&b.angle_deg).then(a.speed_mm_s.total_cmp(&b.speed_mm_s)));
    let different = |of: fn(&Run) -> f64| {
        let mut all: Vec<f64> = runs.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let (angles_deg, values) = (different(|run| run.angle_deg), different(|run| run.speed_mm_s));
    let speed = |speed: &f64| {
        let here = || runs.iter().filter(|run| run.speed_mm_s == *speed).map(|run| run.vibration_mm_s2);
        let mean_mm_s2 = here().sum::<f64>() / here().count().max(1) as f64;
        Speed { speed_mm_s: *speed, mean_mm_s2, max_mm_s2: here().fold(0.0, f64::max) }
    };
    let speeds: Vec<Speed> = values.iter().map(speed).collect();
    let loudest: Vec<(f64, f64)> = speeds.iter().map(|s| (s.speed_mm_s, s.max_mm_s2)).collect();
    let (quiet_mm_s, loud_mm_s) = quiet_and_loud(&loudest);
    Profile { runs, angles_deg, speeds, quiet_mm_s, loud_mm_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Teeth of 2 mm shake a mode at 60 Hz: it is loud at 120 mm/s, along every angle.
    #[test]
    fn a_speed_that_meets_a_mode_is_loud() {
        let mut runs = Vec::new();
        for angle in [0.0, 45.0, 90.0] {
            for speed in (40..=200).step_by(10).map(f64::from) {
                let f = speed / 2.0;
                let gain = 1.0 / ((1.0 - (f / 60.0_f64).powi(2)).powi(2) + (0.1 * f / 60.0).powi(2)).sqrt();
                let samples: Vec<f64> =
                    (0..6400).map(|i| 100.0 * gain * (TAU * f * f64::from(i) / 3200.0).sin()).collect();
                let still = vec![0.0; samples.len()];
                let recording =
                    Recording { rate_hz: 3200.0, axes: [samples, still.clone(), still], remarks: Vec::new() };
                runs.push(run("run", [angle, speed], &recording).unwrap());
            }
        }
        let found = profile(runs);
        assert_eq!(found.angles_deg, [0.0, 45.0, 90.0]);
        assert!(found.loud_mm_s.contains(&120.0) && !found.loud_mm_s.contains(&200.0), "{:?}", found.loud_mm_s);
        assert_eq!(found.quiet_mm_s.last().map(|range| range[1]), Some(200.0), "{:?}", found.quiet_mm_s);
        let loudest = found.runs.iter().max_by(|a, b| a.vibration_mm_s2.total_cmp(&b.vibration_mm_s2)).unwrap();
        assert!(loudest.speed_mm_s == 120.0 && (loudest.loudest_hz - 60.0).abs() < 1.0, "{loudest:?}");
        // 100 mm/s^2 times a gain of 10, and the root of a half.
        assert!((loudest.vibration_mm_s2 / 707.1 - 1.0).abs() < 0.05, "{loudest:?}");
    }
}
