//! The report: a line for every key of the configuration, by sections, then what the owner has to decide.

use super::verdict::{Kind, Verdict};
use crate::short::short;
use corehbot::connectors::BoardConnectors;
use std::fmt::{self, Display, Write as _};

/// What became of a configuration.
#[derive(Debug)]
pub struct Report {
    /// The board that it is for.
    pub board: &'static BoardConnectors,
    /// The sections, in the order of the configuration.
    pub sections: Vec<OfSection>,
    /// What the owner has to decide or to check, beyond single keys.
    pub notes: Vec<Verdict>,
    /// Keys that the owner has to fill in.
    pub open: Vec<String>,
}

/// What became of a section.
#[derive(Debug)]
pub struct OfSection {
    /// Its name.
    pub name: String,
    /// `file:line` of its beginning.
    pub place: String,
    /// What became of it as a whole, if that can be said.
    pub verdict: Option<Verdict>,
    /// Its keys.
    pub keys: Vec<OfKey>,
}

/// What became of a key.
#[derive(Debug)]
pub struct OfKey {
    /// The key.
    pub key: String,
    /// The beginning of its value.
    pub value: String,
    /// Its line, or `file:line` if the section began in another file.
    pub line: String,
    /// `file:line`.
    pub place: String,
    /// What became of it.
    pub verdict: Verdict,
}

impl Report {
    /// How many keys have each verdict; a section without keys counts as one.
    #[must_use]
    pub fn counts(&self) -> [(Kind, usize); 5] {
        Kind::ALL.map(|kind| {
            let of_keys = self.sections.iter().flat_map(|section| &section.keys).filter(|key| key.verdict.kind == kind);
            let empty = self.sections.iter().filter(|section| section.keys.is_empty());
            let empty = empty.filter(|section| section.verdict.as_ref().is_some_and(|verdict| verdict.kind == kind));
            let notes = self.notes.iter().filter(|note| note.kind == kind);
            (kind, of_keys.count() + empty.count() + notes.count())
        })
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.board.key {
            "" => writeln!(f, "for any board")?,
            _ => writeln!(f, "for the {}", self.board.name)?,
        }
        for section in &self.sections {
            write!(f, "\n[{}] {}", short(&section.name), section.place)?;
            match &section.verdict {
                Some(verdict) => writeln!(f, ": {}: {}", verdict.kind.word(), verdict.text)?,
                None => writeln!(f)?,
            }
            for OfKey { key, value, line, verdict, .. } in &section.keys {
                let equals = if value.is_empty() { "" } else { " = " };
                let mut said = format!("  {:<14} {line}: {}{equals}{value}", verdict.kind.word(), short(key));
                if !verdict.text.is_empty() {
                    let _ = write!(said, " -> {}", verdict.text);
                }
                writeln!(f, "{said}")?;
            }
        }
        if !self.notes.is_empty() {
            writeln!(f, "\nthe whole")?;
            self.notes.iter().try_for_each(|note| writeln!(f, "  {:<14} {}", note.kind.word(), note.text))?;
        }
        // Once more at the end, because macros make reports long.
        let keys = self.sections.iter().flat_map(|section| section.keys.iter().map(move |key| (&section.name, key)));
        let open: Vec<_> = keys.filter(|(_, key)| key.verdict.kind == Kind::Decide).collect();
        if !open.is_empty() {
            writeln!(f, "\n{}", Kind::Decide.word())?;
        }
        for (section, OfKey { key, place, verdict, .. }) in open {
            writeln!(f, "  {place}: [{}] {}: {}", short(section), short(key), verdict.text)?;
        }
        if !self.open.is_empty() {
            writeln!(f, "\nto be filled in")?;
            self.open.iter().try_for_each(|key| writeln!(f, "  {key}"))?;
        }
        let counts = self.counts().map(|(kind, count)| format!("{count} {}", kind.word()));
        write!(f, "\n{}", counts.join(", "))?;
        let more = if self.open.is_empty() { String::new() } else { format!(", {} to be filled in", self.open.len()) };
        writeln!(f, "{more}")
    }
}
