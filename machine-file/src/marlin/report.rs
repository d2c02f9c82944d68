//! The report: a verdict on every word, by commands in the order in which they were said first.

use super::said::Word;
use super::tables::{NO_SETTING, remark};
use super::work::Work;
use crate::short::short;
use crate::translation::{Kind, OfKey, OfSection, Report, Verdict};
use corehbot::connectors::BoardConnectors;

/// Lines of one command that are shown if nothing is taken from it: a mesh has hundreds.
const MOST_LINES: usize = 5;

/// Lines that nobody reads, of those that are shown.
const MOST_OTHERS: usize = 20;

/// The report on what a printer said, for a board.
pub(super) fn report(work: &Work<'_>, name: &str, board: &'static BoardConnectors) -> Report {
    let mut codes: Vec<&str> = Vec::new();
    for word in &work.said.words {
        if !codes.contains(&word.code.as_str()) {
            codes.push(&word.code);
        }
    }
    let mut sections: Vec<OfSection> = codes.into_iter().map(|code| section(work, name, code)).collect();
    let others = &work.said.others;
    if let Some((first, _)) = others.first() {
        let key = |(line, text): &(usize, String)| OfKey {
            key: short(text).into_owned(),
            value: String::new(),
            line: line.to_string(),
            place: format!("{name}:{line}"),
            verdict: Verdict::new(Kind::NotNeeded, ""),
        };
        let left_out = others.len().saturating_sub(MOST_OTHERS);
        let more = if left_out > 0 { format!(", and {left_out} more like these") } else { String::new() };
        sections.push(OfSection {
            name: "other lines".to_owned(),
            place: format!("{name}:{first}"),
            verdict: Some(Verdict::new(Kind::NotNeeded, format!("they set nothing{more}"))),
            keys: others.iter().take(MOST_OTHERS).map(key).collect(),
        });
    }
    Report { board, sections, notes: work.notes.clone(), open: work.open.clone() }
}

fn section(work: &Work<'_>, name: &str, code: &str) -> OfSection {
    let words: Vec<(usize, &Word)> = work.said.words.iter().enumerate().filter(|(_, word)| word.code == code).collect();
    let place = |line: usize| format!("{name}:{line}");
    let first = words.first().map_or(0, |(_, word)| word.line);
    let whole = remark(code, None);
    let verdict_of = |(entry, word): &(usize, &Word)| {
        let own = work.verdicts().get(*entry).cloned().flatten();
        match (work.said.replaced_in(*entry), own, remark(code, Some(&word.key))) {
            (Some(line), ..) => Some(Verdict::new(Kind::NotNeeded, format!("line {line} replaces it"))),
            (None, Some(verdict), _) => Some(verdict),
            (None, None, Some(remark)) => Some(Verdict::new(remark.kind, remark.text)),
            (None, None, None) => None,
        }
    };
    let of_word = |word: &Word, verdict: Verdict| OfKey {
        key: word.key.clone(),
        value: short(&word.value).into_owned(),
        line: word.line.to_string(),
        place: place(word.line),
        verdict,
    };
    let Some(whole) = whole else {
        let keys = words.iter().map(|word| {
            let verdict = verdict_of(word).unwrap_or_else(|| Verdict::new(Kind::NotYet, NO_SETTING));
            of_word(word.1, verdict)
        });
        return OfSection { name: code.to_owned(), place: place(first), verdict: None, keys: keys.collect() };
    };
    // A line at a time, because none of its words counts on its own.
    let mut lines: Vec<usize> = words.iter().map(|(_, word)| word.line).collect();
    lines.dedup();
    let key = |line: &usize| {
        let said: Vec<String> = words
            .iter()
            .filter(|(_, word)| word.line == *line)
            .map(|(_, word)| format!("{}{}", word.key, word.value))
            .collect();
        let text = if whole.kind == Kind::Decide { whole.text } else { "" };
        let said = said.join(" ");
        OfKey {
            key: if said.is_empty() { code.to_owned() } else { short(&said).into_owned() },
            value: String::new(),
            line: line.to_string(),
            place: place(*line),
            verdict: Verdict::new(whole.kind, text),
        }
    };
    let left_out = lines.len().saturating_sub(MOST_LINES);
    let more = if left_out > 0 { format!(" ({left_out} lines more)") } else { String::new() };
    OfSection {
        name: code.to_owned(),
        place: place(first),
        verdict: Some(Verdict::new(whole.kind, format!("{}{more}", whole.text))),
        keys: lines.iter().take(MOST_LINES).map(key).collect(),
    }
}
