//! The page of an accelerometer's recordings: spectra, shapers, belt paths, and the profile by speed and angle. It
//! needs no network and has the style of the other pages.

use crate::twin::fill;
use anyhow::{Context as _, Result};
use corehbot_resonance::axis::{Axis, Measured};
use corehbot_resonance::belts::Comparison;
use corehbot_resonance::klipper::{DAMPING, Rated, SPECTRUM_HZ};
use corehbot_resonance::profile::Profile;
use corehbot_resonance::spectrogram::Spectrogram;
use corehbot_twin::shaping::shaper::residual;
use serde::Serialize;
use std::io::Write;

const SCRIPT: &str = include_str!("resonance/page.js");

/// Frequencies of a shaper's curve: from 0 to 200 Hz.
const PLACES: usize = 201;

#[derive(Serialize)]
struct Data<'a> {
    #[serde(rename = "most_Hz")]
    most_hz: f64,
    axes: Vec<Shown<'a>>,
    belts: Option<Paths<'a>>,
    profile: Option<&'a Profile>,
}

#[derive(Serialize)]
struct Shown<'a> {
    #[serde(flatten)]
    axis: &'a Axis,
    /// Of each recording.
    over_time: Vec<Option<&'a Spectrogram>>,
    curves: Vec<Curve>,
}

#[derive(Serialize)]
struct Paths<'a> {
    comparison: &'a Comparison,
    recordings: &'a [Measured; 2],
}

/// The part of the vibration that a shaper leaves, at even frequencies from 0 on.
#[derive(Serialize)]
struct Curve {
    name: String,
    left: Vec<f64>,
}

/// Writes the page.
///
/// # Errors
/// The error from `out`.
pub fn write(
    out: &mut impl Write,
    axes: &[Axis],
    belts: Option<(&Comparison, &[Measured; 2])>,
    profile: Option<&Profile>,
) -> Result<()> {
    let data = Data {
        most_hz: SPECTRUM_HZ,
        axes: axes.iter().map(shown).collect(),
        belts: belts.map(|(comparison, recordings)| Paths { comparison, recordings }),
        profile,
    };
    fill(out, SCRIPT, &data).context("cannot write the report")
}

fn shown(axis: &Axis) -> Shown<'_> {
    let over_time = axis.recordings.iter().map(|recording| recording.over_time.as_ref()).collect();
    Shown { axis, over_time, curves: curves(axis) }
}

/// The suggested shaper and Klipper's.
fn curves(axis: &Axis) -> Vec<Curve> {
    let measured = axis.recordings.iter().find_map(|r| Some(r.fit.as_ref()?.modes.first()?.damping_ratio));
    let curve = |words: &str, rated: &Rated, damping: f64| {
        let impulses = rated.shaper.impulses(rated.frequency_hz, damping);
        let hz = |i: usize| SPECTRUM_HZ * i as f64 / (PLACES - 1) as f64;
        let left = (0..PLACES).map(|i| residual(&impulses, hz(i), measured.unwrap_or(DAMPING)));
        let name = format!("{words}: {} {:.1} Hz", rated.shaper.name(), rated.frequency_hz);
        Curve { name, left: left.map(|v| (v * 1e4).round() / 1e4).collect() }
    };
    let own = axis.suggestion.as_ref().map(|own| curve("suggested", &own.rated, own.damping_ratio));
    let nearest = axis.tool.as_ref().map(|tool| &tool.nearest);
    let nearest = nearest.map(|net| curve("nearest to the walls", &net.rated, net.damping_ratio));
    let lacking = axis.klipper.suggestion.as_ref().filter(|rated| !rated.in_firmware);
    let klippers = lacking.map(|rated| curve("Klipper's", rated, DAMPING));
    own.into_iter().chain(nearest).chain(klippers).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_needs_no_network() {
        assert_eq!(SCRIPT.matches("http").count(), 0);
    }
}
