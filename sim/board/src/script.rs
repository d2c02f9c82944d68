//! A scripted host: an exchange written down, as `tests/protocol` has them.
//!
//! `> text` is sent, with a line end; `>> text` is sent without one. `< text` is the next expected output of the
//! printer, word for word, except that `[...]` stands for anything. `#` begins a comment. `\xNN` is a byte. Output
//! before the first sent line counts only if the exchange begins with it. [`BUSY`] counts only where the script has it.

use crate::world::Host;
use corehbot::protocol::BUSY;
use std::io;
use std::path::Path;

/// The names and texts of the scripts in a folder.
///
/// # Errors
/// A folder or file that cannot be read.
pub fn scripts(folder: &Path) -> io::Result<Vec<(String, String)>> {
    let mut scripts = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "txt") {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            scripts.push((name, std::fs::read_to_string(path)?));
        }
    }
    scripts.sort();
    Ok(scripts)
}

/// A step of an exchange.
#[derive(Clone, PartialEq, Eq, Debug)]
enum Step {
    Send(Vec<u8>),
    Expect(String),
}

/// A host that follows a script.
pub struct Script {
    /// Each with its line in the file, from 1.
    steps: Vec<(usize, Step)>,
    next: usize,
    has_begun: bool,
    failure: Option<String>,
}

impl Script {
    /// Reads a script.
    ///
    /// # Errors
    /// The line that is not valid.
    pub fn new(text: &str) -> Result<Self, String> {
        let mut steps = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            let step = if let Some(text) = line.strip_prefix(">> ") {
                Step::Send(unescape(text))
            } else if let Some(text) = line.strip_prefix('>') {
                Step::Send([unescape(text.strip_prefix(' ').unwrap_or(text)), vec![b'\n']].concat())
            } else if let Some(text) = line.strip_prefix('<') {
                Step::Expect(text.strip_prefix(' ').unwrap_or(text).to_owned())
            } else if line.is_empty() || line.starts_with('#') {
                continue;
            } else {
                return Err(format!("line {number} is neither >, < nor #: {line}"));
            };
            steps.push((number, step));
        }
        let has_begun = matches!(steps.first(), Some((_, Step::Expect(_))));
        Ok(Self { steps, next: 0, has_begun, failure: None })
    }

    /// The place where the printer's output differs, or the output that is missing.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        self.failure.clone().or_else(|| {
            self.steps.get(self.next).map(|(number, step)| format!("line {number} was not reached: {step:?}"))
        })
    }
}

impl Host for Script {
    fn send(&mut self, out: &mut Vec<u8>) {
        while let Some((_, Step::Send(bytes))) = self.steps.get(self.next) {
            out.extend(bytes);
            self.next += 1;
            self.has_begun = true;
        }
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        // Not before the greeting is over.
        if self.next > 0 {
            self.send(out);
        }
    }

    fn hear(&mut self, line: &str) {
        if !self.has_begun || self.is_done() {
            return;
        }
        let (number, expected) = match &self.steps[self.next] {
            (number, Step::Expect(text)) => (number, text.as_str()),
            (number, Step::Send(_)) => (number, "nothing"),
        };
        if matches(line, expected) {
            self.next += 1;
        } else if line != BUSY {
            self.failure = Some(format!("line {number} expected \"{expected}\", the printer said \"{line}\""));
        }
    }

    fn is_done(&self) -> bool {
        self.failure.is_some() || self.next == self.steps.len()
    }
}

/// Whether `line` is `pattern`, in which `[...]` stands for anything.
fn matches(line: &str, pattern: &str) -> bool {
    let Some((first, mut others)) = pattern.split_once("[...]") else {
        return line == pattern;
    };
    let Some(mut rest) = line.strip_prefix(first) else {
        return false;
    };
    while let Some((part, tail)) = others.split_once("[...]") {
        let Some(at) = rest.find(part) else { return false };
        (rest, others) = (&rest[at + part.len()..], tail);
    }
    rest.ends_with(others)
}

/// A text with its `\xNN` as bytes.
fn unescape(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find("\\x") {
        let code = rest.get(at + 2..at + 4).and_then(|code| u8::from_str_radix(code, 16).ok());
        let end = if code.is_some() { at } else { at + 2 };
        bytes.extend(&rest.as_bytes()[..end]);
        bytes.extend(code);
        rest = &rest[if code.is_some() { at + 4 } else { end }..];
    }
    bytes.extend(rest.as_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exchange_is_followed_word_for_word() {
        let mut script = Script::new("# x\n> M105\n< ok T:[...] B:[...]\n>> \\x41\n").unwrap();
        script.hear("start");
        let mut out = Vec::new();
        script.send(&mut out);
        script.hear(BUSY);
        script.hear("ok T:1 B:2");
        script.send(&mut out);
        assert_eq!((out.as_slice(), script.failure(), script.is_done()), (&b"M105\nA"[..], None, true));
        let mut script = Script::new("> M105\n< ok\n").unwrap();
        script.send(&mut out);
        assert!(script.failure().is_some_and(|why| why.contains("not reached")));
        script.hear("okay");
        assert_eq!(script.failure().unwrap(), "line 2 expected \"ok\", the printer said \"okay\"");
        assert!(Script::new("M105").is_err());
    }
}
