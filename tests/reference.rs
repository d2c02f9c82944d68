//! The tables of docs/reference against the code: every code of the parser and every fault has a row.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::fault::{Cause, Fault};
use corehbot::gcode::{Command, Flaw, names, parse};
use std::collections::BTreeMap;

/// The firmware's treatment of a code, as the headings of gcode.md name it. M486 does something with a word alone.
fn heading_of(code: &str) -> Option<&'static str> {
    match parse(code.as_bytes()) {
        Command::Unknown(_) => None,
        Command::Silent => match parse(format!("{code} S1").as_bytes()) {
            Command::Silent | Command::Unknown(_) => Some("Accepted silently"),
            _ => Some("Carried out"),
        },
        Command::Probing | Command::ReportLevelling | Command::Conditional => Some("Refused"),
        _ => Some("Carried out"),
    }
}

/// The cells of each row of a table in `document`, with the last heading of two `#` before it.
fn rows(document: &str) -> Vec<(&str, Vec<&str>)> {
    let mut heading = "";
    let mut found = Vec::new();
    for line in document.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            heading = title;
        } else if let Some(row) = line.strip_prefix("| ") {
            found.push((heading, row.trim_end_matches('|').split('|').map(str::trim).collect()));
        }
    }
    found
}

#[test]
fn every_code_stands_once_in_the_reference_under_what_is_done_with_it() {
    let document = include_str!("../docs/reference/gcode.md");
    let mut told = BTreeMap::new();
    for (heading, cells) in rows(document) {
        if cells[0] == "code" || !["Carried out", "Accepted silently", "Refused"].contains(&heading) {
            continue;
        }
        for code in cells[0].split(", ") {
            assert_eq!(told.insert(code, (heading, cells[1])), None, "{code} has two rows");
            assert_eq!(heading_of(code), Some(heading), "{code}");
        }
    }
    let codes = ["G", "M"].into_iter().flat_map(|letter| (0..1000).map(move |number| format!("{letter}{number}")));
    for code in codes.chain(["T0".to_owned()]).chain(names().map(str::to_owned)) {
        let Some(heading) = heading_of(&code) else { continue };
        let (_, words) = told.get(code.as_str()).unwrap_or_else(|| panic!("gcode.md has no row for {code}"));
        for letter in b'A'..=b'Z' {
            let line = format!("{code} {}", letter as char);
            if matches!(parse(line.as_bytes()), Command::Malformed(Flaw::NoNumber(needed)) if needed == letter) {
                let has_it = words.split([' ', ',', '(']).any(|word| word.as_bytes() == [letter]);
                assert!(heading != "Carried out" || has_it, "{code} takes {}: {words}", letter as char);
            }
        }
    }
}

#[test]
fn every_fault_stands_in_the_reference_in_the_words_that_the_user_reads() {
    let document = include_str!("../docs/reference/errors.md");
    let rows: Vec<_> = rows(document).into_iter().filter(|(heading, _)| *heading == "Faults").collect();
    for cause in Cause::all() {
        let number = format!("E{:02}", cause as u8);
        let (_, cells) = rows.iter().find(|(_, cells)| cells[0] == number).unwrap_or_else(|| panic!("no {number}"));
        let told = Fault::plain(cause).to_string();
        let (text, cure) = told.split_once(&format!(" [{number}]: ")).unwrap();
        assert!(text.contains(cells[1].trim_matches('`')), "{number}: {text}");
        assert_eq!(cells[3], cure, "{number}");
    }
    assert_eq!(rows.len(), Cause::all().count() + 1, "a row for each fault, and the head");
}
