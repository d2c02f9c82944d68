//! Axis: modes, Klipper's ranking, the ranking by what the tool does, and the line that sets the shaper.
//!
//! Klipper rates the command that leaves the shaper. The second ranking rates the tool: its error on a wall, the worst
//! over the uncertainty of the measured frequency and over all recordings of the axis.

use crate::klipper::{self, Choice, DAMPING, Normalised, Rated, SPECTRUM_HZ};
use crate::label;
use crate::modes::{self, Mode, Modes};
use crate::recording::Recording;
use crate::shapers::Shaper;
use crate::spectrogram::Spectrogram;
use crate::spectrum::{Spectrum, WINDOW_S};
use crate::sweep::Sweep;
use corehbot_twin::shaping::by_tool::{Machines, RINGING, suggested};
use corehbot_twin::shaping::shaper::{Impulse, Kind};
use corehbot_twin::shaping::wall::{Lag, Print, WallError, net_rounding};
use serde::Serialize;

/// Least uncertainty of a frequency, as a part of it. One place was measured, with one load, cold.
pub const LEAST_UNCERTAINTY: f64 = 0.05;

/// How an axis is judged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Question {
    /// The sweep of the recordings.
    pub sweep: Sweep,
    /// The print with the walls that count.
    pub print: Print,
    /// Uncertainty of the frequency as a part of it; nothing is as measured.
    pub uncertainty: Option<f64>,
}

/// A named recording.
#[derive(Clone, Copy, Debug)]
pub struct Named<'r> {
    /// Its file.
    pub file: &'r str,
    /// Its samples.
    pub recording: &'r Recording,
}

/// A recording, its spectrum and its modes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// The file.
    pub file: String,
    /// Samples a second.
    #[serde(rename = "rate_Hz")]
    pub rate_hz: f64,
    /// Duration.
    pub lasts_s: f64,
    /// Small flaws.
    pub remarks: Vec<String>,
    /// Density up to 200 Hz.
    pub spectrum: Spectrum,
    /// Power over time, for the page.
    #[serde(skip)]
    pub over_time: Spectrogram,
    /// The fit; nothing if there is none, and then the remarks say why.
    pub fit: Option<Modes>,
}

/// A shaper by what the tool does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Net {
    /// The shaper as Klipper would rate it.
    #[serde(flatten)]
    pub rated: Rated,
    /// Damping that it is made for.
    pub damping_ratio: f64,
    /// Error of slow changes in `a/w^2`; positive is inside of a corner.
    pub net_rounding_a_per_w2: f64,
    /// Error of the wall at the measured frequency.
    pub wall: WallError,
    /// The worst over all recordings and the uncertainty.
    pub worst_wall: WallError,
}

/// The ranking by what the tool does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ranking {
    /// Uncertainty of the frequency, of 1.
    pub uncertainty: f64,
    /// The print with the walls that count.
    pub print: Print,
    /// Most of the ringing that a shaper may leave at the measured frequency, of 1.
    pub most_ringing: f64,
    /// Without a shaper.
    pub unshaped_wall: WallError,
    /// The best of each kind, the least error first.
    pub shapers: Vec<Net>,
    /// The suggested one.
    pub suggestion: Net,
    /// Klipper's suggestion by the same measure.
    pub klippers: Option<Net>,
    /// The line that sets it, if x or y was measured.
    pub line: Option<String>,
    /// Why it is or is not Klipper's.
    pub why: String,
}

/// Results for an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Which, if it is known.
    pub axis: Option<label::Axis>,
    /// Its recordings.
    pub recordings: Vec<Measured>,
    /// Klipper's ranking.
    pub klipper: Choice,
    /// The ranking by what the tool does; nothing without modes.
    pub tool: Option<Ranking>,
}

/// Spectrum and modes of a recording.
///
/// # Errors
/// It is shorter than a window.
pub fn measure(named: Named, sweep: &Sweep) -> Result<Measured, modes::Unfitted> {
    let Named { file, recording } = named;
    let mut spectrum = Spectrum::new(recording, WINDOW_S).ok_or(modes::Unfitted::Short)?;
    let count = (SPECTRUM_HZ / spectrum.step_hz) as usize + 1;
    spectrum.sum.truncate(count);
    spectrum.axes.iter_mut().for_each(|axis| axis.truncate(count));
    let lasts_s = recording.axes[0].len() as f64 / recording.rate_hz;
    let mut remarks = recording.remarks.clone();
    let expected_s = sweep.lasts_s();
    if !(0.9..1.5).contains(&(lasts_s / expected_s)) {
        remarks.push(format!(
            "it lasts {lasts_s:.0} s, a sweep from {} to {} Hz {expected_s:.0} s; give the sweep's own range and growth",
            sweep.from_hz, sweep.to_hz
        ));
    }
    let fit = modes::fit(recording, sweep);
    if let Err(error) = &fit {
        remarks.push(error.to_string());
    }
    let over_time = Spectrogram::new(recording, SPECTRUM_HZ);
    let (file, rate_hz) = (file.to_owned(), recording.rate_hz);
    Ok(Measured { file, rate_hz, lasts_s, remarks, spectrum, over_time, fit: fit.ok() })
}

/// Judges an axis by its recordings.
#[must_use]
pub fn judge(axis: Option<label::Axis>, recordings: Vec<Measured>, question: &Question) -> Axis {
    let normalised: Vec<Vec<f64>> = recordings.iter().map(|r| r.spectrum.normalised()).collect();
    let spectra = recordings.iter().zip(&normalised).map(|(r, psd)| Normalised { step_hz: r.spectrum.step_hz, psd });
    let spectra: Vec<Normalised> = spectra.collect();
    let klipper = klipper::choose(&spectra);
    let tool = rank(axis, &recordings, &spectra, &klipper, question);
    Axis { axis, recordings, klipper, tool }
}

