//! Sources that become words of Marlin. A part of a source is an item, and an item says some words of M503 or of other
//! answers. So the rules for words hold for items too, and an item's verdict is the verdict on its words.

use super::said::{Said, Word};
use super::tables::{NO_SETTING, remark};
use super::work::Work;
use crate::short::short;
use crate::translation::draft::rounded;
use crate::translation::{Kind, OfKey, OfSection, Report, Translation, Verdict};
use corehbot::connectors::BoardConnectors;

/// A part of a source that needs a verdict.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    /// The section of the report that has it.
    pub section: String,
    pub key: String,
    pub value: String,
    /// The file, by its number.
    pub file: usize,
    pub line: usize,
}

/// Items, and the words that they say.
#[derive(Default)]
pub(crate) struct Source {
    pub files: Vec<String>,
    pub items: Vec<Item>,
    words: Vec<Word>,
}

/// The code of the word that an item has in any case, by which its own reader finds it.
pub(crate) const ITEM: &str = "=";

impl Source {
    /// Nothing yet, of these files.
    pub fn of(files: Vec<String>) -> Self {
        Self { files, ..Self::default() }
    }

    /// Adds an item, and returns its number.
    pub fn item(&mut self, item: Item) -> usize {
        let number = self.items.len();
        self.word(number, ITEM, &item.key.clone(), &item.value.clone());
        self.items.push(item);
        number
    }

    /// A word that an item says.
    pub fn word(&mut self, item: usize, code: &str, key: &str, value: &str) {
        let (code, key, value) = (code.to_owned(), key.to_owned(), value.to_owned());
        self.words.push(Word { code, key, value, line: item, is_inches: false });
    }

    /// The same with a number.
    pub fn number(&mut self, item: usize, code: &str, key: &str, number: f64) {
        self.word(item, code, key, &rounded(number).to_string());
    }

    /// The words, as a printer might have said them.
    pub fn said(&self) -> Said {
        Said::of(self.words.clone())
    }

    /// The place of each word, for the draft.
    pub fn places(&self) -> Vec<String> {
        self.words.iter().map(|word| self.items.get(word.line).map_or_else(String::new, |it| self.place(it))).collect()
    }

    fn place(&self, item: &Item) -> String {
        format!("{}:{}", self.files.get(item.file).map_or("", String::as_str), item.line)
    }

    /// The machine file, and the report with the verdict of each item; `other` says it of items that nothing here uses.
    pub fn translation(
        &self,
        work: &Work<'_>,
        board: &'static BoardConnectors,
        what: &str,
        other: impl Fn(&Item) -> Verdict,
    ) -> Translation {
        let mut sections: Vec<OfSection> = Vec::new();
        for (number, item) in self.items.iter().enumerate() {
            let verdict = self.verdict(work, number).unwrap_or_else(|| other(item));
            let of_key = OfKey {
                key: item.key.clone(),
                value: short(&item.value).into_owned(),
                line: item.line.to_string(),
                place: self.place(item),
                verdict,
            };
            match sections.iter_mut().find(|section| section.name == item.section) {
                Some(section) => section.keys.push(of_key),
                None => sections.push(OfSection {
                    name: item.section.clone(),
                    place: self.place(item),
                    verdict: None,
                    keys: vec![of_key],
                }),
            }
        }
        let head = format!(
            "#:schema ./machine.schema.json\n# From {}. `corehbot config check` checks it.\n# {what} does not say the \
             lines with `to be filled in`.\n",
            self.files.first().map_or("", String::as_str).escape_debug()
        );
        let report = Report { board, sections, notes: work.notes.clone(), open: work.open.clone() };
        Translation::new(head + &work.lines.text(), report)
    }

    /// What became of an item's words: of those that another item replaces nothing is told but that.
    fn verdict(&self, work: &Work<'_>, number: usize) -> Option<Verdict> {
        let words = self.words.iter().enumerate().filter(|(_, word)| word.line == number);
        let mut found: Option<Verdict> = None;
        for (entry, word) in words {
            let own = work.verdicts().get(entry).cloned().flatten();
            // Words of items have no other meaning than their item.
            let by = work.said.replaced_in(entry).filter(|_| word.code != ITEM).and_then(|by| self.items.get(by));
            let verdict = match (own, by) {
                (Some(own), _) => own,
                (None, Some(by)) => Verdict::new(Kind::NotNeeded, format!("{} replaces it", self.place(by))),
                (None, None) if word.code == ITEM => continue,
                (None, None) => match remark(&word.code, Some(&word.key)).or_else(|| remark(&word.code, None)) {
                    Some(remark) => Verdict::new(remark.kind, remark.text),
                    None => Verdict::new(Kind::NotYet, NO_SETTING),
                },
            };
            found = Some(match found {
                Some(found) => found.and(verdict),
                None => verdict,
            });
        }
        found
    }
}
