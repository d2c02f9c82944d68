//! Compensation: steps that send the motors ahead by what the tool will lag behind.
//!
//! What lags is known: belts and fields give way under inertia and friction ([`lag`]). The acceleration that this takes is
//! that of the path that was meant, which the times of the steps tell far more finely than the steps themselves ([`path`]).
//! The sum is cut into steps anew (`stepping`).

mod error;
pub mod lag;
pub mod path;
mod stepping;

use crate::geometry::workspace;
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::steps::StepTrace;
pub use error::CompensationError;
use lag::Lag;
use path::Path;

/// The longest trace in s: samples of its path take 0.9 GB of memory for an hour.
const LONGEST_S: f64 = 3600.0;

/// Steps with what was done to them.
#[derive(Clone, Debug, PartialEq)]
pub struct Compensated {
    /// The steps.
    pub steps: StepTrace,
    /// By how much the tool was sent ahead at most, along x and y.
    pub ahead_mm: [f64; 2],
}

/// Compensates steps of a machine that begins with its tool at `start`, as stiff and heavy as `believed`. The path is
/// smoothed by a Gaussian of this width (standard deviation) before its acceleration is taken: longer, and ringing is not met;
/// shorter, and steps shine through. A millisecond is best for modes of 50 to 110 Hz (docs/twin.md).
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
    if trace.duration_s() > LONGEST_S {
        return Err(CompensationError::TooLong(trace.duration_s()));
    }
    let path = Path::new(machine, believed, trace).map_err(CompensationError::NoColumn)?;
    let tool = path.tool();
    let (taken, reach) = (path::taken(&tool, start), workspace(machine, believed));
    if !reach.bears(&taken) {
        return Err(CompensationError::OutOfReach { path: taken, reach });
    }
    let lag = Lag::new(machine, believed, start).of(&path, &tool, width_s);
    Ok(Compensated { steps: path.steps(trace, &lag.motors)?, ahead_mm: lag.greatest_mm })
}
