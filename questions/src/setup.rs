//! Setup: which machine is asked about, and where its tool is.

use anyhow::{Result, anyhow, bail, ensure};
use clap::{Args, ValueEnum};
use corehbot_host::printer::Printer;
use corehbot_machine_file::Machine as File;
use corehbot_sim::belt::layout::Layout;
use corehbot_twin::geometry::workspace;
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::routing::{Machine, Place};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Most columns or rows of a grid: some seconds.
const MOST: usize = 200;

/// A machine by its word on the command line, and in studies.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MachineArg {
    /// One closed belt, four motors.
    Corehbot,
    /// One belt, two motors.
    Hbot,
    /// Two belts, two motors.
    Corexy,
    /// Two belts, four motors.
    AwdCorexy,
    /// Four belts over three axes, a motor each.
    Corexyz,
    /// The same with three motors and an idle fourth belt.
    CorexyzThree,
}

impl From<MachineArg> for Machine {
    fn from(machine: MachineArg) -> Self {
        match machine {
            MachineArg::Corehbot => Self::CoreHBot,
            MachineArg::Hbot => Self::HBot,
            MachineArg::Corexy => Self::CoreXy,
            MachineArg::AwdCorexy => Self::AwdCoreXy,
            MachineArg::Corexyz => Self::CoreXyz,
            MachineArg::CorexyzThree => Self::CoreXyzThree,
        }
    }
}

/// Parts that may move besides the tool.
#[derive(Clone, Copy, Default, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModelArg {
    #[default]
    /// Nothing: motors hold, idlers have no mass.
    Reduced,
    /// Idlers, each with its inertia.
    Full,
    /// Idlers, and rotors in the spring of their fields.
    Rotors,
}

impl ModelArg {
    /// The degrees of freedom.
    pub fn freedom(self) -> Freedom {
        let (idlers, rotors) = match self {
            Self::Reduced => (false, false),
            Self::Full => (true, false),
            Self::Rotors => (true, true),
        };
        Freedom { idlers, rotors, ..Freedom::default() }
    }

    /// Its name on pages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reduced => "without idlers and rotors",
            Self::Full => "with idlers",
            Self::Rotors => "with idlers and rotors",
        }
    }
}

/// The machine file of a command that runs no firmware.
#[derive(Args)]
pub struct FileArgs {
    /// The machine file: its table [twin] has the machine's numbers (docs/reference/settings.md), its motors the run of
    /// the belts. Without it, the nominal CoreH-bot.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    machine_file: Option<PathBuf>,
}

impl FileArgs {
    /// The file.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.machine_file.as_deref().into_iter()
    }

    /// Whether there is one.
    pub const fn is_given(&self) -> bool {
        self.machine_file.is_some()
    }

    /// The machine of the file.
    pub fn read(&self) -> Result<File> {
        Printer::new(self.machine_file.clone(), None).machine()
    }
}

/// The run of the belts, where it is not the file's.
#[derive(Args, Default)]
pub struct MachineArgs {
    /// Another run of the belts than the machine's.
    #[arg(long, value_enum)]
    routing: Option<MachineArg>,
}

impl MachineArgs {
    /// Whether the command line says which.
    pub const fn is_given(&self) -> bool {
        self.routing.is_some()
    }

    /// The routing that the file must name for this machine: the command line has it, or the motors' rows say another.
    pub fn to_be_named(&self, file: &File, machine: Machine) -> Option<&'static str> {
        let by_rows = Layout::new(&file.settings, &file.twin.params.clone().into());
        let is_by_rows = by_rows.is_ok_and(|layout| layout.machine == machine);
        (self.is_given() || !is_by_rows).then(|| machine.key())
    }

    /// The machine and its numbers.
    ///
    /// # Errors
    /// No belts do what its motors do, or they leave the tool no room.
    pub fn read(&self, file: &File) -> Result<(Machine, Params)> {
        let (machine, params) = match self.routing {
            Some(machine) => (machine.into(), file.twin.params.clone()),
            None => {
                let Layout { machine, params, .. } = Layout::new(&file.settings, &file.twin)?;
                (machine, params)
            }
        };
        has_room(&[machine], &params)?;
        Ok((machine, params))
    }
}

