//! Words: the table for people.

use super::error::all_words;
use super::table::{Family, How, ROWS, Row};

/// The help of an option that takes accidents, without the words.
#[must_use]
pub fn help() -> String {
    let belts: Vec<&str> = Row::of(Family::Belts).map(|row| row.word).collect();
    format!(
        "Breaks something: what, where, how much of it, when, and for how long, such as `open:hotend@60s`, \
         `stuck-on:bed@10m`, `early:probe@1m` or `rub:m1:15N@20s+5s`. May be repeated. TIME is s, m or h after power-up; \
         of belts ({}) it is motion time, and they need --plant belt. docs/reference/accidents.md has the table",
        belts.join(", ")
    )
}

/// Every word, once, with its meaning: in the order of the table.
#[must_use]
pub fn words() -> Vec<(&'static str, String)> {
    let meaning = |word: &&'static str| {
        let rows: Vec<String> = ROWS.iter().filter(|row| row.word == *word).map(meaning).collect();
        (*word, rows.join("; or of "))
    };
    all_words().iter().map(meaning).collect()
}

fn meaning(row: &Row) -> String {
    let how = row.how.map_or_else(String::new, |how| format!(" (HOW: {})", how.says));
    format!("{}: {}{how}", row.places.says(), row.says)
}

/// The tables of docs/reference/accidents.md. Columns that are empty in a family are left out.
#[must_use]
pub fn markdown() -> String {
    let mut text = String::new();
    for family in Family::ALL {
        let needs = if family.needs_belts() { ", with `--plant belt`" } else { "" };
        text += &format!("\n### {}\n\nTIME is {}{needs}.\n\n", capital(family.name()), family.clock());
        let has_how = Row::of(family).any(|row| row.how.is_some());
        let columns = |how: &str, ends: &str| if has_how { format!(" {how} | {ends} |") } else { String::new() };
        text += &format!("| WHAT | WHERE |{} what happens |\n", columns("HOW", "ends"));
        text += &format!("|---|---|{}---|\n", if has_how { "---|---|" } else { "" });
        for Row { word, places, how, can_end, says, .. } in Row::of(family) {
            let how = how.as_ref().map_or_else(String::new, told);
            let columns = columns(&how, if *can_end { "yes" } else { "no" });
            text += &format!("| `{word}` | {} |{columns} {says} |\n", places.says());
        }
    }
    text
}

/// What HOW is, and what it is if it is left out.
fn told(how: &How) -> String {
    let unit = if how.unit.is_empty() { String::new() } else { format!(" {}", how.unit) };
    let usual = how.usual.map_or_else(|| "as the plant computes it".to_owned(), |usual| format!("{usual}{unit}"));
    format!("{}. Without it: {usual}", how.says)
}

fn capital(word: &str) -> String {
    let mut chars = word.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}
