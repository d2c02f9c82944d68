//! A configuration of Klipper: its sections and keys, in the order of the files, with the place of each.
//!
//! Klipper reads its files with Python's `configparser`. These rules are the same:
//!
//! - `#` begins a comment anywhere, `;` at the beginning of a word.
//! - A line that is indented further than its key continues the value. Keys have no case.
//! - A section that comes again goes on. A later value replaces an earlier one.
//! - After an include a section has to begin again.
//! - The block of SAVE_CONFIG (`#*#` at the end of the first file) counts where the file itself says nothing.

use crate::pattern::is_pattern;
use crate::short::short;
use std::collections::BTreeMap;
use std::fmt::{self, Display};

/// The files of a configuration, for one who can open them.
pub trait Files {
    /// The names of the files that `pattern` means in a file of the name `from`, in the order of their names.
    fn matching(&mut self, from: &str, pattern: &str) -> Vec<String>;

    /// The text of a file.
    ///
    /// # Errors
    /// Why it cannot be read.
    fn read(&mut self, name: &str) -> Result<String, String>;
}

/// A place in a configuration.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct At {
    /// The file, by its number in [`Config::files`].
    pub file: usize,
    /// The line, from 1.
    pub line: usize,
}

/// A key and its value.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The section, by its number in [`Config::sections`].
    pub section: usize,
    /// The key, in small letters.
    pub key: String,
    /// The value; lines after the first one behind a line break.
    pub value: String,
    /// The number of each line of the value in its file.
    pub lines: Vec<usize>,
    /// Where it stands.
    pub at: At,
    /// The place of the entry that replaces it.
    pub replaced: Option<At>,
    is_saved: bool,
}

/// A section.
#[derive(Clone, Debug)]
pub struct Section {
    /// Its name: `stepper_x`, `tmc2209 stepper_x`.
    pub name: String,
    /// Where it begins first.
    pub at: At,
}

/// A whole configuration.
#[derive(Default, Debug)]
pub struct Config {
    /// The files, the first one first.
    pub files: Vec<String>,
    /// The sections in the order in which they begin.
    pub sections: Vec<Section>,
    /// The keys of all sections in the order of the files.
    pub entries: Vec<Entry>,
    /// The comments, in small letters: boards are named there.
    pub comments: String,
    /// Includes of files that are not there, each with its pattern.
    pub missing: Vec<(At, String)>,
}

/// A line that Klipper would not read either.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Mistake {
    /// `file:line`.
    pub place: String,
    /// The problem and its cure.
    pub text: String,
}

impl Config {
    /// Whether a printer is in it, and not only a part of one such as its macros.
    #[must_use]
    pub fn has_printer(&self) -> bool {
        self.sections.iter().any(|section| section.name == "printer" || section.name.starts_with("stepper_"))
    }
}

impl Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: error: {}", self.place, self.text)
    }
}

/// Files that include each other deeper than this are taken for a loop.
const DEEPEST: usize = 32;

/// The most files and bytes of a configuration: the largest published ones have some two hundred files.
const MOST_FILES: usize = 1000;
const MOST_BYTES: usize = 1 << 24;

/// The lines that SAVE_CONFIG writes begin so.
const SAVED: &str = "#*#";

impl Config {
    /// Reads the file of that name and all that it includes.
    ///
    /// # Errors
    /// Every line that is wrong.
    pub fn read(name: &str, files: &mut dyn Files) -> Result<Self, Vec<Mistake>> {
        let mut reading = Reading { config: Self::default(), mistakes: Vec::new(), open: Vec::new(), bytes: 0 };
        reading.file(name, None, files);
        reading.config.replace();
        if reading.mistakes.is_empty() { Ok(reading.config) } else { Err(reading.mistakes) }
    }

    /// The place as `file:line`.
    #[must_use]
    pub fn place(&self, at: At) -> String {
        format!("{}:{}", self.files.get(at.file).map_or("", String::as_str), at.line)
    }

    /// The section of that name.
    #[must_use]
    pub fn section(&self, name: &str) -> Option<usize> {
        self.sections.iter().position(|section| section.name == name)
    }

    /// The entry that counts for a key of a section.
    #[must_use]
    pub fn find(&self, section: &str, key: &str) -> Option<usize> {
        let section = self.section(section)?;
        self.entries.iter().position(|entry| entry.section == section && entry.key == key && entry.replaced.is_none())
    }

    /// Marks entries that another one replaces.
    fn replace(&mut self) {
        let mut counts: BTreeMap<(usize, String), usize> = BTreeMap::new();
        for number in 0..self.entries.len() {
            let Some(entry) = self.entries.get(number) else { continue };
            let (key, at, is_saved) = ((entry.section, entry.key.clone()), entry.at, entry.is_saved);
            match counts.get(&key).and_then(|earlier| self.entries.get_mut(*earlier).map(|entry| (*earlier, entry))) {
                Some((_, earlier)) if is_saved && !earlier.is_saved => {
                    let by = earlier.at;
                    self.entries[number].replaced = Some(by);
                }
                Some((_, earlier)) => {
                    earlier.replaced = Some(at);
                    counts.insert(key, number);
                }
                None => drop(counts.insert(key, number)),
            }
        }
    }
}

/// The state of reading.
struct Reading {
    config: Config,
    mistakes: Vec<Mistake>,
    /// The files that are being read, each included by the one before.
    open: Vec<String>,
    bytes: usize,
}

