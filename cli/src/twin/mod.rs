//! `corehbot twin`: the belt's response to commanded steps, computed by the crate `corehbot-twin`.
//!
//! The subcommands read the command line, ask the twin, and print its answer: a table for people, JSON for programs.
//! What studies and papers ask is `corehbot-lab`.

mod calibration_file;
mod fit;
mod limits;
mod measurements;
mod octave;
mod play;
mod point;
mod resonance;
mod ripple;
mod shaper;
mod tension;

use anyhow::Result;
use clap::Subcommand;

/// The belt's response to commanded steps: stiffness, modes, slips.
#[derive(Subcommand)]
pub(crate) enum Twin {
    /// Shows where the belt runs: segments, wraps, lengths and reach.
    ///
    /// Places count from motor 1's axis in mm, x to the right and y away from the front. A motor's travel is in mm of
    /// belt, counter-clockwise seen from above.
    Geometry(point::Geometry),
    /// Computes how stiffly the tool is held.
    ///
    /// Kxy is the force along y for a millimetre of x. The softest direction counts from x towards y; where belts lift
    /// the tool, z is held.
    Stiffness(point::Stiffness),
    /// Computes the frequencies at which the machine vibrates.
    Modes(point::Modes),
    /// Computes the effect of a motor that slipped.
    ///
    /// A slip is counter-clockwise seen from above. The other signs are those of `push`.
    Slip(point::Slip),
    /// Rates a given shaper: the part of given vibrations that it leaves, its delay, its rounding.
    ///
    /// A residual is the amplitude that is left after the last part, of 1, relative to the same command without a
    /// shaper.
    Shaper(shaper::Shaper),
    /// Computes the pitch of each straight part of the belts for a wanted tension, and the tension for a heard pitch.
    ///
    /// parts[].part numbers the straight parts along the belts, between the pulleys of `twin geometry`; is_longest
    /// marks the one to pluck.
    Tension(tension::Tension),
    /// Finds the frequencies at which each axis rings over the reach, shapers that fit, and speeds to avoid.
    ///
    /// frequencies_Hz has a row for each y_mm and a column for each x_mm, from motor 1's axis. Residuals
    /// (worst_residual, left_by_y, left_by_shaper) and coupling are parts, of 1; damping_ratio is of critical damping.
    /// A net rounding is positive where the tool stays inside a corner, in a/w^2.
    Resonance(resonance::Resonance),
    /// Computes fine ripple of walls by speed and angle (VFA): motors, teeth and pulleys that shake the tool.
    Ripple(ripple::Ripple),
    /// Finds the limits before a motor slips, a span goes slack, or the tool rings too much.
    ///
    /// Each limit is for the worst place of the reach and holds in both directions of its axis. margin and torque_part
    /// are parts, of 1. worst_direction_deg counts from x towards y.
    Limits(limits::LimitsArgs),
    /// Fits belts, tensions, masses, motors, yaw and damping of a machine to measurements.
    ///
    /// uncertainty and assumed_uncertainty are relative standard uncertainties, of 1. So are now and then: before and
    /// after a further measurement, which removes a part of all variance, of 1. For a measured value, part is by how
    /// much the model exceeds it, of 1. uncertainties is the same difference over the uncertainty of the measurement.
    /// spread is the factor by which all measurements count as more uncertain.
    Fit(fit::Fit),
    /// Plays a G-code file or a step trace on the machine: errors of the tool, tensions, torques.
    ///
    /// Errors are distances from the commanded line: rounding towards the inside of a corner, overshoot towards its
    /// outside. A positive bisector_mm is inside. The errors end_off_x_um and end_off_y_um are the tool's place at rest
    /// after the last step minus the end of its line. They are positive to the right and away from the front. Places of
    /// corners count from motor 1's axis; turn_deg is positive to the left. tension_N has the lowest and the highest
    /// tension, and a margin is the part of a motor's torque that was left, of 1. Torques, residuals and slack are the
    /// largest, without a sign; full_steps_off is positive counter-clockwise.
    Run(play::Play),
}

/// Answers, and says the exit status.
///
/// # Errors
/// The requested item is missing, or an output cannot be written.
pub(crate) fn run(twin: &Twin) -> Result<u8> {
    match twin {
        Twin::Geometry(args) => args.answer(),
        Twin::Stiffness(args) => args.answer(),
        Twin::Modes(args) => args.answer(),
        Twin::Slip(args) => args.answer(),
        Twin::Shaper(args) => args.answer(),
        Twin::Tension(args) => args.answer(),
        Twin::Resonance(args) => args.answer(),
        Twin::Ripple(args) => args.answer(),
        Twin::Limits(args) => args.answer(),
        Twin::Fit(args) => args.answer(),
        Twin::Run(args) => args.answer(),
    }
}
