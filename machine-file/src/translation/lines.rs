//! The lines of the machine file that is being written: keys by tables, each with the place that it came from.

use crate::keys::TABLES;
use std::fmt::Write as _;
use toml::Value as Toml;

/// The keys of a machine file.
#[derive(Default)]
pub(crate) struct Lines(Vec<Line>);

struct Line {
    path: String,
    value: Toml,
    from: String,
}

impl Lines {
    /// The value of a key so far.
    pub fn get(&self, path: &str) -> Option<&Toml> {
        self.0.iter().find(|line| line.path == path).map(|line| &line.value)
    }

    /// The same, if it is a number.
    pub fn number(&self, path: &str) -> Option<f64> {
        let value = self.get(path)?;
        value.as_float().or_else(|| value.as_integer().map(|number| number as f64))
    }

    /// Sets a key, for a reason that stands behind it as a comment.
    pub fn set(&mut self, path: &str, value: Toml, from: &str) {
        self.0.retain(|line| line.path != path);
        // A comment of TOML has no control characters, and names of sections and files may.
        let from = from.chars().map(|letter| if letter.is_control() { '?' } else { letter }).collect();
        self.0.push(Line { path: path.to_owned(), value, from });
    }

    /// The text, the tables in their usual order.
    pub fn text(&self) -> String {
        let mut tables: Vec<&str> = Vec::new();
        for line in &self.0 {
            let table = split(&line.path).0;
            if !tables.contains(&table) {
                tables.push(table);
            }
        }
        tables.sort_by_key(|table| TABLES.iter().position(|(known, _)| known == table).unwrap_or(order(table)));
        let mut text = String::new();
        for table in tables {
            if !table.is_empty() {
                let _ = writeln!(text, "\n[{table}]");
            }
            for line in self.0.iter().filter(|line| split(&line.path).0 == table) {
                let comment = if line.from.is_empty() { "" } else { "  # " };
                let _ = writeln!(text, "{} = {}{comment}{}", split(&line.path).1, line.value, line.from);
            }
        }
        text
    }
}

/// A table without a subject of its own stands with the last one of its kind.
fn order(table: &str) -> usize {
    let kind = table.split('.').next().unwrap_or(table);
    TABLES.iter().rposition(|(known, _)| known.split('.').next() == Some(kind)).unwrap_or(TABLES.len())
}

fn split(path: &str) -> (&str, &str) {
    path.rsplit_once('.').unwrap_or(("", path))
}