/// Where the lines of a text stand.
#[derive(Default)]
struct Standing {
    section: Option<usize>,
    /// The entry that an indented line continues, and the indent of its key.
    key: Option<(usize, usize)>,
    is_saved: bool,
}

impl Reading {
    fn wrong(&mut self, at: At, text: String) {
        self.mistakes.push(Mistake { place: self.config.place(at), text });
    }

    fn file(&mut self, name: &str, from: Option<At>, files: &mut dyn Files) {
        // A file that cannot be read is wrong at the line that includes it.
        let problem = |text: String, reading: &mut Self| match from {
            Some(at) => reading.wrong(at, text),
            None => reading.mistakes.push(Mistake { place: short(name).into_owned(), text }),
        };
        if self.open.iter().any(|open| open == name) || self.open.len() >= DEEPEST {
            let way = format!("{} includes itself: take out one of these includes", self.open.join(" -> "));
            return problem(way, self);
        }
        let text = match files.read(name) {
            Ok(text) => text,
            Err(why) => return problem(format!("cannot read {}: {why}", short(name)), self),
        };
        self.bytes += text.len();
        if self.config.files.len() >= MOST_FILES || self.bytes > MOST_BYTES {
            return problem(format!("more than {MOST_FILES} files or {MOST_BYTES} bytes"), self);
        }
        self.config.files.push(name.to_owned());
        let file = self.config.files.len() - 1;
        self.open.push(name.to_owned());
        let is_first = file == 0;
        let mut standing = Standing::default();
        for (number, line) in text.lines().enumerate() {
            let at = At { file, line: number + 1 };
            let saved = line.strip_prefix(SAVED).filter(|_| is_first);
            match saved {
                Some(rest) => {
                    if !standing.is_saved {
                        standing = Standing { is_saved: true, ..Standing::default() };
                    }
                    let rest = rest.strip_prefix(' ').unwrap_or(rest);
                    // Its head is text for people.
                    if standing.section.is_some() || rest.starts_with('[') {
                        self.line(rest, at, &mut standing, files);
                    }
                }
                None => self.line(line, at, &mut standing, files),
            }
        }
        self.open.pop();
    }

    fn line(&mut self, line: &str, at: At, standing: &mut Standing, files: &mut dyn Files) {
        let (line, comment) = parted(line);
        if !comment.is_empty() {
            self.config.comments.push_str(&comment.to_lowercase());
            self.config.comments.push('\n');
        }
        let words = line.trim();
        if words.is_empty() {
            return;
        }
        let indent = line.chars().take_while(|c| c.is_whitespace()).count();
        if let Some((entry, of_key)) = standing.key
            && indent > of_key
            && let Some(entry) = self.config.entries.get_mut(entry)
        {
            if !entry.value.is_empty() {
                entry.value.push('\n');
            }
            entry.value.push_str(words);
            entry.lines.push(at.line);
            return;
        }
        if let Some(header) = words.strip_prefix('[') {
            return self.header(header, at, standing, files);
        }
        let Some(end) = words.find([':', '=']) else {
            let text = format!(
                "{:?} is neither a [section] nor a `key: value`; indent it if it goes on with the line above",
                short(words)
            );
            return self.wrong(at, text);
        };
        let Some(section) = standing.section else {
            let text =
                format!("{:?} stands in no section: a line such as [printer] has to come before it", short(words));
            return self.wrong(at, text);
        };
        let (key, value) = (words[..end].trim().to_lowercase(), words[end + 1..].trim().to_owned());
        if key.is_empty() {
            return self.wrong(at, format!("{:?} has no key", short(words)));
        }
        let is_saved = standing.is_saved;
        let lines = if value.is_empty() { Vec::new() } else { vec![at.line] };
        self.config.entries.push(Entry { section, key, value, lines, at, replaced: None, is_saved });
        standing.key = Some((self.config.entries.len() - 1, indent));
    }

    /// The header of a section, behind its bracket.
    fn header(&mut self, header: &str, at: At, standing: &mut Standing, files: &mut dyn Files) {
        let Some(end) = header.rfind(']') else {
            return self.wrong(at, format!("the section [{} has no `]` at its end", short(header)));
        };
        let name = header[..end].trim();
        standing.key = None;
        standing.section = None;
        if let Some(pattern) = name.strip_prefix("include ") {
            let pattern = pattern.trim();
            let from = self.config.files.get(at.file).cloned().unwrap_or_default();
            let found = files.matching(&from, pattern);
            if found.is_empty() && !is_pattern(pattern) {
                // The rest is read: an owner may have half of the files at hand.
                self.config.missing.push((at, pattern.to_owned()));
            }
            for file in found {
                self.file(&file, Some(at), files);
            }
            return;
        }
        if name.is_empty() {
            return self.wrong(at, "a section without a name".to_owned());
        }
        let known = self.config.section(name);
        standing.section = Some(known.unwrap_or_else(|| {
            self.config.sections.push(Section { name: name.to_owned(), at });
            self.config.sections.len() - 1
        }));
    }
}

/// A line before its comment, and the comment.
fn parted(line: &str) -> (&str, &str) {
    let mut before = ' ';
    for (place, c) in line.char_indices() {
        if c == '#' || (c == ';' && before.is_whitespace()) {
            return (&line[..place], &line[place + 1..]);
        }
        before = c;
    }
    (line, "")
}