fn rank(
    axis: Option<label::Axis>,
    recordings: &[Measured],
    spectra: &[Normalised],
    klipper: &Choice,
    question: &Question,
) -> Option<Ranking> {
    let all: Vec<&[Mode]> = recordings.iter().filter_map(|r| r.fit.as_ref()).map(|fit| fit.modes.as_slice()).collect();
    // The recording in the middle stands for the axis.
    let mut order: Vec<&&[Mode]> = all.iter().filter(|modes| !modes.is_empty()).collect();
    order.sort_by(|a, b| first(a).frequency_hz.total_cmp(&first(b).frequency_hz));
    let modes: &[Mode] = order.get(order.len() / 2)?;
    let measured = order.iter().map(|modes| 2.0 * first(modes).frequency_error_hz / first(modes).frequency_hz);
    let uncertainty = question.uncertainty.unwrap_or_else(|| measured.fold(LEAST_UNCERTAINTY, f64::max));
    let print = question.print;
    let all: Vec<Vec<Lag>> = order.iter().map(|modes| lags(modes)).collect();
    let factors = [1.0 - uncertainty, 1.0, 1.0 + uncertainty];
    let others = all.iter().flat_map(|modes| factors.map(|factor| (modes.as_slice(), factor)));
    let modes = lags(modes);
    let machines = Machines::new(&print, &modes, others)?;
    let damping = machines.damping();
    let net = |shaper: Shaper, frequency_hz: f64, damping: f64| {
        let impulses = shaper.impulses(frequency_hz, damping);
        Net {
            rated: klipper::rated(shaper, frequency_hz, spectra),
            damping_ratio: damping,
            net_rounding_a_per_w2: net_rounding(&impulses, &modes),
            wall: machines.error(&impulses),
            worst_wall: machines.worst(&impulses),
        }
    };
    let best = |kind: Kind| net(Shaper::Own(kind), machines.frequency_hz(kind), damping);
    // The shortest comes first here.
    let mut shapers: Vec<Net> = Kind::ALL.into_iter().map(best).collect();
    let errors: Vec<f64> = shapers.iter().map(|s| s.worst_wall.rms_um).collect();
    let suggestion = *shapers.get(suggested(&errors)?)?;
    shapers.sort_by(|a, b| a.worst_wall.rms_um.total_cmp(&b.worst_wall.rms_um));
    let klippers = klipper.suggestion.map(|chosen| net(chosen.shaper, chosen.frequency_hz, DAMPING));
    let unshaped_wall = machines.error(&[Impulse { amount: 1.0, time_s: 0.0 }]);
    let line = axis.and_then(|axis| line(axis, &suggestion));
    let why = why(&suggestion, klippers.as_ref(), uncertainty);
    Some(Ranking { uncertainty, print, most_ringing: RINGING, unshaped_wall, shapers, suggestion, klippers, line, why })
}

/// Modes as the walls need them.
fn lags(modes: &[Mode]) -> Vec<Lag> {
    let lag = |mode: &Mode| Lag { frequency_hz: mode.frequency_hz, damping_ratio: mode.damping_ratio, part: mode.part };
    modes.iter().map(lag).collect()
}

/// The strongest mode; the caller has left out fits without any.
fn first(modes: &[Mode]) -> Mode {
    modes.first().copied().unwrap_or(Mode {
        frequency_hz: 50.0,
        frequency_error_hz: 0.0,
        damping_ratio: 0.1,
        damping_ratio_error: 0.0,
        part: 1.0,
    })
}

/// The line that sets a shaper.
fn line(axis: label::Axis, net: &Net) -> Option<String> {
    let Shaper::Own(kind) = net.rated.shaper else { return None };
    matches!(axis, label::Axis::X | label::Axis::Y).then(|| {
        let (letter, number) = (axis.letter(), kind.number());
        format!("M593 {letter} F{:.1} D{:.3} T{number}", net.rated.frequency_hz, net.damping_ratio)
    })
}

/// Why the suggestion is or is not Klipper's.
fn why(own: &Net, klippers: Option<&Net>, uncertainty: f64) -> String {
    let Some(theirs) = klippers else { return "Klipper's law has no suggestion for this spectrum.".to_owned() };
    let (a, b) = (own.rated.shaper.name(), theirs.rated.shaper.name());
    let over = format!("over {:.0} % of uncertainty of the frequency", 100.0 * uncertainty);
    let errors = format!("{:.1} um ({a}) against {:.1} um ({b})", own.worst_wall.rms_um, theirs.worst_wall.rms_um);
    if own.rated.shaper == theirs.rated.shaper {
        let frequencies = format!("{:.1} Hz against {:.1} Hz", own.rated.frequency_hz, theirs.rated.frequency_hz);
        return format!(
            "Klipper suggests {b} too; frequencies are {frequencies}. Here the frequency is the one with the least error \
             of the wall {over}, and the damping is the measured one; Klipper takes 0.1."
        );
    }
    let lag = format!(
        "the belts lag, and that cancels most of a shaper's rounding: {:.2} a/w^2 are left of it with {a}, {:.2} with {b}",
        own.net_rounding_a_per_w2, theirs.net_rounding_a_per_w2
    );
    let lacks = if theirs.rated.in_firmware { "" } else { " This firmware does not have Klipper's." };
    format!(
        "Klipper suggests {b} at {:.1} Hz, because it counts how much the shaper rounds the command. The tool does \
         otherwise: {lag}. So the wall is off by {errors}, RMS at the worst {over}.{lacks}",
        theirs.rated.frequency_hz
    )
}
