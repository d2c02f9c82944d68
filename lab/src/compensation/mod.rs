//! Compensation: steps that move the motors ahead by the tool's lag.
//!
//! The lag is known: belts and fields deflect under inertia and friction ([`lag`]). It needs the acceleration of the
//! intended path. The times of the steps give this far more accurately than the steps themselves ([`path`]). The sum is
//! cut into new steps (`stepping`), or into chords for a planner ([`chords`]).

pub mod chords;
mod error;
pub mod lag;
pub mod path;
mod stepping;

use corehbot_twin::geometry::workspace;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::steps::StepTrace;
pub use error::CompensationError;
use lag::Lag;
use path::Path;

/// The longest trace in s: samples of its path take 0.9 GB of memory for an hour.
const LONGEST_S: f64 = 3600.0;

/// Compensated steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Compensated {
    /// The steps.
    pub steps: StepTrace,
    /// Maximum lead of the tool, along x and y.
    pub ahead_mm: [f64; 2],
}

/// Compensates steps of a machine with its tool at `start` at first, and with the stiffness and masses of `believed`. A
/// Gaussian of this width (standard deviation) smooths the path before its acceleration is taken. A longer one misses
/// ringing, a shorter one lets steps through. A millisecond is best for modes of 50 to 110 Hz (docs/research/twin.md).
///
/// # Errors
/// The trace is of another kind of machine, lasts too long, leaves the reach, or has motors that step too fast.
pub fn compensate(
    machine: Machine,
    believed: &Params,
    start: Place,
    trace: &StepTrace,
    width_s: f64,
) -> Result<Compensated, CompensationError> {
    let path = path_of(machine, believed, trace)?;
    let lead = lead(machine, believed, start, &path, width_s)?;
    let ways = path.rows.iter().map(|row| lead.added.iter().map(|[x, y]| row[0] * x + row[1] * y).collect());
    let motors: Vec<Vec<f64>> = ways.collect();
    Ok(Compensated { steps: path.steps(trace, &motors)?, ahead_mm: lead.ahead_mm })
}

/// Intended places of the tool and its lead, [`RATE`](path::RATE) times a second.
#[derive(Clone, Debug, PartialEq)]
pub struct Lead {
    /// In mm from the start.
    pub meant: Vec<[f64; 2]>,
    /// In mm.
    pub added: Vec<[f64; 2]>,
    /// Its maximum, along x and y.
    pub ahead_mm: [f64; 2],
}

/// The tool's path of [`compensate`], for a planner.
///
/// # Errors
/// As [`compensate`].
pub fn lead_of(
    machine: Machine,
    believed: &Params,
    start: Place,
    trace: &StepTrace,
    width_s: f64,
) -> Result<Lead, CompensationError> {
    lead(machine, believed, start, &path_of(machine, believed, trace)?, width_s)
}

fn path_of(machine: Machine, believed: &Params, trace: &StepTrace) -> Result<Path, CompensationError> {
    if trace.duration_s() > LONGEST_S {
        return Err(CompensationError::TooLong(trace.duration_s()));
    }
    Path::new(machine, believed, trace).map_err(CompensationError::NoColumn)
}

fn lead(
    machine: Machine,
    believed: &Params,
    start: Place,
    path: &Path,
    width_s: f64,
) -> Result<Lead, CompensationError> {
    let meant = path.tool();
    let (taken, reach) = (path::taken(&meant, start), workspace(machine, believed));
    if !reach.bears(&taken) {
        return Err(CompensationError::OutOfReach { path: taken, reach });
    }
    let ahead = Lag::new(machine, believed, start).of(&meant, width_s);
    Ok(Lead { meant, added: ahead.tool, ahead_mm: ahead.greatest_mm })
}
