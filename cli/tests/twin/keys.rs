//! Keys of answers: each has its unit in its name, or its convention in `--help`.

use super::{json, twin};

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

/// Every key has its unit in its name, or a word about it in `--help`.
#[test]
fn every_key_has_a_unit_or_a_word_in_the_help() {
    fn keys(value: &serde_json::Value, key: &str, all: &mut std::collections::BTreeSet<String>) {
        match value {
            // The machine's numbers have the keys of [twin].
            serde_json::Value::Object(entries) => {
                entries.iter().filter(|(key, _)| *key != "params").for_each(|(key, value)| keys(value, key, all));
            }
            serde_json::Value::Array(items) => items.iter().for_each(|item| keys(item, key, all)),
            _ => _ = all.insert(key.to_owned()),
        }
    }
    let questions = [
        "geometry",
        "stiffness --routing corexyz-three",
        "modes",
        "push --force 1,0",
        "slip --motor 1",
        "tension",
        "jump --speed 50,0 --model reduced",
        "shaper --kind zv --frequency 60 --ring 60",
        "misalignment --off 12=1,0",
        "resonance --grid 2x2",
        "limits",
        "compare --grid 2x2",
        "zigzag",
        "level",
        "frame",
        "yin --speed 0.05",
        "ripple --speeds 40-60 --step 10 --angle-step 45",
        "fit ../examples/twin/measured.toml",
    ];
    for question in questions {
        let (command, _) = question.split_once(' ').unwrap_or((question, ""));
        let help = String::from_utf8(twin(&format!("{command} --help")).stdout).unwrap();
        let mut all = std::collections::BTreeSet::new();
        keys(&json(question), "", &mut all);
        // Names of spans and belts are keys of tensions.
        let is_known = |key: &str| {
            let spans = ["L", "R", "lo", "up", "A", "B", "C", "D"];
            UNITS.iter().any(|unit| key.ends_with(unit))
                || PLAIN.contains(&key)
                || spans.contains(&key.split(' ').next().unwrap_or_default())
                || help.contains(key)
        };
        let unknown: Vec<&String> = all.iter().filter(|key| !is_known(key)).collect();
        assert!(unknown.is_empty(), "{command}: {unknown:?}");
    }
}
