//! Keys of answers: each has its unit in its name, or its convention in `--help`.

use serde_json::Value;
use std::collections::BTreeSet;

/// Endings of keys that tell a unit.
const UNITS: [&str; 17] = [
    "_mm", "_um", "_N", "_Nm", "_mNm", "_Hz", "_s", "_ms", "_deg", "_mrad", "_s2", "_mm2", "_per_mm", "_per_rad",
    "_percent", "_steps", "_w2",
];

/// Keys without a unit that need no word: names, texts and counts.
const PLAIN: [&str; 21] = [
    "amount",
    "between",
    "count",
    "example",
    "found",
    "goes_slack",
    "heading",
    "holds",
    "is_detent_assumed",
    "kind",
    "line_by_tool",
    "name",
    "parameter",
    "pulley",
    "routing",
    "span",
    "text",
    "toothed_of",
    "toothed_pulleys",
    "type",
    "unit",
];

fn keys(value: &Value, key: &str, all: &mut BTreeSet<String>) {
    match value {
        // The machine's numbers have the keys of [twin].
        Value::Object(entries) => {
            entries.iter().filter(|(key, _)| *key != "params").for_each(|(key, value)| keys(value, key, all));
        }
        Value::Array(items) => items.iter().for_each(|item| keys(item, key, all)),
        _ => _ = all.insert(key.to_owned()),
    }
}

/// The keys of an answer that have neither a unit in their name nor a word in the help of their command.
pub fn untold(answer: &Value, help: &str) -> Vec<String> {
    let mut all = BTreeSet::new();
    keys(answer, "", &mut all);
    // Names of spans and belts are keys of tensions.
    let is_known = |key: &str| {
        let spans = ["L", "R", "lo", "up", "A", "B", "C", "D"];
        UNITS.iter().any(|unit| key.ends_with(unit))
            || PLAIN.contains(&key)
            || spans.contains(&key.split(' ').next().unwrap_or_default())
            || help.contains(key)
    };
    all.into_iter().filter(|key| !is_known(key)).collect()
}
