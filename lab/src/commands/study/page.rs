//! Page: a picture of each figure over each varied number, without any network, in the style of `corehbot twin run
//! --report`.

use super::plan::{Sample, Study};
use super::summary::Summary;
use crate::pages::STUDY;
use anyhow::{Context as _, Result};
use corehbot_report::twin::fill;
use corehbot_twin::params::split_unit;
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;

/// Most samples that are drawn; of more, the samples of points chosen by chance.
const MOST_DRAWN: usize = 5000;

#[derive(Serialize)]
struct Data<'a> {
    file: &'a str,
    summary: &'a Summary,
    keys: &'a [String],
    figures: &'a [&'a str],
    /// The title and the unit of each key and each figure.
    titles: BTreeMap<&'a str, (&'a str, &'static str)>,
    machines: Vec<&'static str>,
    points: Vec<Drawn>,
}

/// A sample that has figures.
#[derive(Serialize)]
struct Drawn {
    sample: usize,
    /// Its place among `machines`.
    machine: usize,
    values: Vec<f64>,
    figures: Vec<Option<f64>>,
}

/// Writes the page.
///
/// # Errors
/// The error from `out`.
pub(super) fn write(
    out: &mut impl Write,
    file: &str,
    study: &Study,
    (samples, summary): (&[Sample], &Summary),
) -> Result<()> {
    let drawn = |sample: &Sample| {
        let point = study.point(sample.number)?;
        let machine = study.machines.iter().position(|machine| *machine == point.machine)?;
        let figures = sample.outcome.as_ref().ok()?.clone();
        Some(Drawn { sample: sample.number, machine, values: point.values, figures })
    };
    let machines = study.machines.len().max(1);
    let points = chosen(study.samples / machines, MOST_DRAWN / machines);
    let figures: Vec<&str> = study.figures().collect();
    let names = study.keys.iter().map(String::as_str).chain(figures.iter().copied());
    let data = Data {
        file,
        summary,
        keys: &study.keys,
        figures: &figures,
        titles: names.map(|name| (name, split_unit(name))).collect(),
        machines: study.machines.iter().map(|machine| machine.name()).collect(),
        points: samples
            .iter()
            .filter(|sample| points.contains(&(sample.number / machines)))
            .filter_map(drawn)
            .collect(),
    };
    fill(out, STUDY, &data).context("cannot write the report")
}

/// At most `most` of a design's points, by their numbers: the points with the least hashes.
///
/// Every nth one would leave out whole levels of a grid, because its last number changes fastest.
fn chosen(points: usize, most: usize) -> BTreeSet<usize> {
    let mut order: Vec<usize> = (0..points).collect();
    if points > most {
        order.sort_by_cached_key(|point| Sha256::digest((*point as u64).to_le_bytes()));
        order.truncate(most);
    }
    order.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::study::read;
    use serde_json::Value;

    /// Two machines, and 10 * 6 * 60 points; a page draws 2,500 of them.
    const STUDY: &str = "\
compute = [\"stiffness\"]
machines = [\"corehbot\", \"corexy\"]
method = \"grid\"
[vary]
belt_EA_N = { from = 20000, to = 56000, count = 10 }
preload_N = { from = 30, to = 50, count = 6 }
head_mass_kg = { from = 0.4, to = 0.8, count = 60 }
";

    #[test]
    fn of_many_samples_every_machine_and_every_level_is_drawn_in_fair_parts() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("s.toml");
        std::fs::write(&file, STUDY).unwrap();
        let study = read::read(&file).unwrap();
        assert_eq!(study.samples, 7200);
        let sample = |number| Sample { number, outcome: Ok(vec![Some(number as f64); 4]) };
        let samples: Vec<_> = (0..study.samples).map(sample).collect();
        let mut bytes = Vec::new();
        write(&mut bytes, "s.toml", &study, (&samples, &Summary::new(&study, &samples))).unwrap();
        let page = String::from_utf8(bytes).unwrap();
        let data = page.split_once("const D = ").unwrap().1.split_once(";\n").unwrap().0;
        let data: Value = serde_json::from_str(data).unwrap();
        let drawn = data["points"].as_array().unwrap();
        assert_eq!(drawn.len(), MOST_DRAWN);
        // Both machines have the same points.
        let numbers: Vec<u64> = drawn.iter().map(|point| point["sample"].as_u64().unwrap()).collect();
        assert!(numbers.chunks(2).all(|pair| pair[0] % 2 == 0 && pair[1] == pair[0] + 1), "{numbers:?}");
        assert!(drawn.iter().all(|point| point["machine"].as_u64() == point["sample"].as_u64().map(|n| n % 2)));
        // A level of k has 5000 / k of them; four standard deviations of a draw that is not put back are allowed.
        for (key, levels) in [(0, 10), (1, 6), (2, 60)] {
            let mut count: BTreeMap<String, u32> = BTreeMap::new();
            drawn.iter().for_each(|point| *count.entry(point["values"][key].to_string()).or_default() += 1);
            assert_eq!(count.len(), levels);
            let part = 1.0 / levels as f64;
            let spread = 2.0 * (2500.0 * part * (1.0 - part) * (1.0 - 2500.0 / 3600.0)).sqrt();
            let fair = |n: &u32| (f64::from(*n) - 5000.0 * part).abs() <= 4.0 * spread;
            assert!(count.values().all(fair), "{key}: {count:?}, {spread}");
        }
    }

    #[test]
    fn few_points_are_drawn_all() {
        assert_eq!(chosen(4, 4), BTreeSet::from([0, 1, 2, 3]));
        assert_eq!(chosen(1000, 10).len(), 10);
        assert_eq!(chosen(0, 10), BTreeSet::new());
    }
}
