//! Modes: frequencies and dampings, fitted to the response of the tool to a sweep.
//!
//! The power of the measured acceleration is fitted by the commanded power times |H|^2, with a sum of modes
//!
//! ```text
//! H = sum g (1 + 2 i s z r) / (1 - r^2 + 2 i z r),   r = f / f_mode
//! ```
//!
//! The share s of the damping acts between motor and tool, as in a belt. The rest acts between tool and frame, as the
//! friction of a guide does. Only magnitudes count: the phase depends on when the sensor's clock sampled. A peak of the
//! density alone would be at the nearest of its frequencies, and its width is the width of the window. A half width
//! gives half of the damping or twice of it.
//!
//! | file | job |
//! |---|---|
//! | `points` | recordings and spectra to bands of frequencies, each with its commanded and measured power |
//! | `knots` | the bins of a spectrum that a file has on a finer grid |
//! | `model` | the power of a band by the modes, and its derivatives |
//! | `search` | the modes with the least differences, and how many there are |

mod knots;
mod model;
mod points;
mod search;

pub(crate) use points::{Direction, fit_sources};
pub use search::WORTH;

use crate::label::Axis;
use crate::recording::Recording;
use crate::spectrum::Density;
use crate::sweep::Sweep;
use serde::Serialize;

/// A mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// Its frequency.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Standard error of the frequency by the fit.
    #[serde(rename = "frequency_error_Hz")]
    pub frequency_error_hz: f64,
    /// Damping as a ratio to critical damping.
    pub damping_ratio: f64,
    /// Standard error of the damping by the fit.
    pub damping_ratio_error: f64,
    /// Its part in the slow motion of the tool; all parts add up to 1. A negative part moves against the command.
    pub part: f64,
}

/// Result of a fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Modes {
    /// The modes, the strongest peak first.
    pub modes: Vec<Mode>,
    /// Share of the damping that acts between motor and tool, of 1; the rest acts between tool and frame.
    pub belt_damping_share: f64,
    /// Its standard error by the fit: weak damping does not tell where it acts.
    pub belt_damping_share_error: f64,
    /// Root mean square of the fit's differences, in dB.
    #[serde(rename = "fit_error_dB")]
    pub fit_error_db: f64,
    /// The fitted frequencies.
    #[serde(rename = "frequencies_Hz")]
    pub frequencies_hz: Vec<f64>,
    /// Measured |H| at each.
    pub measured: Vec<f64>,
    /// The fitted one.
    pub fitted: Vec<f64>,
}

/// Why there are no modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfitted {
    /// The recording or the sweep is too short.
    Short,
    /// The response is no higher at any frequency than around it.
    Flat,
    /// The response has peaks, and no modes fit it.
    Unclear,
}

impl std::fmt::Display for Unfitted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Short => "the recording or the sweep is too short for a fit",
            Self::Flat => "no mode was found: the response has no peak within the sweep",
            Self::Unclear => "no mode was found: the response has peaks, but modes do not fit it",
        })
    }
}

impl std::error::Error for Unfitted {}

/// Modes of the tool that this sweep excited, along its axis.
///
/// # Errors
/// Nothing can be fitted.
pub fn fit(recording: &Recording, axis: Option<Axis>, sweep: &Sweep) -> Result<Modes, Unfitted> {
    let direction = Direction::of(recording, axis, sweep);
    fit_along(recording, direction, sweep)
}

/// Modes of the tool along a direction.
pub(crate) fn fit_along(recording: &Recording, direction: Direction, sweep: &Sweep) -> Result<Modes, Unfitted> {
    search::fitted(&points::of_recording(recording, sweep, direction.unit()).ok_or(Unfitted::Short)?)
}

/// Modes by a file with a spectrum. Its windows are wide, so a damping below 0.03 is only coarsely known.
///
/// # Errors
/// Nothing can be fitted.
pub fn fit_density(density: &Density, axis: Option<Axis>, sweep: &Sweep) -> Result<Modes, Unfitted> {
    let mut best = Err(Unfitted::Short);
    for part in points::NOISES {
        let Some(data) = points::of_density(density, sweep, axis, part) else { break };
        best = match (search::fitted(&data), best) {
            (Ok(found), Ok(known)) if found.is_better(&known) => Ok(found),
            (_, Ok(known)) => Ok(known),
            (found, Err(_)) => found,
        };
    }
    best
}

impl Modes {
    /// Whether a fit to the same points explains them better, with as many modes or fewer.
    fn is_better(&self, other: &Self) -> bool {
        let more = self.modes.len() as i32 - other.modes.len() as i32;
        self.fit_error_db < other.fit_error_db * WORTH.powi(more)
    }
}
