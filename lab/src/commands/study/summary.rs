//! Summary: a study in a few lines: the range of each figure, and the varied numbers that it follows.

use super::plan::{Sample, Study};
use corehbot_twin::math::{log10, powi};
use serde::Serialize;
use std::collections::BTreeMap;

/// A study in short.
#[derive(Serialize)]
pub(super) struct Summary {
    /// Its samples.
    samples: usize,
    /// Samples that have no figures.
    failed: usize,
    /// Why the first of these has no figures.
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
    /// How many samples have it.
    #[serde(skip)]
    count: usize,
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
            let row = |sample: &Sample| {
                let figures = sample.outcome.clone().ok()?;
                let point = study.point(sample.number).filter(|point| point.machine == *machine)?;
                Some((point.values, figures))
            };
            let rows: Vec<Row> = samples.iter().filter_map(row).collect();
            let mut numbers = Ranked::default();
            for (i, name) in study.figures().enumerate() {
                figures.extend(column((machine.key(), name), i, &study.keys, &rows, &mut numbers));
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

/// The values of a sample's numbers, and its figures.
type Row = (Vec<f64>, Vec<Option<f64>>);

/// The ranks of the numbers among some rows; most figures have the same rows.
#[derive(Default)]
struct Ranked {
    rows: Vec<usize>,
    /// Of each number, unless it is constant.
    ranks: Vec<Option<Vec<f64>>>,
}

impl Ranked {
    /// Ranks them among these rows, unless that was done.
    fn among(&mut self, indices: Vec<usize>, rows: &[Row], numbers: usize) {
        if self.rows == indices && self.ranks.len() == numbers {
            return;
        }
        let values = |number: usize| -> Vec<f64> {
            let value = |index: &usize| rows.get(*index)?.0.get(number).copied();
            indices.iter().filter_map(value).collect()
        };
        let ranks = |number: usize| {
            let values = values(number);
            let (least, greatest) = ends(&values)?;
            (!is_constant(least, greatest)).then(|| ranks(&values))
        };
        self.ranks = (0..numbers).map(ranks).collect();
        self.rows = indices;
    }
}

/// A figure that some rows have, next to the numbers that it came from.
fn column(
    (machine, name): (&'static str, &'static str),
    figure: usize,
    keys: &[String],
    rows: &[Row],
    numbers: &mut Ranked,
) -> Option<Column> {
    let of_row = |(index, (_, figures)): (usize, &Row)| Some((index, figures.get(figure).copied().flatten()?));
    let (indices, figures): (Vec<usize>, Vec<f64>) = rows.iter().enumerate().filter_map(of_row).unzip();
    let mut sorted = figures.clone();
    sorted.sort_by(f64::total_cmp);
    let (least, greatest) = (*sorted.first()?, *sorted.last()?);
    let median = (sorted.get((sorted.len() - 1) / 2)? + sorted.get(sorted.len() / 2)?) / 2.0;
    let mut rank_correlation = BTreeMap::new();
    if !is_constant(least, greatest) && [least, greatest].iter().any(|end| !is_shown_as_zero(*end)) {
        let of_figures = ranks(&figures);
        numbers.among(indices, rows, keys.len());
        let of_key = |(key, ranks): (&String, &Option<Vec<f64>>)| {
            Some((key.clone(), correlation(ranks.as_ref()?, &of_figures)?))
        };
        rank_correlation = keys.iter().zip(&numbers.ranks).filter_map(of_key).collect();
    }
    Some(Column { machine, name, least, median, greatest, count: figures.len(), rank_correlation })
}

/// The least and the greatest of values.
fn ends(values: &[f64]) -> Option<(f64, f64)> {
    let least = values.iter().copied().reduce(f64::min)?;
    Some((least, values.iter().copied().reduce(f64::max)?))
}

/// The part of itself by which a constant may vary: rounding, millions of times over (assumed).
const CONSTANT: f64 = 1e-9;

/// Whether a figure with this span varies by rounding alone.
fn is_constant(least: f64, greatest: f64) -> bool {
    greatest - least <= CONSTANT * least.abs().max(greatest.abs())
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

/// Pearson's correlation; `None` if one of them does not vary.
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
        for Column { machine: of, name, least, median, greatest, count, rank_correlation } in &self.figures {
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
            let mut follows: Vec<_> =
                rank_correlation.iter().filter(|(_, rho)| rho.abs() > told_above(*count)).collect();
            follows.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            for (key, rho) in follows {
                write!(f, " {key} {rho:+.2}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Correlations up to this are not reported.
const TOLD: f64 = 0.3;

/// Standard deviations that chance is given: if they are normal, one in 370 is above them.
const CHANCE: f64 = 3.0;

/// The threshold for reporting a correlation of `count` samples. Over all orders of n ranks its standard deviation is 1
/// / sqrt(n - 1), so ten samples and fewer report none.
fn told_above(count: usize) -> f64 {
    TOLD.max(CHANCE / (count.saturating_sub(1) as f64).sqrt())
}

/// Decimals that people are shown at most.
const DECIMALS: i32 = 9;

/// Some five digits, as people read them; 0 if the decimals hold no digit.
fn significant(value: f64) -> String {
    if is_shown_as_zero(value) {
        return "0".to_owned();
    }
    let digits = 4 - log10(value.abs()).floor() as i32;
    format!("{value:.*}", usize::try_from(digits.clamp(0, DECIMALS)).unwrap_or(0))
}

fn is_shown_as_zero(value: f64) -> bool {
    value.abs() < 0.5 * powi(0.1, DECIMALS)
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
        let rows: Vec<_> = (0..12).map(f64::from).map(|v| (vec![v, -v, 4.0], vec![Some(v.exp())])).collect();
        let told = of(&["up", "down", "still"], 0, &rows);
        assert!(
            (told.rank_correlation["up"] - 1.0).abs() < 1e-12 && (told.rank_correlation["down"] + 1.0).abs() < 1e-12
        );
        assert_eq!(told.rank_correlation.get("still"), None);
        assert!((told.median - (5_f64.exp() + 6_f64.exp()) / 2.0).abs() < 1e-12, "{}", told.median);
    }

    fn of(keys: &[&str], figure: usize, rows: &[Row]) -> Column {
        let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
        column(("corehbot", "f"), figure, &keys, rows, &mut Ranked::default()).unwrap()
    }

    #[test]
    fn rounding_follows_nothing() {
        // Some units in the last place of a constant, and of a value that should be 0, both rising.
        let row = |v: f64| (vec![v], vec![Some(287.5 * (1.0 + v * f64::EPSILON)), Some(v * 1e-15), Some(v)]);
        let rows: Vec<_> = (0..50).map(f64::from).map(row).collect();
        assert!(of(&["k"], 0, &rows).rank_correlation.is_empty());
        assert!(of(&["k"], 1, &rows).rank_correlation.is_empty());
        assert!((of(&["k"], 2, &rows).rank_correlation["k"] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn ranks_are_those_among_the_samples_that_have_the_figure() {
        // The first half rises, the other falls; a figure is there for the first half, another one for all.
        let row = |i: i32| {
            let v = f64::from(if i < 20 { i } else { 60 - i });
            (vec![f64::from(i)], vec![Some(v), Some(v).filter(|_| i < 20), Some(-v).filter(|_| i >= 20)])
        };
        let rows: Vec<_> = (0..40).map(row).collect();
        let mut numbers = Ranked::default();
        let keys = ["k".to_owned()];
        let mut rho = |figure| {
            let column = column(("corehbot", "f"), figure, &keys, &rows, &mut numbers).unwrap();
            (column.count, column.rank_correlation["k"])
        };
        let expected = [rho(1), rho(2), rho(1)];
        assert!(expected.iter().all(|(count, rho)| *count == 20 && (rho - 1.0).abs() < 1e-12), "{expected:?}");
        // Ranks 0 to 19, then 39 down to 20: 1 - 6 sum(d^2) / (n (n^2 - 1)), d = 19, 17, ..., -19 in the other half.
        let squares: i32 = (0..20).map(|i| (19 - 2 * i) * (19 - 2 * i)).sum();
        let spearman = 1.0 - 6.0 * f64::from(squares) / (40.0 * (40.0 * 40.0 - 1.0));
        assert!((rho(0).1 - spearman).abs() < 1e-12, "{} {spearman}", rho(0).1);
    }

    #[test]
    fn over_all_orders_the_variance_is_one_in_n_minus_1() {
        // Of all tuples the permutations count.
        let n = 5;
        let tuples = (0..n * n * n * n * n).map(|i: i32| [0, 1, 2, 3, 4].map(|k| i / n.pow(k) % n));
        let orders = tuples.filter(|order| (0..n).all(|rank| order.contains(&rank)));
        let rho = |order: [i32; 5]| correlation(&[0.0, 1.0, 2.0, 3.0, 4.0], &order.map(f64::from)).unwrap();
        let squares: Vec<f64> = orders.map(|order| rho(order) * rho(order)).collect();
        assert_eq!(squares.len(), 120);
        assert!((squares.iter().sum::<f64>() / 120.0 - 0.25).abs() < 1e-12);
    }

    #[test]
    fn what_chance_makes_is_not_told() {
        let told = |count: usize| told_above(count);
        assert_eq!([told(2), told(10), told(37), told(101), told(10_000)], [3.0, 1.0, 0.5, 0.3, 0.3]);
        let column = |count, rho| Column {
            machine: "corehbot",
            name: "f",
            least: 1.0,
            median: 2.0,
            greatest: 3.0,
            count,
            rank_correlation: BTreeMap::from([("k".to_owned(), rho)]),
        };
        let summary = |count, rho| {
            Summary { samples: count, failed: 0, first_failure: None, figures: vec![column(count, rho)] }.to_string()
        };
        assert!(!summary(37, 0.49).contains(" k ") && summary(37, -0.51).contains(" k -0.51"));
        assert!(!summary(1000, 0.29).contains(" k ") && !summary(3, 1.0).contains(" k "));
    }
}
