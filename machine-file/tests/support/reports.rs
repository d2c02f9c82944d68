//! Reports of translations: their verdicts, and their stored copies.

use corehbot_machine_file::{Kind, Report};
use std::path::Path;

/// The verdict on a key of a section: its kind and its words.
pub fn verdict<'r>(report: &'r Report, section: &str, key: &str) -> (Kind, &'r str) {
    let section = report.sections.iter().find(|known| known.name == section).unwrap();
    let key = section.keys.iter().rfind(|known| known.key == key).unwrap();
    (key.verdict.kind, &key.verdict.text)
}

/// Compares a text with its stored copy.
pub fn is_stored(path: &Path, text: &str) {
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(path, text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap_or_default(), text, "{}: BLESS=1 writes it", path.display());
}
