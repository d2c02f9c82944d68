//! Compute: the samples of a study on all cores, each kept in the journal as soon as it is finished.

use super::journal::Journal;
use super::line;
use super::plan::{Sample, Study};
use anyhow::{Context as _, Result};
use corehbot_host::progress::progress_bar;
use corehbot_host::stop::Stop;
use rayon::ThreadPoolBuilder;
use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};
use std::sync::{Mutex, PoisonError};

/// Computes the samples that are not among `kept`, on this many threads (`None`: one a core).
///
/// All samples in their order; if it was stopped, only the finished ones.
///
/// # Errors
/// The file for samples cannot be read, or the journal cannot be written.
pub(in crate::commands) fn compute(
    study: &Study,
    journal: Option<&mut Journal>,
    kept: Vec<Sample>,
    jobs: Option<usize>,
    stop: &Stop,
) -> Result<Vec<Sample>> {
    let mut samples: Vec<Option<Sample>> = vec![None; study.samples];
    // A sample that was computed twice counts once.
    for sample in kept {
        if let Some(place) = samples.get_mut(sample.number) {
            place.get_or_insert(sample);
        }
    }
    let missing: Vec<usize> = (0..study.samples).filter(|i| samples.get(*i).is_some_and(Option::is_none)).collect();
    let loaded = if missing.is_empty() { Ok(()) } else { study.load(stop) };
    if stop.is_set() {
        return Ok(samples.into_iter().flatten().collect());
    }
    loaded?;
    let bar = progress_bar(study.samples as u64, "samples");
    bar.set_position((study.samples - missing.len()) as u64);
    let journal = journal.map(Mutex::new);
    let one = |number: usize| -> Result<Option<Sample>> {
        let sample = if stop.is_set() { None } else { study.sample(number, stop) };
        if let (Some(sample), Some(journal)) = (&sample, &journal) {
            let line = line::of_sample(study, sample)?;
            journal.lock().unwrap_or_else(PoisonError::into_inner).append(&line)?;
        }
        bar.inc(u64::from(sample.is_some()));
        Ok(sample)
    };
    let pool = ThreadPoolBuilder::new().num_threads(jobs.unwrap_or(0)).build().context("cannot start threads")?;
    let computed: Result<Vec<Option<Sample>>> = pool.install(|| missing.into_par_iter().map(one).collect());
    bar.finish_and_clear();
    for sample in computed?.into_iter().flatten() {
        let number = sample.number;
        if let Some(place) = samples.get_mut(number) {
            *place = Some(sample);
        }
    }
    Ok(samples.into_iter().flatten().collect())
}
