//! `corehbot resonance`: analysis of an accelerometer's recordings, computed by the crate `corehbot-resonance`.
//!
//! File names tell the axis of a sweep, or the speed and angle of a run. Recordings of x, y and z are judged for
//! shapers, those of both belt paths are compared, and runs become a profile.

mod drives;
mod excite;
mod text;

use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use corehbot_host::answer::Json;
use corehbot_host::printer::Printer;
use corehbot_host::values::number;
use corehbot_machine_file::file_kind::{FileKind, START, Wanted, WrongFile};
use corehbot_report::resonance as page;
use corehbot_resonance::axis::{Axis, Measured, Named, Question, judge, measure, measure_density};
use corehbot_resonance::density;
use corehbot_resonance::label;
use corehbot_resonance::motors::Drive;
use corehbot_resonance::profile::{self, Profile};
use corehbot_resonance::recording::{self, Flaw, Recording};
use corehbot_resonance::run;
use corehbot_resonance::spectrum::Density;
use corehbot_resonance::stdata;
use corehbot_resonance::sweep::Sweep;
use corehbot_twin::shaping::wall::Print;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// `corehbot resonance`.
#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Resonance {
    #[command(subcommand)]
    part: Option<excite::Part>,
    /// Raw recordings: Klipper's (`#time,accel_x,accel_y,accel_z`), RepRapFirmware's (`Sample,X,Y,Z`), or Shake&Tune's
    /// (.stdata, with the names of its recordings in it). Klipper's spectra of a sweep (`freq,psd_x,...`) serve too.
    #[arg(value_name = "FILE.csv", required = true)]
    files: Vec<PathBuf>,
    /// Axis of the sweep in files with names that do not tell it: x, y, z, or the belt paths a (1,-1) and b (1,1).
    #[arg(long, value_name = "AXIS", value_parser = parse_axis)]
    axis: Option<label::Axis>,
    /// First and last frequency of the sweep, in Hz.
    #[arg(long, value_name = "FROM-TO", value_parser = parse_range, default_value = "5-135")]
    sweep: [f64; 2],
    /// Growth of the sweep's frequency, in Hz per second.
    #[arg(long, value_name = "HZ_PER_S", allow_negative_numbers = true, value_parser = number(0.1, 10.0), default_value = "1")]
    growth: f64,
    /// Amplitude of a sweep by `resonance sweep`, if it is one: acceleration over frequency in mm/s^2 per Hz, and
    /// length of a step in mm.
    #[arg(long, value_name = "MM_S2_PER_HZ,MM", value_parser = parse_moves)]
    by_moves: Option<[f64; 2]>,
    /// Uncertainty of the frequency in percent. Without it the fit says it, but at least 5: one place is not all.
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = number(0.0, 50.0))]
    uncertainty: Option<f64>,
    /// Acceleration of the walls that are judged, in mm/s^2.
    #[arg(long, value_name = "MM_S2", allow_negative_numbers = true, value_parser = number(100.0, 100_000.0), default_value = "5000")]
    acceleration: f64,
    /// Speed of the walls, in mm/s.
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true, value_parser = number(1.0, 1000.0), default_value = "100")]
    speed: f64,
    /// Speed at their corners, in mm/s.
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true, value_parser = number(0.0, 100.0), default_value = "5")]
    corner_speed: f64,
    /// The machine file of the machine that was recorded: in runs at one speed its motors' steps have frequencies of
    /// their own. Without it, the CoreH-bot prototype.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    machine_file: Option<PathBuf>,
    /// Writes a page with spectra, shapers, belts and the profile.
    #[arg(long, value_name = "R.html")]
    report: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

/// Why a recording of an axes map is refused.
const AXES_MAP: &str = "this is a calibration of the sensor's axes by Shake&Tune, with short moves and no sweep; \
                        record a sweep (AXES_SHAPER_CALIBRATION)";

/// Why a spectrum of a run at one speed is refused.
const RUN_SPECTRUM: &str = "this is a run at one speed, and its file has a spectrum; runs need raw data";

/// What a file has of a sweep.
enum Swept {
    Samples(Recording),
    Spectrum(Density),
}

/// The parts of a file with their names, and flaws of those that are left out.
type Contents = (Vec<(String, Swept)>, Vec<String>);

/// The recordings, read and checked.
pub(crate) struct Prepared {
    sweeps: BTreeMap<Option<label::Axis>, Vec<(String, Swept)>>,
    runs: Vec<(String, [f64; 2], Recording)>,
    left_out: Vec<String>,
    drives: Vec<Drive>,
}

