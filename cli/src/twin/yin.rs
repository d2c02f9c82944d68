//! `twin yin`: the corners of Yin et al.'s square.

use super::answer::Json;
use anyhow::Result;
use clap::{Args, ValueEnum};
use corehbot_twin::yin::{Case, Command, Corners, Model, run};
use serde::Serialize;
use std::fmt;

/// `twin yin`.
#[derive(Args)]
pub(crate) struct Yin {
    /// The speed along the square, in m/s.
    #[arg(long, value_name = "M_PER_S", allow_negative_numbers = true)]
    speed: f64,
    /// How much of the machine is modelled.
    #[arg(long, value_name = "MODEL", default_value = "full")]
    model: Degrees,
    /// Factor of all friction.
    #[arg(long, value_name = "F", default_value_t = 1.0, allow_negative_numbers = true)]
    friction: f64,
    /// Factor of the belt's stiffness.
    #[arg(long, value_name = "K", default_value_t = 1.0, allow_negative_numbers = true)]
    stiffness: f64,
    /// Factor of all masses.
    #[arg(long, value_name = "M", default_value_t = 1.0, allow_negative_numbers = true)]
    mass: f64,
    /// x and y go in pulses of 0.0812 mm instead of continuously.
    #[arg(long)]
    pulses: bool,
    #[command(flatten)]
    json: Json,
}

/// A model by the name that the paper gives it.
#[derive(Clone, Copy, ValueEnum)]
enum Degrees {
    /// 12 degrees of freedom: every pulley turns by itself.
    Full,
    /// 4 degrees of freedom: idlers are carried along.
    #[value(name = "4dof")]
    Four,
}

impl Yin {
    pub(super) fn answer(&self) -> Result<u8> {
        let Self { speed, friction, stiffness, mass, .. } = *self;
        let model = match self.model {
            Degrees::Full => Model::Full,
            Degrees::Four => Model::FourDof,
        };
        let command = if self.pulses { Command::Pulses } else { Command::Continuous };
        let corners = run(&Case { speed, model, command, friction, stiffness, mass })?;
        self.json.give(&Answer::of(corners), [])
    }
}

/// The results for the corners.
#[derive(Serialize)]
struct Answer {
    x_to_y_mm: f64,
    y_to_x_mm: f64,
    overshoot_mm: f64,
}

impl Answer {
    const fn of(corners: Corners) -> Self {
        let Corners { x_to_y_mm, y_to_x_mm, overshoot_mm } = corners;
        Self { x_to_y_mm, y_to_x_mm, overshoot_mm }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { x_to_y_mm, y_to_x_mm, overshoot_mm } = self;
        writeln!(f, "from x to y  {x_to_y_mm:8.4} mm, contour error by equation 17")?;
        writeln!(f, "from y to x  {y_to_x_mm:8.4} mm")?;
        writeln!(f, "overshoot    {overshoot_mm:8.4} mm")
    }
}