/// Whether the tool of these machines has room with these numbers.
pub fn has_room(machines: &[Machine], params: &Params) -> Result<()> {
    let has_room = |machine: &Machine| workspace(*machine, params).has_room();
    ensure!(machines.iter().all(has_room), "twin: these pulleys leave the tool no room");
    Ok(())
}

/// The error of a file, in one line.
pub fn syntax(text: &str, error: &toml::de::Error) -> anyhow::Error {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = before.matches('\n').count() + 1;
    anyhow!("line {line}: {}", error.message().replace('\n', " "))
}

/// The machine, and the place of its tool.
#[derive(Args)]
pub struct PlaceArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// The tool's place, in mm from motor 1's axis, at half its height; the middle of its reach without it.
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    /// The place is in G-code coordinates: X0 Y0 is the lower left corner of the reach.
    #[arg(long, requires = "at")]
    gcode_frame: bool,
}

impl PlaceArgs {
    /// The machine, its numbers, and the place.
    ///
    /// # Errors
    /// No such machine or place.
    pub fn read(&self, file: &File) -> Result<(Machine, Params, Place)> {
        let (machine, params) = self.machine.read(file)?;
        let tool = self.tool(machine, &params)?;
        Ok((machine, params, tool))
    }

    fn tool(&self, machine: Machine, params: &Params) -> Result<Place> {
        let reach = workspace(machine, params);
        let Some([x, y]) = self.at else { return Ok(reach.centre()) };
        let origin = if self.gcode_frame { reach.origin() } else { Place::flat(0.0, 0.0) };
        let tool = reach.at(origin.x + x, origin.y + y);
        if !reach.has(tool) {
            let [x0, x1] = reach.x.map(|v| v - origin.x);
            let [y0, y1] = reach.y.map(|v| v - origin.y);
            let name = machine.name();
            bail!("({x}, {y}) is outside what the {name}'s tool reaches: x {x0:.2} to {x1:.2}, y {y0:.2} to {y1:.2}");
        }
        Ok(tool)
    }
}

/// The machine with its tool at a place, and what may move.
#[derive(Args)]
pub struct SetupArgs {
    #[command(flatten)]
    place: PlaceArgs,
    /// Parts that may move besides the tool.
    #[arg(long, value_enum, default_value = "reduced")]
    model: ModelArg,
    /// A motor without power.
    #[arg(long, value_name = "N")]
    free_motor: Option<u8>,
    /// The bar may yaw on its guides.
    #[arg(long)]
    yaw: bool,
}

impl SetupArgs {
    /// The setup for the twin.
    ///
    /// # Errors
    /// No such file, motor or place.
    pub fn read(&self, file: &File) -> Result<Setup> {
        let (machine, params, tool) = self.place.read(file)?;
        if let Some(motor) = self.free_motor {
            let motors = machine.motors();
            let known = motors.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            ensure!(motors.contains(&motor), "there is no motor {motor}; the {} has {known}", machine.name());
        }
        let freedom = Freedom { yaw: self.yaw, free_motor: self.free_motor, ..self.model.freedom() };
        Ok(Setup { machine, params, tool, freedom })
    }
}

/// A number that is finite.
pub fn parse_finite(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("{text} is not a number"))
}

/// A finite number above 0.
pub fn parse_positive(text: &str) -> Result<f64, String> {
    parse_finite(text).and_then(|v| if v > 0.0 { Ok(v) } else { Err(format!("{text} is not above 0")) })
}

/// Two finite numbers.
pub fn parse_pair(text: &str) -> Result<[f64; 2], String> {
    let number = |part: &str| match part.trim().parse::<f64>() {
        Ok(v) if v.is_finite() => Ok(v),
        _ => Err(format!("`{part}` is not a number")),
    };
    match text.split(',').collect::<Vec<_>>()[..] {
        [x, y] => Ok([number(x)?, number(y)?]),
        _ => Err("expected two numbers: X,Y".to_owned()),
    }
}

/// Columns and rows: `7x9`.
pub fn parse_grid(text: &str) -> Result<[usize; 2], String> {
    let number = |part: &str| part.parse().ok().filter(|n| (2..=MOST).contains(n));
    let pair = text.split_once('x').and_then(|(n, m)| Some([number(n)?, number(m)?]));
    pair.ok_or_else(|| format!("`{text}` is not a grid like 7x7, of 2 to {MOST} columns and rows"))
}