/// Everything that was found.
#[derive(Serialize)]
pub(crate) struct Answer {
    /// An entry for each axis that was swept.
    axes: Vec<Axis>,
    /// Both belt paths.
    belts: Option<Belts>,
    /// Vibration by speed and angle.
    profile: Option<Profile>,
    /// Recordings of a file with several that would mislead, each with its flaw.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    left_out: Vec<String>,
}

/// Comparison of two belt paths, and their recordings.
#[derive(Serialize)]
struct Belts {
    comparison: corehbot_resonance::belts::Comparison,
    recordings: [Measured; 2],
}

impl Prepared {
    /// Reads all files.
    ///
    /// # Errors
    /// One is no recording, or the files do not belong together.
    pub(crate) fn new(args: &Resonance) -> Result<Self> {
        ensure!(args.corner_speed <= args.speed, "the speed at corners is above the speed of the walls");
        let (mut sweeps, mut runs, mut left_out) = (BTreeMap::new(), Vec::new(), Vec::new());
        let check = |name: &str| {
            ensure!(!label::is_axes_map(name), "{name}: {AXES_MAP}");
            Ok(())
        };
        for path in &args.files {
            let name = path.display().to_string();
            let cannot = || format!("cannot read {name}");
            let wanted = Wanted::Recording;
            ensure!(!path.is_dir(), "{}: {}", cannot(), WrongFile { kind: FileKind::Folder, wanted });
            // Before its samples, which are too few for a sweep.
            check(&name)?;
            let bytes = std::fs::read(path).with_context(cannot)?;
            let kind = FileKind::of(&bytes[..bytes.len().min(START)], bytes.len() as u64);
            wanted.check(kind).with_context(|| name.clone())?;
            let (contents, flaws) = contents(&name, &bytes).with_context(|| name.clone())?;
            left_out.extend(flaws.into_iter().map(|flaw| format!("{}: {flaw}", short(&name))));
            for (name, part) in contents {
                check(&name)?;
                match (label::run(&name), part) {
                    (Some((angle, speed)), Swept::Samples(recording)) => runs.push((name, [angle, speed], recording)),
                    (Some(_), Swept::Spectrum(_)) => bail!("{name}: {RUN_SPECTRUM}"),
                    (None, part) => {
                        let axis = label::axis(&name).or(args.axis);
                        sweeps.entry(axis).or_insert_with(Vec::new).push((name, part));
                    }
                }
            }
        }
        let drives = drives::of(&Printer::new(args.machine_file.clone(), None).machine()?.settings);
        Ok(Self { sweeps, runs, left_out, drives })
    }

    /// Judges the recordings and gives the answer.
    ///
    /// # Errors
    /// A recording is too short for its question, or an output cannot be written.
    pub(crate) fn run(self, args: &Resonance) -> Result<u8> {
        if let Some(part) = &args.part {
            return part.run();
        }
        let inputs = || args.files.iter().chain(&args.machine_file).map(PathBuf::as_path);
        args.json.check(inputs(), &args.report)?;
        let answer = self.answer(&args.question())?;
        args.json.give_with(&answer, inputs(), |outputs| {
            let Some(path) = &args.report else { return Ok(()) };
            let belts = answer.belts.as_ref().map(|belts| (&belts.comparison, &belts.recordings));
            page::write(&mut outputs.open(path)?, &answer.axes, belts, answer.profile.as_ref())
        })
    }

