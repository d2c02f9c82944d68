//! The tables of docs/reference against the code. Those of codes are made from the rows of the table of commands
//! (`BLESS=1` writes them); every fault has a row.

use corehbot::fault::{Cause, Fault};
use corehbot::gcode::{Command, Flaw, Treatment};
use corehbot::machine::{described, names, parse};
use corehbot::settings::plain;
use corehbot::settings::table::described as settings;
use std::collections::BTreeMap;

/// The heading of a table in gcode.md, and the heads of its columns.
const fn heading_of(treatment: Treatment) -> (&'static str, &'static [&'static str]) {
    match treatment {
        Treatment::CarriedOut => ("Carried out", &["code", "words", "does"]),
        Treatment::Silent => ("Accepted silently", &["code", "why nothing is done"]),
        Treatment::Refused => ("Refused", &["code", "answer"]),
    }
}

/// The firmware's treatment of a code, as the parser has it. M486 does something with a word alone.
fn treatment_of(code: &str) -> Option<Treatment> {
    match parse(code.as_bytes()) {
        Command::Unknown(_) => None,
        Command::Silent => match parse(format!("{code} S1").as_bytes()) {
            Command::Silent | Command::Unknown(_) => Some(Treatment::Silent),
            _ => Some(Treatment::CarriedOut),
        },
        Command::Condition => Some(Treatment::Refused),
        _ => Some(Treatment::CarriedOut),
    }
}

/// The row of an M-code that sets plain settings and has no texts, from their letters and meanings.
fn plain_row(number: u16) -> String {
    let of_code = || settings().filter(|(row, _)| row.lines.iter().any(|line| line.number == number));
    let mut words = Vec::new();
    for letter in plain::letters(number).flat_map(|letters| letters.split('/')) {
        if !words.contains(&letter) {
            words.push(letter);
        }
    }
    let meanings = of_code().map(|(row, text)| {
        // The last part says the line.
        let meaning: Vec<_> = text.meaning.iter().rev().skip(1).rev().map(|line| line.trim()).collect();
        let meaning = meaning.join(" ");
        let (first, others) = meaning.trim_end_matches('.').split_at(1);
        let letters = row.lines.first().filter(|_| of_code().count() > 1).map(|line| line.letters.join(" ") + " ");
        format!("{}{}{others}", letters.unwrap_or_default().replace('/', ", "), first.to_lowercase())
    });
    format!("| M{number} | {} | {}; or reports |\n", words.join(" "), meanings.collect::<Vec<_>>().join("; "))
}

/// The document with its tables made anew from the rows of commands, a table below each heading of a family. Rows
/// stand in the order of their codes: G, M, T, then names.
fn with_tables(document: &str) -> String {
    let mut tables = BTreeMap::<&str, String>::new();
    let mut lines: Vec<_> = described().collect();
    lines.sort_by_key(|line| (line.names.first().copied(), line.codes.0, line.codes.1.first().copied()));
    for line in lines {
        let (_, heads) = heading_of(line.text.treatment);
        let table = tables
            .entry(line.family)
            .or_insert_with(|| format!("| {} |\n|{}\n", heads.join(" | "), "---|".repeat(heads.len())));
        let (letter, numbers) = line.codes;
        if line.text.does.is_empty() && numbers.iter().any(|number| plain::letters(*number).count() > 0) {
            numbers.iter().for_each(|number| *table += &plain_row(*number));
            continue;
        }
        let codes = numbers.iter().map(|number| format!("{letter}{number}"));
        let names: Vec<_> = codes.chain(line.names.iter().map(|name| (*name).to_owned())).collect();
        let words = line.text.words;
        let words = match heads.len() {
            2 => String::new(),
            _ if words.is_empty() => " |".to_owned(),
            _ => format!(" {words} |"),
        };
        *table += &format!("| {} |{words} {} |\n", names.join(", "), line.text.does);
    }
    let (mut made, mut heading, mut is_told) = (String::new(), "", false);
    for line in document.lines() {
        if line.starts_with('#') {
            (heading, is_told) = (line.trim_start_matches(['#', ' ']), false);
        }
        match tables.get(heading) {
            Some(_) if line.starts_with('|') && is_told => {}
            Some(table) if line.starts_with('|') => {
                made += table;
                is_told = true;
            }
            _ => made += &format!("{line}\n"),
        }
    }
    made
}

#[test]
fn the_tables_of_codes_are_those_of_the_parser() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/reference/gcode.md");
    let document = std::fs::read_to_string(path).unwrap();
    let made = with_tables(&document);
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(path, &made).unwrap();
    } else {
        assert!(document == made, "BLESS=1 cargo test -p corehbot --test core_tests reference");
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
    let document = with_tables(include_str!("../docs/reference/gcode.md"));
    let mut told = BTreeMap::new();
    for (heading, cells) in rows(&document) {
        if cells[0] == "code" || !["Carried out", "Accepted silently", "Refused"].contains(&heading) {
            continue;
        }
        for code in cells[0].split(", ") {
            assert_eq!(told.insert(code, (heading, cells[1])), None, "{code} has two rows");
            assert_eq!(treatment_of(code).map(|it| heading_of(it).0), Some(heading), "{code}");
        }
    }
    let codes = ["G", "M"].into_iter().flat_map(|letter| (0..10_000).map(move |number| format!("{letter}{number}")));
    for code in codes.chain(["T0".to_owned()]).chain(names().map(str::to_owned)) {
        let Some(treatment) = treatment_of(&code) else { continue };
        let (_, words) = told.get(code.as_str()).unwrap_or_else(|| panic!("gcode.md has no row for {code}"));
        for letter in b'A'..=b'Z' {
            let line = format!("{code} {}", letter as char);
            if matches!(parse(line.as_bytes()), Command::Malformed(Flaw::NoNumber(needed)) if needed == letter) {
                let has_it = words.split([' ', ',', '(']).any(|word| word.as_bytes() == [letter]);
                assert!(treatment != Treatment::CarriedOut || has_it, "{code} takes {}: {words}", letter as char);
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
