//! Axis: modes, the shaper that is suggested and its line, and the ranking by what the tool does.
//!
//! The measured spectrum decides, by Klipper's law among the shapers of this firmware: no fit stands between. The
//! firmware's own SHAPER_CALIBRATE has the same law (`src/machine/resonance/choice.rs`). A second ranking tells about
//! the tool: its error on a wall, the worst over the uncertainty of the measured frequency and over all recordings of
//! the axis. It needs a good fit.

use crate::klipper::{self, Choice, DAMPING, Normalised, Rated, SPECTRUM_HZ};
use crate::label;
use crate::modes::{self, Direction, Mode, Modes, Unfitted};
use crate::recording::Recording;
use crate::shapers::Shaper;
use crate::spectrogram::Spectrogram;
use crate::spectrum::{Density, Spectrum, WINDOW_S};
use crate::sweep::Sweep;
use corehbot_twin::shaping::by_tool::{Machines, RINGING, suggested};
use corehbot_twin::shaping::shaper::{Impulse, ShaperKind};
use corehbot_twin::shaping::wall::{Lag, Print, WallError, net_rounding};
use serde::Serialize;

/// Least uncertainty of a frequency, as a part of it. One place was measured, with one load, cold.
pub const LEAST_UNCERTAINTY: f64 = 0.05;

/// A fit with greater differences is poor, in dB: a factor of 1.4 in amplitude.
pub const POOR_DB: f64 = 3.0;

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
    /// Samples a second; nothing for a file with a spectrum.
    #[serde(rename = "rate_Hz")]
    pub rate_hz: Option<f64>,
    /// Duration; nothing for a file with a spectrum.
    pub lasts_s: Option<f64>,
    /// Small flaws.
    pub remarks: Vec<String>,
    /// Density up to 200 Hz.
    pub spectrum: Spectrum,
    /// The sum as Klipper chooses shapers by it.
    #[serde(skip)]
    pub normalised: Vec<f64>,
    /// Power over time, for the page.
    #[serde(skip)]
    pub over_time: Option<Spectrogram>,
    /// The fit; nothing if there is none, and then the remarks say why.
    pub fit: Option<Modes>,
    /// Whether the response has a peak: without one there is nothing for a shaper to do.
    pub rings: bool,
}

impl Measured {
    /// The density above a frequency of no interest is left out, and a fit that failed is told.
    fn finished(mut self, fit: Result<Modes, Unfitted>) -> Self {
        let count = (SPECTRUM_HZ / self.spectrum.step_hz) as usize + 1;
        self.spectrum.sum.truncate(count);
        self.spectrum.axes.iter_mut().for_each(|axis| axis.truncate(count));
        self.normalised.truncate(count);
        self.rings = !matches!(fit, Err(Unfitted::Flat));
        if let Err(error) = &fit {
            self.remarks.push(error.to_string());
        }
        self.fit = fit.ok();
        self
    }
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
    /// The one that keeps the tool nearest to the wall, or the shortest of nearly equal ones.
    pub nearest: Net,
    /// The suggestion by the same measure.
    pub suggested: Option<Net>,
}

/// The shaper that is suggested.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Suggestion {
    /// It, played against the measured spectrum.
    #[serde(flatten)]
    pub rated: Rated,
    /// Damping that it is made for.
    pub damping_ratio: f64,
    /// The line that sets it, if x or y was measured.
    pub line: Option<String>,
    /// How it was found, and what speaks for others.
    pub why: String,
}

/// Results for an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Which, if it is known.
    pub axis: Option<label::Axis>,
    /// Its recordings.
    pub recordings: Vec<Measured>,
    /// The suggested shaper; nothing if no recording has a peak.
    pub suggestion: Option<Suggestion>,
    /// Klipper's ranking.
    pub klipper: Choice,
    /// The ranking by what the tool does; nothing without a good fit.
    pub tool: Option<Ranking>,
}

/// Spectrum and modes of a recording.
///
/// # Errors
/// It is shorter than a window.
pub fn measure(named: Named, axis: Option<label::Axis>, sweep: &Sweep) -> Result<Measured, Unfitted> {
    let Named { file, recording } = named;
    let spectrum = Spectrum::new(recording, WINDOW_S).ok_or(Unfitted::Short)?;
    let lasts_s = recording.axes[0].len() as f64 / recording.rate_hz;
    let mut remarks = recording.remarks.clone();
    let expected_s = sweep.lasts_s();
    if !(0.9..1.5).contains(&(lasts_s / expected_s)) {
        remarks.push(format!(
            "it lasts {lasts_s:.0} s, a sweep from {} to {} Hz {expected_s:.0} s; give the sweep's own range and growth",
            sweep.from_hz, sweep.to_hz
        ));
    }
    let direction = Direction::of(recording, axis, sweep);
    if let (Direction::Strongest(unit, true), Some(axis)) = (direction, axis) {
        let [x, y, z] = unit.map(f64::abs);
        let letter = if x >= y && x >= z {
            'x'
        } else if y >= z {
            'y'
        } else {
            'z'
        };
        remarks.push(format!(
            "the sensor hardly moves along {}, most along its own {letter}: the modes are those of this direction; \
             check the file's name and how the sensor's axes are set",
            axis.letter()
        ));
    }
    let measured = Measured {
        file: file.to_owned(),
        rate_hz: Some(recording.rate_hz),
        lasts_s: Some(lasts_s),
        remarks,
        normalised: spectrum.normalised(),
        spectrum,
        over_time: Some(Spectrogram::new(recording, SPECTRUM_HZ)),
        fit: None,
        rings: true,
    };
    Ok(measured.finished(modes::fit_along(recording, direction, sweep)))
}