    fn answer(mut self, question: &Question) -> Result<Answer> {
        let measured = |axis: Option<label::Axis>, (file, part): &(String, Swept)| {
            let step = question.sweep.resolution_mm;
            let sweep = Sweep { resolution_mm: axis.map_or(step, |axis| along(axis, step)), ..question.sweep };
            match part {
                Swept::Samples(recording) => {
                    measure(Named { file: short(file), recording }, axis, &sweep).with_context(|| file.clone())
                }
                Swept::Spectrum(density) => Ok(measure_density(short(file), density, axis, &sweep)),
            }
        };
        let both = [label::Axis::A, label::Axis::B].map(Some);
        let belts = match both.map(|path| self.sweeps.get(&path).and_then(|all| all.first())) {
            [Some(a), Some(b)] => Some([measured(both[0], a)?, measured(both[1], b)?]),
            _ => None,
        };
        if belts.is_some() {
            for path in both {
                let count = self.sweeps.remove(&path).map_or(0, |all| all.len());
                ensure!(count == 1, "expected one recording of each belt path, found {count} of one");
            }
        }
        let belts = belts.map(|recordings| {
            let [a, b] = &recordings;
            Belts { comparison: corehbot_resonance::belts::compare(a, b), recordings }
        });
        let axis = |(axis, all): (&Option<label::Axis>, &Vec<(String, Swept)>)| {
            let all = all.iter().map(|one| measured(*axis, one)).collect::<Result<Vec<_>>>()?;
            Ok(judge(*axis, all, question))
        };
        let axes = self.sweeps.iter().map(axis).collect::<Result<Vec<_>>>()?;
        let run = |(file, place, recording): &(String, [f64; 2], Recording)| {
            run::run(short(file), *place, recording)
                .with_context(|| format!("{file}: it is shorter than half a second"))
        };
        let runs = self.runs.iter().map(run).collect::<Result<Vec<_>>>()?;
        let profile = (!runs.is_empty()).then(|| profile::profile(runs, &self.drives));
        Ok(Answer { axes, belts, profile, left_out: self.left_out })
    }
}

impl Resonance {
    fn question(&self) -> Question {
        let [from_hz, to_hz] = self.sweep;
        let mut sweep = Sweep { from_hz, to_hz, hz_per_s: self.growth, ..Sweep::default() };
        if let Some([accel_per_hz, resolution_mm]) = self.by_moves {
            sweep = Sweep { accel_per_hz, resolution_mm, swing_accel: 0.0, ..sweep };
        }
        Question {
            sweep,
            print: Print {
                acceleration_mm_s2: self.acceleration,
                speed_mm_s: self.speed,
                corner_speed_mm_s: self.corner_speed,
            },
            uncertainty: self.uncertainty.map(|percent| percent / 100.0),
        }
    }
}

/// The parts of a file.
fn contents(name: &str, bytes: &[u8]) -> Result<Contents, Flaw> {
    if bytes.starts_with(stdata::HEAD) {
        let stdata::Contents { recordings, left_out } = stdata::read(bytes)?;
        let recordings = recordings.into_iter().map(|(name, recording)| (name, Swept::Samples(recording))).collect();
        return Ok((recordings, left_out.iter().map(ToString::to_string).collect()));
    }
    let text = recording::text(bytes)?;
    if density::is_density(&text) {
        let spectra = density::read(&text)?.into_iter().map(|(own, density)| {
            let name = if own.is_empty() { name.to_owned() } else { format!("{name} ({own})") };
            (name, Swept::Spectrum(density))
        });
        return Ok((spectra.collect(), Vec::new()));
    }
    Ok((vec![(name.to_owned(), Swept::Samples(recording::read(bytes)?))], Vec::new()))
}

/// The file's name without its folders.
fn short(file: &str) -> &str {
    Path::new(file).file_name().and_then(|name| name.to_str()).unwrap_or(file)
}

fn parse_axis(text: &str) -> Result<label::Axis, String> {
    label::Axis::of(text).ok_or_else(|| format!("`{text}` is no axis: x, y, z, a or b"))
}

/// `34,0.0125`.
fn parse_moves(text: &str) -> Result<[f64; 2], String> {
    let pair = text.split_once(',').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    let is_legal = |[accel, step]: &[f64; 2]| (1.0..=500.0).contains(accel) && (0.0..=1.0).contains(step);
    pair.filter(is_legal)
        .ok_or_else(|| format!("`{text}` is not acceleration over frequency and a step, like 34,0.0125"))
}

/// Length along an axis of a step of x and y.
fn along(axis: label::Axis, step_mm: f64) -> f64 {
    let is_diagonal = matches!(axis, label::Axis::A | label::Axis::B);
    if is_diagonal { step_mm * std::f64::consts::SQRT_2 } else { step_mm }
}

/// `5-135`.
fn parse_range(text: &str) -> Result<[f64; 2], String> {
    let pair = text.split_once('-').and_then(|(from, to)| Some([from.trim().parse().ok()?, to.trim().parse().ok()?]));
    let is_legal = |[from, to]: &[f64; 2]| *from >= 1.0 && *to <= 400.0 && to - from >= 20.0;
    pair.filter(is_legal)
        .ok_or_else(|| format!("`{text}` is no range like 5-135, from 1 to 400 Hz and at least 20 Hz wide"))
}
