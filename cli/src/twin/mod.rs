//! `corehbot twin`: the belt's response to commanded steps, computed by the crate `corehbot-twin`.
//!
//! The subcommands read the command line, ask the twin, and print its answer: a table for people, JSON for programs.

mod calibrated;
mod compare;
mod compensate;
mod figures;
mod fit;
mod flow;
mod frame;
mod jump;
mod level;
mod limits;
mod measured;
mod misalignment;
mod parts;
mod play;
mod point;
mod resonance;
mod ripple;
mod setup;
mod shaper;
mod source;
mod study;
mod sweep;
mod tension;
mod yin;
mod zigzag;

use anyhow::{Context as _, Result};
use clap::Subcommand;
use corehbot_host::output::Outputs;
use std::io::Write as _;
use std::path::Path;

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
    /// Computes the effect of a force on the tool.
    ///
    /// dx_mm is to the right, dy_mm away from the front and dz_mm up. A change of tension is positive where a span gets
    /// tighter. A motor's torque is the one with which it holds, counter-clockwise seen from above. The residual is the
    /// part of the motors' travel that a rigid belt cannot follow.
    Push(point::Push),
    /// Computes the effect of a motor that slipped.
    ///
    /// A slip is counter-clockwise seen from above. The other signs are those of `push`.
    Slip(point::Slip),
    /// Computes the ringing after a jump of speed.
    ///
    /// Motors run from rest at a constant speed at once, as after a corner that asks for a jump of speed. Distances are
    /// the tool's place minus the commanded one: to the right and away from the front is positive. The tool rings about
    /// its lag at constant speed (rest_um).
    Jump(jump::Jump),
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
    /// Computes the torques, and the tension along the stroke, that pulleys off their places make.
    ///
    /// Torques are counter-clockwise, seen from above. A change of tension is positive where a span gets tighter;
    /// dx_mm is to the right and dy_mm away from the front, of the tool against its place with the pulleys right.
    Misalignment(misalignment::Misalignment),
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
    /// Compares CoreH-bot, H-bot and CoreXY of one size, over one area and, if given, on a file.
    ///
    /// Ranges are lowest and highest over the area. The torques frame_torque_x and frame_torque_y are those of all
    /// motors on their rotors, counter-clockwise seen from above. They belong to an acceleration to the right and away
    /// from the front. The frame bears the opposite ones. The runs have the keys of `twin run`.
    Compare(compare::Compare),
    /// Computes the motors' torque on the frame, and how a frame that is not rigid vibrates with the tool.
    ///
    /// Torques are those of all motors on their rotors, counter-clockwise seen from above. They belong to an
    /// acceleration to the right (x) and away from the front (y). The frame bears the opposite ones. Torques of belts_
    /// go into the belts, those of rotors_ into the rotors. printed_ has the paper's torques, without a direction. The
    /// frame has one stiffness along x and y after the other, and frequencies_Hz are those of tool and frame,
    /// ascending.
    Frame(frame::Frame),
    /// Draws the schematics, table 1 and the workspaces of the CoreH-bot paper, and compares its numbers with the
    /// model.
    Figures(figures::Figures),
    /// Computes how far the dimensions of reference parts would be off, by machine and speed, in micrometres.
    ///
    /// The firmware plans each part with the machine's limits and shapers, and each machine plays its steps with the
    /// part in the middle of its reach. Dimensions are those of the nozzle's path; filament and the yaw of the bar are
    /// left out. A dimension that is too large is positive: a hole too wide, a wall too thick. A corner outside is
    /// positive.
    Parts(parts::Parts),
    /// Varies numbers of the machine, one of them or as a study file says: stiffness, frequencies, the result of a
    /// file.
    #[command(mut_args(sweep::not_beside_a_study))]
    Sweep(sweep::Sweep),
    /// Fits belts, tensions, masses, motors, yaw and damping of a machine to measurements.
    ///
    /// uncertainty and assumed_uncertainty are relative standard uncertainties, of 1. So are now and then: before and
    /// after a further measurement, which removes a part of all variance, of 1. For a measured value, part is by how
    /// much the model exceeds it, of 1. uncertainties is the same difference over the uncertainty of the measurement.
    /// spread is the factor by which all measurements count as more uncertain.
    Fit(fit::Fit),
    /// Compensates G-code, or a step trace, in advance for the give of belts and motors, for the unchanged firmware.
    Compensate(compensate::Compensate),
    /// Compares the nozzle's flow with the tool's motion, by shaper and window of the pressure advance.
    Flow(flow::Flow),
    /// Computes how far the tool cuts the corners on Yin et al.'s CoreXY, on a square of 20 mm.
    ///
    /// x points along the bar and y across it; the square begins at its lower left corner. A contour error is the
    /// distance from a corner to where the tool crosses its bisector: positive inside the corner, negative outside.
    Yin(yin::Yin),
    /// Shows the tool's path when motors make their steps one after the other, and in one instant.
    ///
    /// A way aside is the tool's distance from the line of the move between its steps. A residual is the part of the
    /// motors' steps that no place of the tool has; it strains the belts.
    /// followed is the part, of 1, that the tool follows.
    Zigzag(zigzag::Zigzag),
    /// Computes what the belts of a CoreXYZ do to its bar and its gantry: racking, and levelling by belts and pulleys.
    ///
    /// The tilt about x is positive where the back rises, the tilt about y where the left side rises, the racking of
    /// the bar counter-clockwise seen from above. Moments are those that the guides bear, with these signs. Pairs are
    /// about x and about y. corners_mm is up: front left, front right, back right, back left; tool_mm is to the right,
    /// away from the front and up. A tension is positive where a belt gets tighter. Without --routing and --machine
    /// the machine is a CoreXYZ with four motors.
    Level(level::Level),
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

/// Writes a drawing, if one is asked for.
fn drawn(outputs: &mut Outputs, path: Option<&Path>, draw: impl FnOnce() -> String) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let mut out = outputs.open(path)?;
    out.write_all(draw().as_bytes()).and_then(|()| out.flush()).context("cannot write the drawing")
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
        Twin::Push(args) => args.answer(),
        Twin::Slip(args) => args.answer(),
        Twin::Jump(args) => args.answer(),
        Twin::Shaper(args) => args.answer(),
        Twin::Tension(args) => args.answer(),
        Twin::Misalignment(args) => args.answer(),
        Twin::Resonance(args) => args.answer(),
        Twin::Ripple(args) => args.answer(),
        Twin::Limits(args) => args.answer(),
        Twin::Flow(args) => args.answer(),
        Twin::Yin(args) => args.answer(),
        Twin::Zigzag(args) => args.answer(),
        Twin::Level(args) => args.answer(),
        Twin::Compare(args) => args.answer(),
        Twin::Frame(args) => args.answer(),
        Twin::Figures(args) => args.answer(),
        Twin::Parts(args) => args.answer(),
        Twin::Sweep(args) => args.answer(),
        Twin::Fit(args) => args.answer(),
        Twin::Compensate(args) => args.answer(),
        Twin::Run(args) => args.answer(),
    }
}
