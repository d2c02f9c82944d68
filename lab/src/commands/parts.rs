//! `corehbot-lab parts`: errors of reference parts' dimensions, by machine and by speed.

use crate::drawings::parts::picture;
use crate::parts::figures::{PartFigures, Parts as Answer};
use crate::parts::{Part, ROOM_MM};
use crate::queries::compare::COMPARED;
use anyhow::{Result, ensure};
use clap::Args;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_host::answer::Json;
use corehbot_host::answer::drawn;
use corehbot_host::progress::progress_bar;
use corehbot_host::say::note;
use corehbot_host::stop::Stop;
use corehbot_questions::play::{RunModel, played};
use corehbot_questions::setup::{FileArgs, MachineArg, MachineArgs, has_room, parse_pair};
use corehbot_questions::source::steps_of;
use corehbot_twin::geometry::workspace;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::RunError;
use indicatif::ProgressBar;
use rayon::iter::{IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _};
use std::path::PathBuf;

/// `corehbot-lab parts`.
#[derive(Args)]
pub(crate) struct Parts {
    #[command(flatten)]
    file: FileArgs,
    /// Runs of the belts, instead of the machine file's; without both, CoreH-bot, H-bot and CoreXY.
    #[arg(long, value_enum, value_delimiter = ',')]
    routing: Vec<MachineArg>,
    /// Commanded speeds in mm/s; the machine's limits hold.
    #[arg(long, value_name = "MM_S,...", allow_negative_numbers = true, value_delimiter = ',', value_parser = parse_speed, default_value = "50,100,150,200,250,300")]
    speed: Vec<f64>,
    /// The part's middle, in mm from motor 1's axis; the middle of each machine's reach without it.
    #[arg(long, value_name = "X,Y", value_parser = parse_pair, allow_hyphen_values = true)]
    at: Option<[f64; 2]>,
    /// Parts that move besides the tool.
    #[arg(long, value_enum, default_value = "rotors")]
    model: RunModel,
    /// Draws the errors by speed, as SVG.
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl Parts {
    pub(crate) fn answer(&self) -> Result<u8> {
        self.json.check(self.file.files(), &self.svg)?;
        let stop = Stop::at_signals()?;
        let figures = self.figures(&stop);
        if let Some(status) = stop.status() {
            note(format_args!("corehbot: interrupted"));
            return Ok(status);
        }
        let answer = Answer::new(figures?);
        self.json
            .give_with(&answer, self.file.files(), |outputs| drawn(outputs, self.svg.as_deref(), || picture(&answer)))
    }

    fn figures(&self, stop: &Stop) -> Result<Vec<PartFigures>> {
        let file = self.file.read()?;
        let machines = if !self.routing.is_empty() {
            self.routing.iter().map(|machine| (*machine).into()).collect()
        } else if self.file.files().next().is_some() {
            vec![MachineArgs::default().read(&file)?.0]
        } else {
            COMPARED.to_vec()
        };
        let params = MachineArgs::default().read(&file).map_or_else(|_| file.twin.params.clone(), |(_, params)| params);
        has_room(&machines, &params)?;
        let (begin, middle) = middle(&file.settings)?;
        let jobs: Vec<(f64, Part)> = self.speed.iter().flat_map(|v| Part::ALL.map(|part| (*v, part))).collect();
        let bar = progress_bar((jobs.len() * machines.len()) as u64, "parts");
        let traces: Vec<_> = jobs
            .par_iter()
            .map(|(speed, part)| steps_of(&part.gcode(middle, *speed), &file.settings, begin))
            .collect::<Result<_>>()?;
        let mut all = Vec::new();
        for machine in machines {
            let place = self.place(machine, &params)?;
            let play = |((_, part), trace): (&(f64, Part), &_)| {
                self.play((machine, &params), place, (*part, trace), &bar, stop)
            };
            let watched: Vec<_> = jobs.par_iter().zip(traces.par_iter()).map(play).collect::<Result<_>>()?;
            let mut done = jobs.iter().zip(&traces).zip(&watched);
            for speed in &self.speed {
                let mut figures = PartFigures::new(machine, *speed);
                for (((_, part), trace), watch) in done.by_ref().take(Part::ALL.len()) {
                    let is_whole = figures.take(*part, trace, watch, place);
                    ensure!(is_whole, "the firmware did not make all loops of a part at {speed} mm/s");
                }
                all.push(figures);
            }
        }
        bar.finish_and_clear();
        Ok(all)
    }

    fn play(
        &self,
        (machine, params): (Machine, &Params),
        place: Place,
        (part, trace): (Part, &corehbot_twin::steps::StepTrace),
        bar: &ProgressBar,
        stop: &Stop,
    ) -> Result<corehbot_twin::run::watch::Watch> {
        let name = machine.name();
        let played = played(machine, params, place, self.model, (trace, None), |_| !stop.is_set());
        let (_, watch) = played.map_err(|error| {
            // The firmware makes the steps for the motors of the file.
            let context = match &error {
                RunError::NoColumn(_) => format!("the {name} needs a machine file with its motors (--machine)"),
                _ => format!("{name}, {part:?}"),
            };
            anyhow::Error::new(error).context(context)
        })?;
        bar.inc(1);
        Ok(watch)
    }

    /// The part's middle on a machine.
    fn place(&self, machine: Machine, params: &Params) -> Result<Place> {
        let reach = workspace(machine, params);
        let Some([x, y]) = self.at else { return Ok(reach.centre()) };
        let half = ROOM_MM / 2.0;
        let fits = [[x - half, y - half], [x + half, y + half]].iter().all(|[x, y]| reach.has(reach.at(*x, *y)));
        ensure!(
            fits,
            "parts of {ROOM_MM} mm about ({x}, {y}) leave what the {}'s tool reaches: {reach}",
            machine.name()
        );
        Ok(reach.at(x, y))
    }
}

/// The middle of the axes in G-code, where the firmware begins.
fn middle(settings: &Settings) -> Result<([Mm; 3], [f64; 2])> {
    let lengths = [settings.axes.x.length, settings.axes.y.length];
    ensure!(lengths.iter().all(|length| length.to_num::<f64>() >= ROOM_MM), "the parts need axes of {ROOM_MM} mm");
    let [x, y] = lengths.map(|length| (length.to_num::<f64>() / 2.0).round());
    Ok(([x, y, 0.0].map(Mm::from_num), [x, y]))
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let legal = text.trim().parse().ok().filter(|v| (1.0..=2000.0).contains(v));
    legal.ok_or_else(|| format!("`{text}` is not a speed from 1 to 2000 mm/s"))
}
