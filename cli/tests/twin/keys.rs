//! Keys of answers: each has its unit in its name, or its convention in `--help`.

#[path = "../common/keys.rs"]
mod known;

use super::{json, twin};
use known::untold;

/// Every key has its unit in its name, or a word about it in `--help`.
#[test]
fn every_key_has_a_unit_or_a_word_in_the_help() {
    let questions = [
        "geometry",
        "stiffness --routing corexyz-three",
        "modes",
        "slip --motor 1",
        "tension",
        "shaper --kind zv --frequency 60 --ring 60",
        "resonance --grid 2x2",
        "limits",
        "ripple --speeds 40-60 --step 10 --angle-step 45",
        "fit ../examples/twin/measured.toml",
    ];
    for question in questions {
        let (command, _) = question.split_once(' ').unwrap_or((question, ""));
        let help = String::from_utf8(twin(&format!("{command} --help")).stdout).unwrap();
        let unknown = untold(&json(question), &help);
        assert!(unknown.is_empty(), "{command}: {unknown:?}");
    }
}
