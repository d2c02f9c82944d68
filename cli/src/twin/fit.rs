//! `twin fit`: fits numbers of a machine to measurements, in a file, or to frequencies on the command line.

use super::calibration_file::Calibrated;
use anyhow::{Result, ensure};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_questions::setup::{FileArgs, MachineArgs};
use corehbot_twin::geometry::workspace;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::shaping::fit::{Axis, Fit as Law, FitError, Measured, fit};
use corehbot_twin::solve::identify::{Identified, Rung, identify};
use serde::Serialize;
use std::path::PathBuf;

/// `twin fit`.
#[derive(Args)]
pub(crate) struct Fit {
    /// Measurements of several kinds (docs/research/twin.md describes them): finds each belt's stiffness and tension,
    /// masses, motors, yaw and damping, and says which measurement would help most next.
    #[arg(value_name = "MEASURED.toml", required_unless_present = "measured", conflicts_with = "measured")]
    file: Option<PathBuf>,
    /// The tool's place in mm from motor 1's axis, and the ringing of x and y in Hz, `-` for one that was not measured.
    /// May be repeated, once a place.
    #[arg(long, value_name = "X,Y,FX,FY", value_parser = parse_rung, allow_hyphen_values = true)]
    measured: Vec<Rung>,
    /// The places are in G-code coordinates: X0 Y0 is the lower left corner of the reach.
    #[arg(long, requires = "measured")]
    gcode_frame: bool,
    #[command(flatten)]
    settings: FileArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    json: Json,
}

/// Numbers for the model, and for the firmware.
#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    identified: Identified,
    /// The law of each axis that was measured at two places or more.
    x: Option<Law>,
    y: Option<Law>,
    #[serde(skip)]
    missing: [Option<FitError>; 2],
}

impl Fit {
    pub(super) fn answer(&self) -> Result<u8> {
        let machine_file = self.settings.read()?;
        let (machine, params) = self.machine.read(&machine_file)?;
        if let Some(file) = &self.file {
            let routing = self.machine.to_be_named(&machine_file, machine);
            let answer = Calibrated::read(file, machine, routing, &params)?;
            return self.json.give(&answer, self.settings.files().chain([file.as_path()]));
        }
        let reach = workspace(machine, &params);
        let mut rung = self.measured.clone();
        for Rung { at, .. } in &mut rung {
            let origin = if self.gcode_frame { reach.origin() } else { Place::flat(0.0, 0.0) };
            *at = reach.at(at.x + origin.x, at.y + origin.y);
            ensure!(reach.has(*at), "({:.1}, {:.1}) mm is outside what the tool reaches", at.x, at.y);
        }
        let count = rung.iter().flat_map(|r| r.frequencies_hz).flatten().count();
        ensure!(count >= 2, "expected at least two frequencies: belts and motors are two unknowns");
        // The law of a place is the CoreH-bot's.
        let is_corehbot = machine == Machine::CoreHBot;
        let law = |axis: Axis, index: usize| {
            let place = |r: &Rung| if index == 0 { r.at.x } else { r.at.y };
            let one = |r: &Rung| {
                let frequency_hz = r.frequencies_hz.get(index).copied().flatten()?;
                Some(Measured { place_mm: place(r), frequency_hz })
            };
            fit(axis, &rung.iter().filter_map(one).collect::<Vec<_>>(), &params)
        };
        let (x, y) = (law(Axis::X, 0), law(Axis::Y, 1));
        let identified = identify(machine, &params, &rung)?;
        let answer = Answer {
            identified,
            missing: [&x, &y].map(|law| law.as_ref().err().copied().filter(|_| is_corehbot)),
            x: x.ok().filter(|_| is_corehbot),
            y: y.ok().filter(|_| is_corehbot),
        };
        self.json.give(&answer, self.settings.files())
    }
}

/// `235,235,101.4,57.6`, or `-` for one of the frequencies.
fn parse_rung(text: &str) -> Result<Rung, String> {
    let number = |part: &str| match part.trim().parse::<f64>() {
        Ok(v) if v.is_finite() => Ok(v),
        _ => Err(format!("`{part}` is not a number")),
    };
    let frequency = |part: &str| match part.trim() {
        "-" => Ok(None),
        part => match number(part)? {
            hz if (1.0..=5000.0).contains(&hz) => Ok(Some(hz)),
            _ => Err(format!("`{part}` is not a frequency from 1 to 5000 Hz")),
        },
    };
    match text.split(',').collect::<Vec<_>>()[..] {
        [x, y, fx, fy] => {
            Ok(Rung { at: Place::flat(number(x)?, number(y)?), frequencies_hz: [frequency(fx)?, frequency(fy)?] })
        }
        _ => Err("expected a place and two frequencies: X,Y,FX,FY".to_owned()),
    }
}

impl std::fmt::Display for Answer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Identified { belt_ea_n, holding_torque_nm, worst_difference } = self.identified;
        writeln!(
            f,
            "# For the machine file; the model then rings within {:.2} % of what was measured.",
            100.0 * worst_difference
        )?;
        writeln!(f, "[twin]")?;
        writeln!(f, "belt_EA_N = {belt_ea_n:.0}")?;
        writeln!(f, "holding_torque_Nm = {holding_torque_nm:.3}")?;
        for (letter, law, missing) in [("x", &self.x, &self.missing[0]), ("y", &self.y, &self.missing[1])] {
            writeln!(f)?;
            match (law, missing) {
                (Some(law), _) => {
                    let within = 100.0 * law.worst_difference;
                    writeln!(f, "# For a machine file, beside the shaper's type and damping; within {within:.2} %.")?;
                    writeln!(f, "[shaper.{letter}]")?;
                    writeln!(f, "frequency = {:.1}", law.frequency_hz)?;
                    writeln!(f, "span = {:.1}", law.span_mm)?;
                    writeln!(f, "motor_frequency = {:.1}", law.motor_frequency_hz.unwrap_or(0.0))?;
                }
                (None, Some(error)) => writeln!(f, "# No law for {letter}: {error}.")?,
                (None, None) => {}
            }
        }
        Ok(())
    }
}
