//! `corehbot-lab zigzag`: the tool's path at step resolution, by the order of the motors' steps.

use crate::drawings::{corexyz, freedom};
use crate::queries::zigzag::{Ask, MACHINES, Zigzag as Answer};
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use corehbot_host::answer::Json;
use corehbot_host::answer::drawn;
use corehbot_questions::setup::{FileArgs, MachineArgs, parse_positive};
use corehbot_twin::params::Params;
use corehbot_twin::routing::Machine;
use serde::Serialize;
use std::path::PathBuf;

/// `corehbot-lab zigzag`.
#[derive(Args)]
pub(crate) struct Zigzag {
    #[command(flatten)]
    file: FileArgs,
    #[command(flatten)]
    machine: MachineArgs,
    /// The axis that moves. Machines without belts for it are left out.
    #[arg(long, value_enum, default_value = "x")]
    axis: Axis,
    /// Steps of the axis.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=100))]
    steps: u32,
    /// The length of a step in mm.
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0125, value_parser = parse_positive)]
    step: f64,
    /// The speed of the move in mm/s, for the part of the zig-zag that the tool's mass leaves.
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true, default_value_t = 100.0, value_parser = parse_positive)]
    speed: f64,
    /// The order of the motors' steps, by their letters in Carlyle's tables (CoreXY, CoreXYZ) or their numbers, of
    /// one machine. Without it, ascending.
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    order: Option<Vec<String>>,
    /// Every second step has the opposite order.
    #[arg(long)]
    alternate: bool,
    /// Writes the paths as a drawing; `-` is standard output.
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Draws the line or the plane in which each belt of a CoreXY or a CoreXYZ alone leaves the tool free.
    #[arg(long, value_name = "F.svg")]
    freedom: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

/// An axis.
#[derive(Clone, Copy, ValueEnum)]
enum Axis {
    /// To the right.
    X,
    /// Away from the front.
    Y,
    /// Up.
    Z,
}

/// The paths of all machines.
#[derive(Serialize)]
struct All {
    machines: Vec<Answer>,
}

impl std::fmt::Display for All {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.machines.iter().enumerate().try_for_each(|(i, one)| {
            if i > 0 {
                writeln!(f)?;
            }
            one.fmt(f)
        })
    }
}

impl Zigzag {
    pub(crate) fn answer(&self) -> Result<u8> {
        let axis = self.axis as usize;
        let is_one = self.machine.is_given() || self.file.is_given();
        ensure!(
            is_one || self.order.is_none(),
            "--order needs --routing or --machine: machines name their motors differently"
        );
        let ask = Ask {
            axis,
            steps: self.steps,
            step_mm: self.step,
            speed_mm_s: self.speed,
            order: self.order.clone(),
            alternates: self.alternate,
        };
        let machines: Vec<(Machine, Params)> = if is_one {
            vec![self.machine.read(&self.file.read()?)?]
        } else {
            let moves = |machine: &Machine| axis < machine.axes();
            MACHINES.into_iter().filter(moves).map(|machine| (machine, Params::default())).collect()
        };
        let machines =
            machines.iter().map(|(machine, params)| Answer::new(*machine, params, &ask)).collect::<Result<_, _>>()?;
        let all = All { machines };
        self.json.give_with(&all, self.file.files(), |outputs| {
            drawn(outputs, self.svg.as_deref(), || corexyz::zigzag(&all.machines))?;
            drawn(outputs, self.freedom.as_deref(), freedom::freedom)
        })
    }
}
