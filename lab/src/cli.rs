//! Command line of `corehbot-lab`, and its exit status ([`corehbot_host::status`]).

use crate::commands::{
    compare, compensate, figures, flow, frame, jump, level, misalignment, parts, push, sweep, yin, zigzag,
};
use crate::examples::EXAMPLES;
use anyhow::Result;
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use corehbot_host::examples::with_examples;
use corehbot_host::status::end;
use std::process::ExitCode;

/// The name of this program in messages.
const PROGRAM: &str = "corehbot-lab";

/// Studies of belt machines: papers computed again, machines compared, numbers varied, G-code compensated.
#[derive(Parser)]
#[command(name = "corehbot-lab", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    question: Question,
}

#[derive(Subcommand)]
enum Question {
    /// Computes the effect of a force on the tool.
    ///
    /// dx_mm is to the right, dy_mm away from the front and dz_mm up. A change of tension is positive where a span gets
    /// tighter. A motor's torque is the one with which it holds, counter-clockwise seen from above. The residual is the
    /// part of the motors' travel that a rigid belt cannot follow.
    Push(push::Push),
    /// Computes the ringing after a jump of speed.
    ///
    /// Motors run from rest at a constant speed at once, as after a corner that asks for a jump of speed. Distances are
    /// the tool's place minus the commanded one: to the right and away from the front is positive. The tool rings about
    /// its lag at constant speed (rest_um).
    Jump(jump::Jump),
    /// Computes the torques, and the tension along the stroke, that pulleys off their places make.
    ///
    /// Torques are counter-clockwise, seen from above. A change of tension is positive where a span gets tighter;
    /// dx_mm is to the right and dy_mm away from the front, of the tool against its place with the pulleys right.
    Misalignment(misalignment::Misalignment),
    /// Compares CoreH-bot, H-bot and CoreXY of one size, over one area and, if given, on a file.
    ///
    /// Ranges are lowest and highest over the area. The torques frame_torque_x and frame_torque_y are those of all
    /// motors on their rotors, counter-clockwise seen from above. They belong to an acceleration to the right and away
    /// from the front. The frame bears the opposite ones. The runs have the keys of `corehbot twin run`.
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
}

/// The command line, with examples in the help of each command.
#[must_use]
pub fn command() -> clap::Command {
    with_examples(Cli::command(), &EXAMPLES, "")
}

/// Runs the command that the process was called with.
#[must_use]
pub fn main() -> ExitCode {
    let called = command().try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches));
    match called {
        Ok(called) => end(PROGRAM, Ok(called.question), |question| answer(&question)),
        Err(error) => error.exit(),
    }
}

/// Answers, and says the exit status.
fn answer(question: &Question) -> Result<u8> {
    match question {
        Question::Push(args) => args.answer(),
        Question::Jump(args) => args.answer(),
        Question::Misalignment(args) => args.answer(),
        Question::Compare(args) => args.answer(),
        Question::Frame(args) => args.answer(),
        Question::Figures(args) => args.answer(),
        Question::Parts(args) => args.answer(),
        Question::Sweep(args) => args.answer(),
        Question::Compensate(args) => args.answer(),
        Question::Flow(args) => args.answer(),
        Question::Yin(args) => args.answer(),
        Question::Zigzag(args) => args.answer(),
        Question::Level(args) => args.answer(),
    }
}
