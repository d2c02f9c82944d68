//! `corehbot-lab yin`: the corners of Yin et al.'s square, their figures, and their equation 9.

use crate::drawings::yin::{figure_3, figure_4, figure_5};
use crate::yin::figure::{Figure3, Figure4, Figure5};
use crate::yin::state_space::{Input, StateSpace};
use crate::yin::{Case, Command, Corners, Direction, Drive, Error, Model, Parameters, run_on, scaled};
use anyhow::{Result, anyhow, ensure};
use clap::{Args, ValueEnum};
use corehbot_host::answer::Json;
use corehbot_host::answer::drawn;
use corehbot_host::input;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_questions::setup::syntax;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Gain of the position control of DC motors without `--gain`, V/rad.
const GAIN: f64 = 100.0;

/// `corehbot-lab yin`.
#[derive(Args)]
pub(crate) struct Yin {
    /// The speed along the square, in m/s.
    #[arg(long, value_name = "M_PER_S", allow_negative_numbers = true, required_unless_present_any = ["figure", "state_space"])]
    speed: Option<f64>,
    /// Computes a figure of the paper again, and compares it with the text; speeds and models are the paper's.
    #[arg(long, value_name = "N", conflicts_with_all = ["speed", "model", "direction"])]
    figure: Option<Figure>,
    /// Writes the figure as a drawing; `-` is standard output.
    #[arg(long, value_name = "F.svg", requires = "figure", conflicts_with_all = ["speed", "state_space"])]
    svg: Option<PathBuf>,
    /// Gives the matrices and poles of equation 9: from angles of steppers, or from voltages of DC motors. Coulomb
    /// friction is left out.
    #[arg(long, conflicts_with_all = ["speed", "figure", "direction", "pulses", "gain"])]
    state_space: bool,
    /// The numbers of the rig, under the paper's names (examples/twin/yin.toml). Without it, the assumed rig: the
    /// numbers of the paper's table I are not known.
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,
    /// How much of the machine is modelled.
    #[arg(long, value_name = "MODEL", default_value = "full")]
    model: Degrees,
    /// The motors.
    #[arg(long, value_name = "MOTORS", default_value = "stepper")]
    drive: Motors,
    /// The gain of the position control of DC motors (--drive dc), in V per rad of error, 100 without it; the paper has
    /// no control for them.
    #[arg(long, value_name = "V_PER_RAD", allow_negative_numbers = true)]
    gain: Option<f64>,
    /// The way round the square; the paper went counter-clockwise.
    #[arg(long, value_name = "WAY", default_value = "clockwise")]
    direction: Way,
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

/// A figure by its number.
#[derive(Clone, Copy, ValueEnum)]
enum Figure {
    /// The tool's path at three speeds.
    #[value(name = "3")]
    Three,
    /// The error over the speed.
    #[value(name = "4")]
    Four,
    /// The error over friction, stiffness and mass.
    #[value(name = "5")]
    Five,
}

/// The kind of motors.
#[derive(Clone, Copy, ValueEnum)]
enum Motors {
    /// Steppers turn as commanded (equations 8 and 15).
    Stepper,
    /// DC motors turn by their torque K1 V - K2 phi' (equations 7, 10 and 16).
    Dc,
}

/// The way round the square.
#[derive(Clone, Copy, ValueEnum)]
enum Way {
    /// Along y first.
    Clockwise,
    /// Along x first.
    CounterClockwise,
}

impl Yin {
    pub(crate) fn answer(&self) -> Result<u8> {
        let is_dc = matches!(self.drive, Motors::Dc);
        ensure!(is_dc || self.gain.is_none(), "--gain is of DC motors: it needs --drive dc");
        self.json.check(self.files(), &self.svg)?;
        let rig = self.rig()?;
        let case = self.case();
        if self.state_space {
            let input = match self.drive {
                Motors::Stepper => Input::Angles,
                Motors::Dc => Input::Volts,
            };
            return self.json.give(&StateSpace::new(case.model, &scaled(&rig, &case)?, input), self.files());
        }
        match self.figure {
            Some(Figure::Three) => self.give(&Figure3::new(&rig, &case)?, figure_3),
            Some(Figure::Four) => self.give(&Figure4::new(&rig, &case)?, figure_4),
            Some(Figure::Five) => {
                let figure = Figure5::new(&rig, &case).map_err(|error| match error {
                    Error::Factor(..) => anyhow!("{error}; figure 5 multiplies each factor by 0.5 to 2"),
                    other => other.into(),
                })?;
                self.give(&figure, figure_5)
            }
            None => self.json.give(&Answer::of(run_on(&rig, &case)?), self.files()),
        }
    }

    fn files(&self) -> impl Iterator<Item = &Path> {
        self.rig.as_deref().into_iter()
    }

    fn rig(&self) -> Result<Parameters> {
        let Some(path) = &self.rig else { return Ok(Parameters::default()) };
        let text = input::text(path, Wanted::Rig)?;
        toml::from_str(&text).map_err(|error| anyhow!("{}: {}", path.display(), syntax(&text, &error)))
    }

    fn case(&self) -> Case {
        let Self { friction, stiffness, mass, gain, .. } = *self;
        Case {
            // Figures have speeds of their own.
            speed: self.speed.unwrap_or_default(),
            model: match self.model {
                Degrees::Full => Model::Full,
                Degrees::Four => Model::FourDof,
            },
            drive: match self.drive {
                Motors::Stepper => Drive::Stepper,
                Motors::Dc => Drive::Dc(gain.unwrap_or(GAIN)),
            },
            command: if self.pulses { Command::Pulses } else { Command::Continuous },
            direction: match self.direction {
                Way::Clockwise => Direction::Clockwise,
                Way::CounterClockwise => Direction::CounterClockwise,
            },
            friction,
            stiffness,
            mass,
        }
    }

    /// Gives a figure, and its drawing if it is asked for.
    fn give<F: Serialize + fmt::Display>(&self, figure: &F, draw: fn(&F) -> String) -> Result<u8> {
        self.json.give_with(figure, self.files(), |outputs| drawn(outputs, self.svg.as_deref(), || draw(figure)))
    }
}

/// The results for the corners.
#[derive(Serialize)]
struct Answer {
    x_to_y_mm: f64,
    y_to_x_mm: f64,
    overshoot_mm: f64,
    #[serde(rename = "largest_voltage_V", skip_serializing_if = "Option::is_none")]
    most_volts: Option<f64>,
}

impl Answer {
    const fn of(corners: Corners) -> Self {
        let Corners { x_to_y_mm, y_to_x_mm, overshoot_mm, most_volts } = corners;
        Self { x_to_y_mm, y_to_x_mm, overshoot_mm, most_volts }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { x_to_y_mm, y_to_x_mm, overshoot_mm, most_volts } = self;
        writeln!(f, "from x to y  {x_to_y_mm:8.4} mm, contour error by equation 17")?;
        writeln!(f, "from y to x  {y_to_x_mm:8.4} mm")?;
        writeln!(f, "overshoot    {overshoot_mm:8.4} mm")?;
        most_volts.map_or(Ok(()), |volts| writeln!(f, "voltage      {volts:8.4} V at most"))
    }
}
