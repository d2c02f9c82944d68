//! Run: vibration of the tool at one speed along one angle, from a recording.

use crate::recording::Recording;
use crate::spectrum::{Spectrum, WINDOW_S};
use serde::Serialize;

/// The band that counts in Hz: below, the tool's own moves; above, sound and not ripple.
pub(crate) const BAND_HZ: [f64; 2] = [10.0, 500.0];

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
    /// All of it.
    #[serde(skip)]
    pub(crate) spectrum: Spectrum,
}

/// Vibration of a run; nothing if the recording is shorter than a window.
#[must_use]
pub fn run(file: &str, [angle_deg, speed_mm_s]: [f64; 2], recording: &Recording) -> Option<Run> {
    let spectrum = Spectrum::new(recording, WINDOW_S)?;
    let bins = spectrum.sum.iter().enumerate().map(|(i, psd)| (i as f64 * spectrum.step_hz, *psd));
    let band: Vec<(f64, f64)> = bins.filter(|(hz, _)| (BAND_HZ[0]..=BAND_HZ[1]).contains(hz)).collect();
    let power = band.iter().map(|(_, psd)| psd).sum::<f64>() * spectrum.step_hz;
    let loudest_hz = band.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(hz, _)| *hz);
    Some(Run { file: file.to_owned(), angle_deg, speed_mm_s, vibration_mm_s2: power.sqrt(), loudest_hz, spectrum })
}
