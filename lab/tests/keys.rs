//! Keys of answers: each has its unit in its name, or its convention in `--help`.

#[path = "../../cli/tests/common/keys.rs"]
mod known;

use super::{ask, json};
use known::untold;

/// Every key has its unit in its name, or a word about it in `--help`.
#[test]
fn every_key_has_a_unit_or_a_word_in_the_help() {
    let questions = [
        "push --force 1,0",
        "jump --speed 50,0 --model reduced",
        "misalignment --off 12=1,0",
        "compare --grid 2x2",
        "zigzag",
        "level",
        "frame",
        "yin --speed 0.05",
    ];
    for question in questions {
        let (command, _) = question.split_once(' ').unwrap_or((question, ""));
        let help = String::from_utf8(ask(&format!("{command} --help")).stdout).unwrap();
        let unknown = untold(&json(question), &help);
        assert!(unknown.is_empty(), "{command}: {unknown:?}");
    }
}
