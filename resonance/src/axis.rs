//! Axis: modes, Klipper's ranking, the ranking by what the tool does, and the line that sets the shaper.
//!
//! Klipper rates the command that leaves the shaper. The second ranking rates the tool: its error on a wall, the worst
//! over the uncertainty of the measured frequency and over all recordings of the axis.

use crate::klipper::{self, Choice, DAMPING, Normalised, Rated, SPECTRUM_HZ};
use crate::label;
use crate::modes::{self, Mode, Modes};
use crate::recording::Recording;
use crate::shapers::Shaper;
use crate::spectrum::{Spectrum, WINDOW_S};
use crate::sweep::Sweep;
use crate::wall::{Print, Unshaped, WallError, net_rounding};
use corehbot_twin::shaping::shaper::{Impulse, residual};
use serde::Serialize;

/// Least uncertainty of a frequency, as a part of it. One place was measured, with one load, cold.
pub const LEAST_UNCERTAINTY: f64 = 0.05;

/// Shapers within this factor of the least error are equally good; the one with the shorter delay is suggested.
const ALIKE: f64 = 1.03;

/// A shaper may leave this part of the ringing at the measured frequency, as EI's are made for. Without this limit a
/// short shaper would be set too high: it rounds less and rings more.
const RINGING: f64 = 0.05;

/// Frequencies of a shaper that are tried, over the frequency of the strongest mode.
const TRIED: [f64; 2] = [0.6, 2.2];

/// Steps of the first search, and of the one around its best.
const STEPS: [usize; 2] = [64, 8];

/// Dampings for which all fits of shapers hold, and frequencies in Hz that this firmware takes (`settings::ranges`).
const DAMPINGS: [f64; 2] = [0.0, 0.3];
const FREQUENCIES: [f64; 2] = [10.0, 500.0];

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
    Ok(Measured { file: file.to_owned(), rate_hz: recording.rate_hz, lasts_s, remarks, spectrum, fit: fit.ok() })
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

/// The machine that is simulated, as often as the frequency is uncertain.
struct Machines {
    nominal: Unshaped,
    others: Vec<Unshaped>,
}

impl Machines {
    fn worst(&self, impulses: &[Impulse]) -> WallError {
        let all = std::iter::once(&self.nominal).chain(&self.others).map(|machine| machine.error(impulses));
        all.max_by(|a, b| a.rms_um.total_cmp(&b.rms_um)).unwrap_or_default()
    }
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
    let strongest = first(modes);
    let measured = order.iter().map(|modes| 2.0 * first(modes).frequency_error_hz / first(modes).frequency_hz);
    let uncertainty = question.uncertainty.unwrap_or_else(|| measured.fold(LEAST_UNCERTAINTY, f64::max));
    let print = question.print;
    let machine = |modes: &[Mode], factor: f64| Unshaped::new(&print, modes, factor);
    let others = order.iter().flat_map(|modes| [1.0 - uncertainty, 1.0, 1.0 + uncertainty].map(|f| machine(modes, f)));
    let machines = Machines { nominal: machine(modes, 1.0), others: others.collect() };
    let damping = strongest.damping_ratio.clamp(DAMPINGS[0], DAMPINGS[1]);
    // As the line has them.
    let damping = (damping * 1000.0).round() / 1000.0;
    let net = |shaper: Shaper, frequency_hz: f64, damping: f64| {
        let impulses = shaper.impulses(frequency_hz, damping);
        Net {
            rated: klipper::rated(shaper, frequency_hz, spectra),
            damping_ratio: damping,
            net_rounding_a_per_w2: net_rounding(&impulses, modes),
            wall: machines.nominal.error(&impulses),
            worst_wall: machines.worst(&impulses),
        }
    };
    let best = |shaper: Shaper| {
        let worst = |hz: f64| {
            let impulses = shaper.impulses(hz, damping);
            let ringing = residual(&impulses, strongest.frequency_hz, strongest.damping_ratio);
            // Beyond the limit the nearest to it is the best.
            if ringing > RINGING { 1e6 * ringing } else { machines.worst(&impulses).rms_um }
        };
        let search = |from: f64, to: f64, steps: usize| {
            let tried = (0..=steps).map(|i| from * (to / from).powf(i as f64 / steps as f64));
            let tried = tried.map(|hz| (hz, worst(hz)));
            tried.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(from, |(hz, _)| hz)
        };
        let f = strongest.frequency_hz;
        let coarse = search(TRIED[0] * f, TRIED[1] * f, STEPS[0]);
        let width = (TRIED[1] / TRIED[0]).powf(1.0 / STEPS[0] as f64);
        let fine = search(coarse / width, coarse * width, STEPS[1]).clamp(FREQUENCIES[0], FREQUENCIES[1]);
        net(shaper, (fine * 10.0).round() / 10.0, damping)
    };
    let own = Shaper::ALL.into_iter().filter(|shaper| shaper.in_firmware());
    let mut shapers: Vec<Net> = own.map(best).collect();
    let least = shapers.iter().map(|s| s.worst_wall.rms_um).fold(f64::INFINITY, f64::min);
    // The shortest comes first here.
    let suggestion = *shapers.iter().find(|s| s.worst_wall.rms_um <= ALIKE * least)?;
    shapers.sort_by(|a, b| a.worst_wall.rms_um.total_cmp(&b.worst_wall.rms_um));
    let klippers = klipper.suggestion.map(|chosen| net(chosen.shaper, chosen.frequency_hz, DAMPING));
    let unshaped_wall = machines.nominal.error(&[Impulse { amount: 1.0, time_s: 0.0 }]);
    let line = axis.and_then(|axis| line(axis, &suggestion));
    let why = why(&suggestion, klippers.as_ref(), uncertainty);
    Some(Ranking { uncertainty, print, most_ringing: RINGING, unshaped_wall, shapers, suggestion, klippers, line, why })
}

/// The strongest mode; the caller has left out fits without any.
fn first(modes: &[Mode]) -> Mode {
    modes.first().copied().unwrap_or(Mode {
        frequency_hz: 50.0,
        frequency_error_hz: 0.0,
        damping_ratio: 0.1,
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