/// Spectrum and modes of a file with a spectrum.
#[must_use]
pub fn measure_density(file: &str, density: &Density, axis: Option<label::Axis>, sweep: &Sweep) -> Measured {
    let measured = Measured {
        file: file.to_owned(),
        rate_hz: None,
        lasts_s: None,
        remarks: Vec::new(),
        normalised: density.normalised(),
        spectrum: density.spectrum.clone(),
        over_time: None,
        fit: None,
        rings: true,
    };
    measured.finished(modes::fit_density(density, axis, sweep))
}

/// Judges an axis by its recordings.
#[must_use]
pub fn judge(axis: Option<label::Axis>, recordings: Vec<Measured>, question: &Question) -> Axis {
    let spectra = recordings.iter().map(|r| Normalised { step_hz: r.spectrum.step_hz, psd: &r.normalised });
    let spectra: Vec<Normalised> = spectra.collect();
    let klipper = klipper::choose(&spectra);
    let own = klipper.in_firmware.filter(|_| recordings.iter().any(|r| r.rings));
    let tool = rank(&recordings, &spectra, own.as_ref(), question);
    let suggestion = own.map(|rated| Suggestion {
        rated,
        damping_ratio: DAMPING,
        line: axis.and_then(|axis| line(axis, &rated)),
        why: why(&rated, klipper.suggestion.as_ref(), tool.as_ref(), &recordings),
    });
    Axis { axis, recordings, suggestion, klipper, tool }
}

/// Whether a fit tells enough of the response.
fn is_good(fit: &Modes) -> bool {
    fit.fit_error_db <= POOR_DB
}

fn rank(recordings: &[Measured], spectra: &[Normalised], own: Option<&Rated>, question: &Question) -> Option<Ranking> {
    if !recordings.iter().filter_map(|r| r.fit.as_ref()).all(is_good) {
        return None;
    }
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
            rated: klipper::rated(shaper, frequency_hz, damping, spectra),
            damping_ratio: damping,
            net_rounding_a_per_w2: net_rounding(&impulses, &modes),
            wall: machines.error(&impulses),
            worst_wall: machines.worst(&impulses),
        }
    };
    let best = |kind: ShaperKind| net(Shaper::Own(kind), machines.frequency_hz(kind), damping);
    // The shortest comes first here.
    let mut shapers: Vec<Net> = ShaperKind::ALL.into_iter().map(best).collect();
    let errors: Vec<f64> = shapers.iter().map(|s| s.worst_wall.rms_um).collect();
    let nearest = *shapers.get(suggested(&errors)?)?;
    shapers.sort_by(|a, b| a.worst_wall.rms_um.total_cmp(&b.worst_wall.rms_um));
    let suggested = own.map(|own| net(own.shaper, own.frequency_hz, DAMPING));
    let unshaped_wall = machines.error(&[Impulse { amount: 1.0, time_s: 0.0 }]);
    Some(Ranking { uncertainty, print, most_ringing: RINGING, unshaped_wall, shapers, nearest, suggested })
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
fn line(axis: label::Axis, rated: &Rated) -> Option<String> {
    let Shaper::Own(kind) = rated.shaper else { return None };
    matches!(axis, label::Axis::X | label::Axis::Y).then(|| {
        let (letter, number) = (axis.letter(), kind.number());
        format!("M593 {letter} F{:.1} D{DAMPING:.3} T{number}", rated.frequency_hz)
    })
}

/// How the suggestion was found, and what speaks for others.
fn why(own: &Rated, klippers: Option<&Rated>, tool: Option<&Ranking>, recordings: &[Measured]) -> String {
    let percent = |rated: &Rated| format!("{:.1} %", 100.0 * rated.remaining_vibration);
    let mut parts = vec![format!(
        "{} at {:.1} Hz leaves {} of the vibration that was measured. The spectrum decides, by Klipper's law.",
        own.shaper.name(),
        own.frequency_hz,
        percent(own)
    )];
    if let Some(theirs) = klippers.filter(|theirs| !theirs.in_firmware) {
        let (name, hz) = (theirs.shaper.name(), theirs.frequency_hz);
        let left = percent(theirs);
        parts.push(format!(
            "Klipper would take {name} at {hz:.1} Hz, which leaves {left}. This firmware does not have it."
        ));
    }
    let poor = recordings.iter().filter_map(|r| r.fit.as_ref()).filter(|fit| !is_good(fit));
    if let Some(fit) = poor.max_by(|a, b| a.fit_error_db.total_cmp(&b.fit_error_db)) {
        parts.push(format!(
            "The fit is poor, within {:.1} dB: it lacks modes, so walls are not ranked by it.",
            fit.fit_error_db
        ));
    }
    if let Some((nearest, suggested)) = tool.and_then(|tool| Some((&tool.nearest, tool.suggested.as_ref()?)))
        && nearest.worst_wall.rms_um < suggested.worst_wall.rms_um
    {
        let rated = &nearest.rated;
        parts.push(format!(
            "By the fitted modes {} at {:.1} Hz keeps the tool nearer to the walls, {:.1} um RMS against {:.1} um at \
             the worst: the belts lag, and that cancels most of a shaper's rounding. But it leaves {} of the measured \
             vibration.",
            rated.shaper.name(),
            rated.frequency_hz,
            nearest.worst_wall.rms_um,
            suggested.worst_wall.rms_um,
            percent(rated)
        ));
    }
    parts.join(" ")
}
