//! `corehbot twin`: what the belt makes of commanded steps, computed by the crate `corehbot-twin`.
//!
//! The subcommands read the command line, ask the twin, and print what it answers: a table for people, JSON for
//! programs.

mod answer;
mod calibrated;
mod compare;
mod compensate;
mod fit;
mod flow;
mod limits;
mod measured;
mod play;
mod point;
mod resonance;
mod setup;
mod source;
mod study;
mod sweep;
mod yin;

use anyhow::Result;
use clap::Subcommand;

/// What the belt makes of commanded steps: stiffness, modes, slips.
#[derive(Subcommand)]
pub(crate) enum Twin {
    /// Where the belt runs: segments, wraps, lengths and reach.
    Geometry(point::Geometry),
    /// How stiffly the tool is held.
    Stiffness(point::Stiffness),
    /// At which frequencies the machine vibrates.
    Modes(point::Modes),
    /// What a force on the tool does.
    Push(point::Push),
    /// What a motor that slipped does.
    Slip(point::Slip),
    /// At which frequencies each axis rings over the reach, which shapers fit, and which speeds to stay away from.
    Resonance(resonance::Resonance),
    /// How hard the machine can be driven before a motor slips, a span goes slack, or the tool rings too much.
    Limits(limits::LimitsArgs),
    /// CoreH-bot, H-bot and CoreXY of one size side by side, over one area and, if a file is given, on it.
    Compare(compare::Compare),
    /// Numbers of the machine are varied, one of them or as a study says: stiffness, frequencies, what becomes of a
    /// file.
    #[command(mut_args(sweep::not_beside_a_study))]
    Sweep(sweep::Sweep),
    /// Belt, preload, masses and motors of a CoreH-bot from what was measured on it.
    Fit(fit::Fit),
    /// Makes G-code, or a step trace, that goes ahead by what belts and motors will give way, for the firmware as it
    /// is.
    Compensate(compensate::Compensate),
    /// How well the nozzle's flow follows the tool, by shaper and window of the pressure advance.
    Flow(flow::Flow),
    /// Yin et al.'s CoreXY on a square of 20 mm: how far the tool cuts the corners.
    Yin(yin::Yin),
    /// Plays a G-code file or a step trace on the machine: errors of the tool, tensions, torques.
    Run(play::Play),
}

/// Answers, and says the exit status.
///
/// # Errors
/// What is asked for is not there, or an output cannot be written.
pub(crate) fn run(twin: &Twin) -> Result<u8> {
    match twin {
        Twin::Geometry(args) => args.answer(),
        Twin::Stiffness(args) => args.answer(),
        Twin::Modes(args) => args.answer(),
        Twin::Push(args) => args.answer(),
        Twin::Slip(args) => args.answer(),
        Twin::Resonance(args) => args.answer(),
        Twin::Limits(args) => args.answer(),
        Twin::Flow(args) => args.answer(),
        Twin::Yin(args) => args.answer(),
        Twin::Compare(args) => args.answer(),
        Twin::Sweep(args) => args.answer(),
        Twin::Fit(args) => args.answer(),
        Twin::Compensate(args) => args.answer(),
        Twin::Run(args) => args.answer(),
    }
}
