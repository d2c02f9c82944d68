//! Profile: vibration of the tool by speed and angle, from a recording of each.
//!
//! Steps of motors, teeth and pulleys shake the tool at frequencies in proportion to the speed. Where they meet a mode,
//! walls get fine ripples.

use crate::motors::{Drive, Motors, motors};
use crate::run::Run;
use crate::symmetry::{Symmetry, symmetry};
use corehbot_twin::ripple::quiet::quiet_and_loud;
use serde::Serialize;

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
    /// How alike directions are that mirror each other, if two of them were measured.
    pub symmetry: Option<Symmetry>,
    /// Each group of motors that a measured direction turns alone.
    pub motors: Vec<Motors>,
}

/// The profile of these runs on a machine with these drives.
#[must_use]
pub fn profile(mut runs: Vec<Run>, drives: &[Drive]) -> Profile {
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
    let (symmetry, motors) = (symmetry(&runs), motors(&runs, drives));
    Profile { runs, angles_deg, speeds, quiet_mm_s, loud_mm_s, symmetry, motors }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Recording;
    use crate::run::run;
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
        let found = profile(runs, &[]);
        assert_eq!(found.angles_deg, [0.0, 45.0, 90.0]);
        assert!(found.loud_mm_s.contains(&120.0) && !found.loud_mm_s.contains(&200.0), "{:?}", found.loud_mm_s);
        assert_eq!(found.quiet_mm_s.last().map(|range| range[1]), Some(200.0), "{:?}", found.quiet_mm_s);
        let loudest = found.runs.iter().max_by(|a, b| a.vibration_mm_s2.total_cmp(&b.vibration_mm_s2)).unwrap();
        assert!(loudest.speed_mm_s == 120.0 && (loudest.loudest_hz - 60.0).abs() < 1.0, "{loudest:?}");
        // 100 mm/s^2 times a gain of 10, and the root of a half.
        assert!((loudest.vibration_mm_s2 / 707.1 - 1.0).abs() < 0.05, "{loudest:?}");
    }
}
