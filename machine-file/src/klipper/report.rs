//! The report: a verdict on every key, also on those that no part of the translation knows.

use super::config::Config;
use super::tables::{NO_SETTING, remark};
use super::work::Work;
use crate::short::short;
use crate::translation::{Kind, OfKey, OfSection, Report, Verdict};
use corehbot::connectors::BoardConnectors;

/// The report on a configuration for a board.
pub(super) fn report(work: &Work<'_>, board: &'static BoardConnectors) -> Report {
    let config = work.config;
    let sections = config.sections.iter().enumerate().map(|(number, section)| {
        let whole = remark(&section.name, None);
        let entries = config.entries.iter().zip(work.verdicts());
        let keys: Vec<_> = entries
            .filter(|(entry, _)| entry.section == number)
            .map(|(entry, verdict)| {
                let verdict = match (entry.replaced, verdict, remark(&section.name, Some(&entry.key)), whole) {
                    (Some(by), ..) => Verdict::new(Kind::NotNeeded, format!("{} replaces it", config.place(by))),
                    (None, Some(verdict), ..) => verdict.clone(),
                    (None, None, ..) if elsewhere(config, &entry.value).is_some() => {
                        let chip = elsewhere(config, &entry.value).unwrap_or_default();
                        Verdict::new(Kind::NotYet, format!("{chip} is another board, and a machine has one so far"))
                    }
                    (None, None, Some(remark), _) => Verdict::new(remark.kind, remark.text),
                    // The section's line has the words.
                    (None, None, None, Some(whole)) => Verdict::new(whole.kind, ""),
                    (None, None, None, None) => Verdict::new(Kind::NotYet, NO_SETTING),
                };
                let line =
                    if entry.at.file == section.at.file { entry.at.line.to_string() } else { config.place(entry.at) };
                let value = entry.value.lines().next().unwrap_or_default();
                let place = config.place(entry.at);
                OfKey { key: entry.key.clone(), value: short(value).into_owned(), line, place, verdict }
            })
            .collect();
        let verdict = match whole {
            Some(whole) => Some(Verdict::new(whole.kind, whole.text)),
            None if keys.is_empty() => Some(Verdict::new(Kind::NotYet, NO_SETTING)),
            None => None,
        };
        OfSection { name: section.name.clone(), place: config.place(section.at), verdict, keys }
    });
    Report { board, sections: sections.collect(), notes: work.notes.clone(), open: Vec::new() }
}

/// The other controller that a pin is on.
fn elsewhere<'v>(config: &Config, value: &'v str) -> Option<&'v str> {
    let (chip, _) = value.trim_start_matches(['^', '~', '!', ' ']).split_once(':')?;
    config.section(&format!("mcu {chip}")).map(|_| chip)
}
