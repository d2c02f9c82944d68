//! `twin run`: steps are played on the machine.

use anyhow::{Context as _, Result};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::input::Plate;
use corehbot_host::printer::Printer;
use corehbot_host::progress::Progress;
use corehbot_host::say::note;
use corehbot_host::stop::Stop;
use corehbot_questions::play::{RunModel, played};
use corehbot_questions::setup::{MachineArgs, parse_pair};
use corehbot_questions::source::Source;
use corehbot_report::twin as page;
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use std::path::{Path, PathBuf};

/// The file to play, and its machine.
#[derive(Args)]
pub(crate) struct Play {
    /// G-code, which goes through the firmware first, or a step trace (corehbot run --trace).
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    plate: Plate,
    #[command(flatten)]
    machine: MachineArgs,
    /// Parts that move besides the tool.
    #[arg(long, value_enum, default_value = "reduced")]
    model: RunModel,
    /// Measures errors against the path of this file, from which the played file was made (corehbot-lab compensate).
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// The tool's place at the begin, in mm from motor 1's axis; without it, the place that the firmware assumes.
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    #[command(flatten)]
    printer: Printer,
    /// Writes a page with the error along the path, tensions and torques over time, and the resonance of the machine.
    #[arg(long, value_name = "R.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl Play {
    pub(super) fn answer(&self) -> Result<u8> {
        let (machine, params) = self.machine.read(&self.printer.machine()?)?;
        let files: Vec<&Path> =
            self.printer.files().chain([self.file.as_path()]).chain(self.against.as_deref()).collect();
        self.json.check(files.iter().copied(), &self.report)?;
        let stop = Stop::at_signals()?;
        let played = Source::read(&self.file, self.plate, &self.printer, &stop).and_then(|source| {
            let start = self.start(machine, &params, source.begin);
            let meant =
                |file: &PathBuf| Ok::<_, anyhow::Error>(Source::read(file, self.plate, &self.printer, &stop)?.steps);
            let meant = self.against.as_ref().map(meant).transpose()?;
            let steps = (&source.steps, meant.as_ref());
            Progress::new([1.0])
                .piece(0, &stop, |go_on| played(machine, &params, start, self.model, steps, go_on))
                .with_context(|| self.file.display().to_string())
        });
        match (played, stop.status()) {
            (_, Some(status)) => {
                note(format_args!("corehbot: interrupted"));
                Ok(status)
            }
            (played, None) => {
                let (report, watch) = played?;
                self.json.give_with(&report, files, |outputs| {
                    let Some(path) = &self.report else { return Ok(()) };
                    let file = self.file.display().to_string();
                    page::write(&mut outputs.open(path)?, &file, (machine, &params), &report, &watch)
                })
            }
        }
    }

    /// The firmware's place is one of G-code.
    fn start(&self, machine: Machine, params: &Params, begin: [f64; 3]) -> Place {
        let reach = workspace(machine, params);
        let firmware = reach.of_gcode(begin);
        match self.at {
            Some([x, y]) => Place { x, y, ..firmware },
            None => firmware,
        }
    }
}
