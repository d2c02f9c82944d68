//! Lines of a journal: a sample each, with a check at the end that detects a cut line.
//!
//! `corehbot-lab sweep STUDY.toml --sample I` prints one, so a journal can also be joined from the samples of other
//! machines. A line is one JSON object. Its last entry is the check, the first four bytes of the SHA-256 of the text
//! before it.

use super::plan::{Point, Sample, Study};
use serde::{Deserialize, Serialize, Serializer};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;

/// Begin of a line's check.
const CHECK: &str = ",\"check\":\"";

/// Bytes of a check.
const CHECK_BYTES: usize = 4;

/// Names with their values, in order.
struct Entries<'a>(Vec<(&'a str, Option<f64>)>);

impl Serialize for Entries<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().copied())
    }
}

/// The first line of a journal.
#[derive(Serialize, Deserialize)]
struct Head {
    study: String,
    samples: usize,
}

/// A sample as it is written.
#[derive(Serialize)]
struct Written<'a> {
    study: &'a str,
    sample: usize,
    machine: &'static str,
    values: Entries<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    figures: Option<Entries<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

/// A sample as it is read.
#[derive(Deserialize)]
struct Read {
    study: String,
    sample: usize,
    figures: Option<BTreeMap<String, Option<f64>>>,
    error: Option<String>,
}

/// The first line: which study, and how many samples it has.
pub(super) fn head(study: &Study) -> serde_json::Result<String> {
    checked(&Head { study: study.identity.clone(), samples: study.samples })
}

/// Whether a line is the first one of any study's journal.
pub(super) fn is_head(line: &str) -> bool {
    is_sound(line) && serde_json::from_str::<Head>(line).is_ok()
}

/// The line of a sample; empty if the study has no such sample.
pub(super) fn of_sample(study: &Study, sample: &Sample) -> serde_json::Result<String> {
    let number = sample.number;
    let Some(Point { machine, values }) = study.point(number) else { return Ok(String::new()) };
    let values = Entries(study.keys.iter().map(String::as_str).zip(values.into_iter().map(Some)).collect());
    let figures =
        sample.outcome.as_ref().ok().map(|figures| Entries(study.figures().zip(figures.iter().copied()).collect()));
    let error = sample.outcome.as_ref().err().map(String::as_str);
    checked(&Written { study: &study.identity, sample: number, machine: machine.key(), values, figures, error })
}

/// The sample of a line, if the line is whole and is of this study.
pub(super) fn sample(study: &Study, line: &str) -> Option<Sample> {
    let read: Read = is_sound(line).then(|| serde_json::from_str(line).ok()).flatten()?;
    let outcome = match (read.figures, read.error) {
        (Some(figures), None) => {
            Ok(study.figures().map(|name| figures.get(name).copied()).collect::<Option<Vec<_>>>()?)
        }
        (None, Some(error)) => Err(error),
        _ => return None,
    };
    (read.study == study.identity && read.sample < study.samples).then_some(Sample { number: read.sample, outcome })
}

fn checked(entries: &impl Serialize) -> serde_json::Result<String> {
    let text = serde_json::to_string(entries)?;
    let open = text.strip_suffix('}').unwrap_or(&text);
    Ok(format!("{open}{CHECK}{}\"}}", check(open)))
}

fn is_sound(line: &str) -> bool {
    let parts = line.rsplit_once(CHECK);
    parts.is_some_and(|(open, rest)| rest.strip_suffix("\"}") == Some(check(open).as_str()))
}

fn check(open: &str) -> String {
    hex(&Sha256::digest(open.as_bytes()), CHECK_BYTES)
}

/// The first bytes as hexadecimal digits.
pub(super) fn hex(bytes: &[u8], count: usize) -> String {
    bytes.iter().take(count).map(|byte| format!("{byte:02x}")).collect()
}
