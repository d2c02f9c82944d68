//! Every command that is known is answered as its examples say (`corehbot::machine::examples`), and none lacks one.

use super::asker::{answers, answers_of};
use super::plain_lines::plain_lines;
use corehbot::gcode::Command;
use corehbot::machine::{examples, names, parse};
use corehbot::protocol::BUSY_PAUSED;
use corehbot_machine_file as machine_file;
use std::collections::BTreeSet;

/// Codes that one line and its answer do not show, and where they are tested.
const ELSEWHERE: [(&str, &str); 15] = [
    ("M112", "../emergencies.rs"),
    ("M115", "answers.rs"),
    ("M122", "../console/reports.rs"),
    ("M503", "answers.rs"),
    ("M504", "../console/storage.rs"),
    ("M622", "effects.rs"),
    ("M623", "effects.rs"),
    ("MACHINE_GET", "../console/machine_record.rs"),
    ("if", "effects.rs"),
    ("elif", "effects.rs"),
    ("else", "effects.rs"),
    ("while", "effects.rs"),
    ("break", "effects.rs"),
    ("continue", "effects.rs"),
    ("abort", "effects.rs"),
];

fn fits(heard: &str, pattern: &str) -> bool {
    match pattern.strip_suffix('*') {
        Some(begin) => heard.starts_with(begin),
        None => heard == pattern,
    }
}

#[test]
fn every_command_is_answered_as_its_examples_say() {
    for (line, expected) in examples() {
        let heard = answers(&[line]);
        let (oks, said): (Vec<_>, Vec<_>) = heard.iter().partition(|heard| heard.starts_with("ok"));
        // An answer to M108 follows that to the wait which it ended.
        let asked = 1 + usize::from(heard.iter().any(|heard| heard == BUSY_PAUSED));
        assert_eq!(oks.len(), asked, "{line}: {heard:?}");
        assert_eq!(said.len(), expected.len(), "{line}: {heard:?}");
        assert!(said.iter().zip(expected).all(|(heard, pattern)| fits(heard, pattern)), "{line}: {heard:?}");
        assert!(!heard.iter().any(|heard| heard.contains("Unknown")), "{line}: {heard:?}");
    }
}

/// Whether a line begins with that code.
fn begins(line: &str, code: &str) -> bool {
    line.split(['.', ' ']).next() == Some(code)
}

/// M113 alone has another answer, in its row.
#[test]
fn a_plain_setting_is_set_in_silence_and_reported_as_the_line_that_sets_it() {
    // No two axes share a motor, and there are heaters.
    let axes = "[mechanism]\nm1 = [1, 0, 0]\nm4 = [0, 1, 0]\nz1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n";
    let heaters = ["hotend", "bed"].map(|heater| format!("[heaters.{heater}]\nis_fitted = true\n"));
    let settings = machine_file::load(&(axes.to_owned() + &heaters.concat())).unwrap();
    for line in plain_lines().into_values().filter(|line| !begins(line, "M113")) {
        let (code, word) = line.split_once(' ').unwrap();
        let heard = answers_of(&settings, &[code, &line, code]);
        let [before, _, _, after, _] = heard.as_slice() else { panic!("{line}: {heard:?}") };
        assert!(before.starts_with(&format!("  {code} ")), "{heard:?}");
        let changed: Vec<_> =
            before.split(' ').zip(after.split(' ')).filter(|(before, after)| before != after).collect();
        let [(_, changed)] = changed[..] else { panic!("{line}: {heard:?}") };
        assert_eq!(changed[..1], word[..1], "{line}: {heard:?}");
    }
}

/// Every code and name that stands for a command has an example, is in `ELSEWHERE`, or sets plain settings.
#[test]
fn every_known_code_and_name_has_an_example() {
    let codes = ["G", "M"].into_iter().flat_map(|letter| (0..10_000).map(move |number| format!("{letter}{number}")));
    let codes = codes.filter(|code| !matches!(parse(code.as_bytes()), Command::Unknown(_)));
    let known: Vec<_> = codes.chain(names().map(str::to_owned)).collect();
    let plain: Vec<_> = plain_lines().into_values().collect();
    let lines = || examples().map(|(line, _)| line).chain(plain.iter().map(String::as_str));
    let has_one = |code: &String| lines().any(|line| begins(line, code));
    let without: BTreeSet<_> = known.into_iter().filter(|code| !has_one(code)).collect();
    assert_eq!(without, ELSEWHERE.map(|(code, _)| code.to_owned()).into(), "an example, or a place in ELSEWHERE");
}
