//! Read: from a study's file to its computation, with the files that it names.

use super::check::{check, design, samples};
use super::error::StudyError;
use super::form::{QueryToml, RunToml, StudyToml};
use super::plan::Study;
use super::played::Played;
use super::query::{Places, Query};
use anyhow::{Context as _, Result, anyhow};
use corehbot::units::Mm;
use corehbot_host::input::{self, Plate};
use corehbot_host::printer::Printer;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_questions::setup::ModelArg;
use corehbot_twin::routing::{Machine, Place};
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Reads a study; a played file is only hashed.
///
/// # Errors
/// The error, with file, line and column.
pub(super) fn read(path: &Path) -> Result<Study> {
    let file = path.display();
    let text = input::text(path, Wanted::Study)?;
    let located = |error: StudyError| match error.place(&text) {
        Some(place) => anyhow!("{file}:{place}: {error}"),
        None => anyhow!("{file}: {error}"),
    };
    let form: StudyToml = toml::from_str(&text).map_err(StudyError::Syntax).map_err(located)?;
    check(&form).map_err(located)?;
    let (keys, design) = design(&form).map_err(located)?;
    let samples = samples(&design, form.machines.len()).map_err(located)?;
    let files = files(&form, path);
    let identity = identity(&form, &keys, &files, PLATFORM)?;
    let queries = form.compute.iter().filter_map(|query| self::query(*query, &form, path)).collect();
    let machines = form.machines.iter().map(|machine| Machine::from(*machine)).collect();
    let inputs = std::iter::once(path.to_owned()).chain(files).collect();
    Ok(Study { identity, machines, params: form.twin, keys, design, samples, queries, inputs })
}

/// The files that a study names, from where the command runs.
fn files(form: &StudyToml, path: &Path) -> Vec<PathBuf> {
    let Some(run) = &form.run else { return Vec::new() };
    std::iter::once(&run.file).chain(&run.settings).map(|file| beside(path, file)).collect()
}

/// A file that is named in the file at `path`.
fn beside(path: &Path, file: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(file)
}

/// The last bits of the samples depend on these besides the build. The C library rounds `sin`, `tanh`, `exp` and
/// `hypot` in its own way, which also depends on the processor's features.
pub(super) const PLATFORM: [&str; 3] = [std::env::consts::ARCH, std::env::consts::OS, C_LIBRARY];

/// The C library, as the target's name ends in it.
const C_LIBRARY: &str = if cfg!(target_env = "gnu") {
    "gnu"
} else if cfg!(target_env = "musl") {
    "musl"
} else if cfg!(target_env = "msvc") {
    "msvc"
} else {
    ""
};

/// The identity of a study: all inputs of its samples, except the code that computes them.
pub(super) fn identity(form: &StudyToml, keys: &[String], files: &[PathBuf], platform: [&str; 3]) -> Result<String> {
    #[derive(Serialize)]
    struct All<'a> {
        version: &'static str,
        platform: [&'a str; 3],
        study: &'a StudyToml,
        /// The order of the numbers, which `study` does not tell.
        keys: &'a [String],
    }
    let all = All { version: env!("CARGO_PKG_VERSION"), platform, study: form, keys };
    let mut hash = Sha256::new_with_prefix(serde_json::to_vec(&all)?);
    for file in files {
        let bytes = std::fs::read(file).with_context(|| format!("cannot open {}", file.display()))?;
        hash.update(Sha256::digest(bytes));
    }
    Ok(super::line::hex(&hash.finalize(), IDENTITY))
}

/// Bytes of a hash that tell studies apart.
const IDENTITY: usize = 8;

fn query(query: QueryToml, form: &StudyToml, path: &Path) -> Option<Query> {
    let freedom = form.model.unwrap_or_else(|| model(query)).freedom();
    let places = match (form.at, form.worst_of) {
        (Some([x, y]), _) => Places::At(Place::flat(x, y)),
        (None, Some(grid)) => Places::Worst(grid),
        (None, None) => Places::Centre,
    };
    match query {
        QueryToml::Stiffness => Some(Query::Stiffness { places, freedom }),
        QueryToml::Modes => Some(Query::Modes { places, freedom }),
        QueryToml::Push => form.push.as_ref().map(|push| Query::Push { places, freedom, force_n: push.force_n }),
        QueryToml::Limits => {
            let (error_mm, torque_part) = (form.limits.error_mm, form.limits.torque);
            Some(Query::Limits { freedom, error_mm, torque_part })
        }
        QueryToml::Resonance => Some(Query::Resonance { freedom, grid: form.resonance.grid }),
        QueryToml::Run => form.run.as_ref().map(|run| played(run, path)),
    }
}

/// The model of a query without `model`: the default of its command.
pub(super) const fn model(query: QueryToml) -> ModelArg {
    match query {
        QueryToml::Limits | QueryToml::Resonance => ModelArg::Rotors,
        QueryToml::Stiffness | QueryToml::Modes | QueryToml::Push | QueryToml::Run => ModelArg::Reduced,
    }
}

fn played(run: &RunToml, path: &Path) -> Query {
    let settings = run.settings.as_deref().map(|file| beside(path, file));
    let printer = Printer::new(settings, run.assume_homed.map(|place| place.map(Mm::from_num)));
    let file = Played::new(beside(path, &run.file), Plate::default(), printer);
    let begin = run.begin.map(|[x, y]| Place::flat(x, y));
    Query::Run { file, model: run.model, begin }
}
