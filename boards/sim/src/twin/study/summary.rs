//! Summary: what a study says in a few lines: the range of each figure, and which of the varied numbers it follows.

use super::plan::{Sample, Study};
use serde::Serialize;
use std::collections::BTreeMap;

/// A study in short.
#[derive(Serialize)]
pub(super) struct Summary {
    /// Its samples.
    samples: usize,
    /// Those that have no figures.
    failed: usize,
    /// Why the first of these has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    first_failure: Option<String>,
    figures: Vec<Column>,
}

/// A figure of a machine in short.
#[derive(Serialize)]
struct Column {
    machine: &'static str,
    name: &'static str,
    least: f64,
    median: f64,
    greatest: f64,
    /// Spearman's rank correlation with each number: 1 if it only rises with it, -1 if it only falls.
    rank_correlation: BTreeMap<String, f64>,
}

impl Summary {
    /// Of these samples.
    pub(super) fn new(study: &Study, samples: &[Sample]) -> Self {
        let failures =
            || samples.iter().filter_map(|sample| sample.outcome.as_ref().err().map(|why| (sample.number, why)));
        let mut figures = Vec::new();
        for machine in &study.machines {
            for (i, name) in study.figures().enumerate() {
                let pair = |sample: &Sample| {
                    let figure = sample.outcome.as_ref().ok()?.get(i).copied().flatten()?;
                    let point = study.point(sample.number)?;
                    (point.machine == *machine).then_some((point.values, figure))
                };
                let pairs: Vec<_> = samples.iter().filter_map(pair).collect();
                figures.extend(column(machine.key(), name, &study.keys, &pairs));
            }
        }
        Self {
            samples: samples.len(),
            failed: failures().count(),
            first_failure: failures().next().map(|(number, why)| format!("sample {number}: {why}")),
            figures,
        }
    }
}

/// A figure that some samples have, beside the values that it came from.
fn column(machine: &'static str, name: &'static str, keys: &[String], pairs: &[(Vec<f64>, f64)]) -> Option<Column> {
    let figures: Vec<f64> = pairs.iter().map(|(_, figure)| *figure).collect();
    let mut sorted = figures.clone();
    sorted.sort_by(f64::total_cmp);
    let (least, greatest) = (*sorted.first()?, *sorted.last()?);
    let median = (sorted.get((sorted.len() - 1) / 2)? + sorted.get(sorted.len() / 2)?) / 2.0;
    let of_figures = ranks(&figures);
    let correlation = |(i, key): (usize, &String)| {
        let values: Vec<f64> = pairs.iter().filter_map(|(values, _)| values.get(i).copied()).collect();
        Some((key.clone(), correlation(&ranks(&values), &of_figures)?))
    };
    let rank_correlation = keys.iter().enumerate().filter_map(correlation).collect();
    Some(Column { machine, name, least, median, greatest, rank_correlation })
}

/// The place of each value among all, from 0; equal ones share the mean of their places.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<(f64, usize)> = values.iter().copied().zip(0..).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut ranks = vec![0.0; values.len()];
    let mut begin = 0;
    for equal in order.chunk_by(|a, b| a.0 == b.0) {
        let mean = begin as f64 + (equal.len() - 1) as f64 / 2.0;
        for (_, index) in equal {
            if let Some(rank) = ranks.get_mut(*index) {
                *rank = mean;
            }
        }
        begin += equal.len();
    }
    ranks
}

/// Pearson's correlation; none if one of them does not vary.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(x, y)| f(x - mean_a, y - mean_b)).sum::<f64>();
    let square = product(&|x, _| x * x) * product(&|_, y| y * y);
    (square > 0.0).then(|| product(&|x, y| x * y) / square.sqrt())
}

impl std::fmt::Display for Summary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{} samples, {} without figures", self.samples, self.failed)?;
        if let Some(why) = &self.first_failure {
            writeln!(f, "  {why}")?;
        }
        let mut machine = "";
        for Column { machine: of, name, least, median, greatest, rank_correlation } in &self.figures {
            if machine != *of {
                machine = *of;
                writeln!(
                    f,
                    "{machine:<32}{:>12}{:>12}{:>12}  follows (rank correlation)",
                    "least", "median", "greatest"
                )?;
            }
            let [least, median, greatest] = [*least, *median, *greatest].map(significant);
            write!(f, "  {name:<30}{least:>12}{median:>12}{greatest:>12} ")?;
            let mut follows: Vec<_> = rank_correlation.iter().filter(|(_, rho)| rho.abs() >= TOLD).collect();
            follows.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            for (key, rho) in follows {
                write!(f, " {key} {rho:+.2}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Correlations that are nearer to 0 are not told to people.
const TOLD: f64 = 0.3;

/// Decimals that people are shown at most.
const DECIMALS: i32 = 9;

/// Some five digits, as people read them; what has none within the decimals is 0.
fn significant(value: f64) -> String {
    if value.abs() < 0.5 * 0.1_f64.powi(DECIMALS) {
        return "0".to_owned();
    }
    let digits = 4 - value.abs().log10().floor() as i32;
    format!("{value:.*}", usize::try_from(digits.clamp(0, DECIMALS)).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_are_shown_five_digits_and_no_rounding_errors() {
        let shown = [287.5634, -0.000_123_456, 54_438.7, 1_234_567.8, -1e-15, 0.0].map(significant);
        assert_eq!(shown, ["287.56", "-0.00012346", "54439", "1234568", "0", "0"]);
    }

    #[test]
    fn equal_values_share_their_rank() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [2.5, 0.0, 2.5, 1.0]);
    }

    #[test]
    fn what_only_rises_or_falls_correlates_wholly() {
        let pairs: Vec<_> = (0..9).map(f64::from).map(|v| (vec![v, -v, 4.0], v.exp())).collect();
        let told = column("corehbot", "f", &["up", "down", "still"].map(str::to_owned), &pairs).unwrap();
        assert!(
            (told.rank_correlation["up"] - 1.0).abs() < 1e-12 && (told.rank_correlation["down"] + 1.0).abs() < 1e-12
        );
        assert_eq!((told.rank_correlation.get("still"), told.median), (None, 4_f64.exp()));
    }
}
