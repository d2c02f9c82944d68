//! The check: no figure may get worse than the ones that were committed.

use super::figures::Figure;
use anyhow::{Context as _, Result, bail};
use std::collections::BTreeMap;
use std::path::Path;

/// The committed figures; `cargo xtask bench --json` writes them again.
pub const BASELINE: &str = "xtask/src/bench/baseline.json";

/// The compiler of the measured code; another one generates other code.
pub const COMPILER: &str = "rustc 1.95.";

/// A change for the worse by this part is noise, or has a good reason.
const TOLERANCE: f64 = 0.03;

/// Figures by name.
type Values = BTreeMap<String, f64>;

/// Writes the figures.
pub fn write(figures: &[Figure], path: &Path) -> Result<()> {
    let rounded = |value: f64| if value < 10.0 { (value * 1e4).round() / 1e4 } else { (value * 10.0).round() / 10.0 };
    let values: Values = figures.iter().map(|figure| (figure.name.to_owned(), rounded(figure.value))).collect();
    let text = serde_json::to_string_pretty(&values)? + "\n";
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// Fails if a figure is worse than the one that was committed, or has reached its goal no more.
pub fn compare(figures: &[Figure], baseline: &Path) -> Result<()> {
    let text = std::fs::read_to_string(baseline).with_context(|| format!("cannot open {}", baseline.display()))?;
    let values = serde_json::from_str(&text).with_context(|| baseline.display().to_string())?;
    let complaints = complaints(figures, &values);
    if complaints.is_empty() { Ok(()) } else { bail!("{}", complaints.join("; ")) }
}

fn complaints(figures: &[Figure], committed: &Values) -> Vec<String> {
    let mut complaints = Vec::new();
    for figure in figures.iter().filter(|figure| figure.is_steady) {
        let Figure { name, value, .. } = figure;
        let Some(before) = committed.get(*name) else {
            complaints.push(format!("{name} is not in {BASELINE}"));
            continue;
        };
        let change = (value - before) / before * if figure.is_rate { -1.0 } else { 1.0 };
        if change > TOLERANCE {
            complaints.push(format!("{name} is {:.1} % worse: {value:.1} instead of {before:.1}", 100.0 * change));
        }
        if let Some(goal) = figure.goal
            && figure.reaches(*before, goal)
            && !figure.reaches(*value, goal)
        {
            complaints.push(format!("{name} had reached its goal of {goal:.1}, and is {value:.1}"));
        }
    }
    let is_gone = |name: &&String| figures.iter().all(|figure| figure.name != *name);
    complaints.extend(committed.keys().filter(is_gone).map(|name| format!("{name} is not measured any more")));
    complaints
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(name: &'static str, value: f64, is_rate: bool) -> Figure {
        Figure { name, value, is_rate, is_steady: true, goal: None, peers: "" }
    }

    #[test]
    fn only_a_change_for_the_worse_is_one() {
        let committed: Values = [("cost".to_owned(), 100.0), ("rate".to_owned(), 100.0)].into();
        let check = |cost, rate| complaints(&[figure("cost", cost, false), figure("rate", rate, true)], &committed);
        assert_eq!(check(102.9, 97.1), Vec::<String>::new());
        assert_eq!(check(50.0, 200.0), Vec::<String>::new());
        assert_eq!(check(103.1, 100.0).len(), 1);
        assert_eq!(check(100.0, 96.9).len(), 1);
    }

    #[test]
    fn a_goal_that_was_reached_stays_reached() {
        let committed: Values = [("rate".to_owned(), 101.0)].into();
        let check = |value, goal| complaints(&[Figure { goal: Some(goal), ..figure("rate", value, true) }], &committed);
        assert_eq!(check(100.0, 100.0), Vec::<String>::new());
        assert_eq!(check(99.9, 100.0).len(), 1);
        assert_eq!(check(99.9, 102.0), Vec::<String>::new(), "it never was");
    }

    #[test]
    fn figures_do_not_come_and_go_unnoticed() {
        let committed: Values = [("old".to_owned(), 1.0)].into();
        assert_eq!(complaints(&[figure("new", 1.0, false)], &committed).len(), 2);
    }
}
