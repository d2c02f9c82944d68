//! Every command that is known is answered as the [`table`](super::table) says, and none is left out of it.

use super::asker::{answers, answers_of};
use super::plain_lines::plain_lines;
use super::table::{ELSEWHERE, ROWS, Row};
use corehbot::gcode::{Command, names};
use corehbot::machine::{examples, parse};
use corehbot::protocol::BUSY_PAUSED;
use corehbot_machine_file as machine_file;
use std::collections::BTreeSet;

/// The rows of the table, and the examples of commands that have their own.
fn rows() -> impl Iterator<Item = Row> {
    ROWS.iter().copied().chain(examples())
}

fn fits(heard: &str, pattern: &str) -> bool {
    match pattern.strip_suffix('*') {
        Some(begin) => heard.starts_with(begin),
        None => heard == pattern,
    }
}

#[test]
fn every_command_is_answered_as_the_table_says() {
    for (line, expected) in rows() {
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

/// Every code and name that stands for a command has a row, is in `ELSEWHERE`, or sets plain settings.
#[test]
fn every_known_code_and_name_has_a_row() {
    let codes = ["G", "M"].into_iter().flat_map(|letter| (0..10_000).map(move |number| format!("{letter}{number}")));
    let codes = codes.filter(|code| !matches!(parse(code.as_bytes()), Command::Unknown(_)));
    let known: Vec<_> = codes.chain(names().map(str::to_owned)).collect();
    let plain: Vec<_> = plain_lines().into_values().collect();
    let lines = || rows().map(|(line, _)| line).chain(plain.iter().map(String::as_str));
    let has_row = |code: &String| lines().any(|line| begins(line, code));
    let without: BTreeSet<_> = known.into_iter().filter(|code| !has_row(code)).collect();
    assert_eq!(without, ELSEWHERE.map(|(code, _)| code.to_owned()).into(), "a row, or a place in ELSEWHERE");
}
