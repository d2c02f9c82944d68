//! The reference of settings, docs/reference/settings.md, from their rows.

use crate::keys::{ROUTING, ROUTING_MEANING, TWIN, about, legal_words, named, names_of, routings};
use crate::value::{float_toml, toml};
use crate::written::values;
use corehbot::motors::prototype;
use corehbot::settings::Settings;
use corehbot::settings::rows::{Row, Text, Value, ValueKind};
use corehbot::settings::table::described;
use corehbot_twin::description::Routing;
use corehbot_twin::params::{ROWS, Row as TwinRow};
use std::fmt::Write as _;

/// The document.
#[must_use]
pub fn reference() -> String {
    let mut text = String::from(
        "# Settings\n\n\
         Every key of a machine file. `cargo test -p corehbot-machine-file` holds this page to the settings; with `BLESS=1` it\n\
         writes the page. [Machine files](machines.md) explains boards, connectors and checks. The id is the number of a setting in\n\
         stored records: it never changes.\n",
    );
    let mut tables: Vec<&str> = Vec::new();
    for (row, _) in described() {
        if !tables.contains(&table(row)) {
            tables.push(table(row));
        }
    }
    for name in tables {
        let title = if name.is_empty() { "At the top" } else { name };
        let _ = write!(text, "\n## {title}\n\n{}\n\n", about(name).unwrap_or_default());
        text += "| key | meaning | unit | range | default | id |\n|---|---|---|---|---|---|\n";
        for (row, what) in described().filter(|(row, _)| table(row) == name) {
            let meaning = what.meaning.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
            let (keys, range, default) = (keys(row), range(row, what), defaults(row, what));
            let _ = writeln!(text, "| {keys} | {meaning} | {} | {range} | {default} | {} |", what.unit, row.id);
        }
    }
    twin(&mut text);
    text
}

/// The table of the belt's twin.
fn twin(text: &mut String) {
    let _ = write!(text, "\n## {TWIN}\n\n{}\n\n", about(TWIN).unwrap_or_default());
    text.push_str("[H] is the paper that introduced the CoreH-bot (Machines, 2022).\n\n");
    text.push_str("| key | meaning | unit | range | default | source |\n|---|---|---|---|---|---|\n");
    let routings = routings().join(", ");
    let _ = writeln!(text, "| `{ROUTING}` | {ROUTING_MEANING} |  | {routings} | {} |  |", Routing::AUTO);
    for row in &ROWS {
        let (TwinRow { key, meaning, source, .. }, unit) = (row, row.unit());
        let list = if row.is_list() { ", or a list" } else { "" };
        let default = row.default.map_or_else(|| "none".to_owned(), |value| float_toml(value).to_string());
        let _ =
            writeln!(text, "| `{TWIN}.{key}` | {meaning}. | {unit} | {}{list} | {default} | {source} |", row.legal());
    }
}

/// The outermost table of a row.
fn table(row: &Row) -> &'static str {
    row.tables.first().and_then(|table| table.split('.').next()).unwrap_or_default()
}

/// The key for all parts: `axes.x`, `y`, `z`, `e` `.length`.
fn keys(row: &Row) -> String {
    let tables = row.tables.iter().filter_map(|table| named(table, &prototype::NAMES));
    let mut tables: Vec<String> = tables.collect();
    tables.dedup();
    let tables: Vec<&str> = tables.iter().map(String::as_str).collect();
    let leaf = if row.leaf.is_empty() || tables == [""] { row.leaf.to_owned() } else { format!(".{}", row.leaf) };
    match tables.as_slice() {
        [] | [""] => format!("`{leaf}`"),
        [only] => format!("`{only}{leaf}`"),
        [first, others @ ..] => {
            let others = others.iter().map(|table| format!("`{}`", table.rsplit('.').next().unwrap_or(table)));
            let others = others.collect::<Vec<_>>().join(", ");
            let leaf = if leaf.is_empty() { leaf } else { format!(": `{leaf}`") };
            format!("`{first}`, {others}{leaf}")
        }
    }
}

/// The legal values.
fn range(row: &Row, text: &Text) -> String {
    let of = |part| match text.kind {
        ValueKind::Fixed(_) | ValueKind::Whole | ValueKind::OfMotor | ValueKind::Place => {
            legal_words(row.legal(part), text.kind)
        }
        ValueKind::Auto(_) => format!("\"auto\" or {}", legal_words(row.legal(part), text.kind)),
        ValueKind::Switch => "true, false".to_owned(),
        ValueKind::Choice(name) => names_of(name).join(", "),
        ValueKind::Name => "24 characters".to_owned(),
        ValueKind::MotorName => "4 characters".to_owned(),
        ValueKind::Plug | ValueKind::Connector => "8 characters".to_owned(),
        ValueKind::Thermistor => "see [heat](../explanation/heat.md)".to_owned(),
        ValueKind::MotorRow => "3 or 4 numbers".to_owned(),
    };
    listed((0..row.tables.len()).map(of))
}

/// The prototype's values.
fn defaults(row: &Row, text: &Text) -> String {
    let values = values(&Settings::prototype());
    let is_of_prototype = |part: usize, value: &Value| match (text.kind, value) {
        (ValueKind::MotorName, Value::Text(name)) => !name.is_empty(),
        _ => row.tables.get(part).is_some_and(|table| named(table, &prototype::NAMES).is_some()),
    };
    let values = values.range((row.id, 0)..=(row.id, usize::MAX));
    listed(values.filter(|((_, part), value)| is_of_prototype(*part, value)).map(|(_, value)| {
        let is_unknown = row.tables.contains(&"belt.phases");
        toml(value, text.kind).filter(|_| !is_unknown).map_or_else(|| "none".to_owned(), |value| value.to_string())
    }))
}

/// Different values one behind the other; one if all are the same.
fn listed(values: impl Iterator<Item = String>) -> String {
    let values: Vec<String> = values.collect();
    match values.as_slice() {
        [first, others @ ..] if others.iter().all(|other| other == first) => first.clone(),
        all => all.join("; "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_is_that_of_todays_settings() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reference/settings.md");
        let today = reference();
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(path, &today).unwrap();
        }
        assert!(std::fs::read_to_string(path).is_ok_and(|text| text == today), "BLESS=1 writes it");
    }
}
