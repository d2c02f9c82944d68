//! A printer's reports as words: the lines of M503, M115, M211, M119 and M122.
//!
//! Versions differ in their decoration, but not in the commands (`Marlin/src/module/settings.cpp`,
//! `MarlinSettings::report`; in 1.1.9 `configuration_store.cpp`):
//!
//! - A line of settings begins with `echo:` or with blanks alone.
//! - Headings end with a colon, and begin with `; ` from 2.0.9 on.
//! - Remarks follow behind `;`.
//!
//! Logs of hosts put `Recv:` and a time before each line.

use super::tables::selectors;

/// A word with a value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Word {
    /// The command: `M92`.
    pub code: String,
    /// The word: `X`; behind its motor or tool, if that is not the first: `I1 Z`, `T1 E`.
    pub key: String,
    /// Its value; empty for a word alone.
    pub value: String,
    /// Its line, from 1.
    pub line: usize,
    /// Lengths are in inches.
    pub is_inches: bool,
}

/// All that a printer said.
#[derive(Default, Debug)]
pub(crate) struct Said {
    /// The words, in the order of the lines.
    pub words: Vec<Word>,
    /// Lines that nothing here reads, each with its number.
    pub others: Vec<(usize, String)>,
    /// The drivers in the columns of M122, by their words in M906.
    drivers: Vec<String>,
}

/// Words that are kept: a report has some hundred, one with a large mesh some thousand.
const MOST_WORDS: usize = 20_000;

impl Said {
    /// Words that another source says in Marlin's terms.
    pub fn of(words: Vec<Word>) -> Self {
        Self { words, ..Self::default() }
    }

    /// Reads all lines.
    pub fn read(text: &str) -> Self {
        let (mut said, mut is_inches) = (Self::default(), false);
        for (number, line) in text.lines().enumerate() {
            if said.words.len() + said.others.len() >= MOST_WORDS {
                said.others.push((number + 1, "the rest, which is too much for a report".to_owned()));
                break;
            }
            said.line(number + 1, bare(line), &mut is_inches);
        }
        said
    }

    /// The word that counts: the last one.
    pub fn find(&self, code: &str, key: &str) -> Option<usize> {
        self.words.iter().rposition(|word| word.code == code && word.key == key)
    }

    /// The line of the word that replaces this one.
    pub fn replaced_in(&self, word: usize) -> Option<usize> {
        let Word { code, key, .. } = self.words.get(word)?;
        let last = self.find(code, key)?;
        (last != word).then(|| self.words.get(last).map(|last| last.line))?
    }

    fn line(&mut self, number: usize, text: &str, is_inches: &mut bool) {
        let command = text.split(';').next().unwrap_or_default();
        if is_code(command) {
            let mut parts = command.split_ascii_whitespace();
            let code = parts.next().unwrap_or_default().to_ascii_uppercase();
            match code.as_str() {
                "G20" => *is_inches = true,
                "G21" => *is_inches = false,
                _ => {}
            }
            self.command(number, &code, parts, *is_inches);
        } else if text.contains("FIRMWARE_NAME:") {
            self.firmware(number, text);
        } else if let Some(area) = text.strip_prefix("area:") {
            self.area(number, area);
        } else if let Some((least, most)) = text.split_once("Max:").filter(|(least, _)| least.contains("Min:")) {
            let least = least.split("Min:").nth(1).unwrap_or_default();
            self.ends(number, "Min", least);
            self.ends(number, "Max", most);
        } else if let Some((switch, state)) = switch_in(text) {
            self.push(number, "M119", &switch, state, false);
        } else if let Some(drivers) = columns(text) {
            self.drivers = drivers;
        } else if text.contains('\t') && !self.drivers.is_empty() {
            self.row(number, text);
        } else if !is_noise(text) {
            self.others.push((number, text.to_owned()));
        }
    }

    fn push(&mut self, line: usize, code: &str, key: &str, value: &str, is_inches: bool) {
        self.words.push(Word { code: code.to_owned(), key: key.to_owned(), value: value.to_owned(), line, is_inches });
    }

    /// The words of a command. Some choose a motor or a tool, and are a part of the other words' keys.
    fn command<'t>(&mut self, line: usize, code: &str, parts: impl Iterator<Item = &'t str>, is_inches: bool) {
        let words: Vec<(String, &str)> = parts.map(parted).collect();
        let is_selector = |(letter, value): &(String, &str)| {
            selectors(code).contains(letter.as_str()) && (code != "M593" || value.is_empty())
        };
        let chosen: String = words
            .iter()
            .filter(|word| is_selector(word) && word.1 != "0")
            .map(|(letter, value)| format!("{letter}{value} "))
            .collect();
        let mode = words.iter().find(|(letter, _)| letter == "S").map_or("", |(_, value)| value);
        let others: Vec<_> = words.iter().filter(|word| !is_selector(word)).collect();
        for (letter, value) in &others {
            match code {
                // M569 S1 X Y: S is the value of every motor.
                "M569" if letter == "S" && others.len() > 1 => {}
                "M569" if value.is_empty() => self.push(line, code, &format!("{chosen}{letter}"), mode, is_inches),
                _ => self.push(line, code, &format!("{chosen}{letter}"), value, is_inches),
            }
        }
        if others.is_empty() {
            self.push(line, code, chosen.trim_end(), "", is_inches);
        }
    }

    /// `FIRMWARE_NAME:Marlin 2.1.2 (...) SOURCE_CODE_URL:... MACHINE_TYPE:Ender-3 V2 EXTRUDER_COUNT:1`: values have
    /// blanks, so one ends before the next name.
    fn firmware(&mut self, line: usize, text: &str) {
        let is_name = |word: &str| {
            let name = word.split_once(':').map(|(name, _)| name);
            name.is_some_and(|name| name.len() > 3 && name.chars().all(|c| c.is_ascii_uppercase() || c == '_'))
        };
        let mut fields: Vec<(&str, String)> = Vec::new();
        for word in text.split_ascii_whitespace() {
            match (word.split_once(':').filter(|_| is_name(word)), fields.last_mut()) {
                (Some((name, value)), _) => fields.push((name, value.to_owned())),
                (None, Some((_, value))) => {
                    value.push_str(if value.is_empty() { "" } else { " " });
                    value.push_str(word);
                }
                (None, None) => {}
            }
        }
        for (name, value) in fields {
            self.push(line, "M115", name, &value, false);
        }
    }

    /// `{full:{min:{x:0.00,y:0.00,z:0.00},max:{x:235.00,...}},work:...}`, in mm.
    fn area(&mut self, line: usize, text: &str) {
        let full = text.split("work:").next().unwrap_or_default();
        for (name, key) in [("min:{", "Min"), ("max:{", "Max")] {
            let Some((_, inner)) = full.split_once(name) else { continue };
            let inner = inner.split('}').next().unwrap_or_default();
            for (axis, value) in inner.split(',').filter_map(|pair| pair.split_once(':')) {
                self.push(line, "M115", &format!("{key} {}", axis.trim().to_ascii_uppercase()), value.trim(), false);
            }
        }
    }

    /// A row of M122: of its many readings only the microsteps are a setting that no other command says.
    fn row(&mut self, line: usize, text: &str) {
        let mut cells = text.split('\t').map(str::trim).filter(|cell| !cell.is_empty());
        if cells.next() == Some("msteps") {
            for (driver, value) in self.drivers.clone().into_iter().zip(cells) {
                self.push(line, "M122", &driver, value, false);
            }
        }
    }

    /// `X0.00 Y0.00 Z0.00` of M211, in mm.
    fn ends(&mut self, line: usize, end: &str, text: &str) {
        let is_axis = |(letter, _): &(String, &str)| "XYZIJKUVW".contains(letter.as_str());
        for (letter, value) in text.split_ascii_whitespace().map(parted).filter(is_axis) {
            self.push(line, "M211", &format!("{end} {letter}"), value, false);
        }
    }
}

/// The drivers in the head of M122, `X X2 Y Z E` with tabs between: as words of M906, where X2 is `I1 X`.
fn columns(text: &str) -> Option<Vec<String>> {
    let driver = |name: &str| {
        let (letter, number) = (name.get(..1)?, name.get(1..)?);
        match (letter, number) {
            ("X" | "Y" | "Z" | "E", "") => Some(letter.to_owned()),
            ("X" | "Y" | "Z", "2" | "3" | "4") => Some(format!("I{} {letter}", number.parse::<u8>().ok()? - 1)),
            ("E", "1" | "2" | "3" | "4" | "5" | "6" | "7") => Some(format!("T{number} E")),
            _ => None,
        }
    };
    text.contains('\t').then(|| text.split('\t').filter(|cell| !cell.is_empty()).map(driver).collect())?
}

/// Signs of terminals and hosts before a line: OctoPrint, Pronterface, Repetier-Host, Arduino's monitor, Cura.
const SIGNS: [&str; 13] =
    ["Recv:", "RECV:", "READ:", "Read:", "Printer:", "<<<", ">>>", "->", "<-", "<", ">", "|", "echo:"];

/// Commands that ask: a log has them as the host sent them.
const QUESTIONS: [&str; 8] = ["M503", "M115", "M119", "M211", "M122", "M501", "M105", "M420"];

/// A line without decoration: signs and time stamps, in any order, each as often as it comes.
fn bare(line: &str) -> &str {
    let mut text = line.trim();
    loop {
        let before = text.len();
        if text.starts_with('[')
            && let Some((_, rest)) = text.split_once("] ")
        {
            text = rest.trim_start();
        }
        text = without_number(without_time(text));
        for sign in SIGNS {
            text = text.strip_prefix(sign).unwrap_or(text).trim_start();
        }
        if text.len() == before {
            break;
        }
    }
    let is_question = text != line.trim() && QUESTIONS.contains(&text);
    if is_question { "" } else { text }
}

/// A line without a date or a time at its beginning: digits, with two signs between them or more.
fn without_time(text: &str) -> &str {
    let word = text.split(char::is_whitespace).next().unwrap_or_default();
    let inner = word.trim_matches(['(', ')', ',']);
    let between = inner.chars().filter(|c| [':', '-', '/', '.', ','].contains(c)).count();
    let is_time = between >= 2
        && inner.starts_with(|c: char| c.is_ascii_digit())
        && inner.chars().all(|c| c.is_ascii_digit() || [':', '-', '/', '.', ',', 'T', 'Z', '+'].contains(&c));
    if !is_time {
        return text;
    }
    let rest = text[word.len()..].trim_start();
    let rest = ["AM ", "PM "].iter().find_map(|half| rest.strip_prefix(half)).unwrap_or(rest);
    rest.strip_prefix("- ").or_else(|| rest.strip_prefix(": ")).unwrap_or(rest).trim_start()
}

/// A line without its number, `12: `.
fn without_number(text: &str) -> &str {
    let rest = text.trim_start_matches(|c: char| c.is_ascii_digit());
    if rest.len() == text.len() { text } else { rest.strip_prefix(": ").unwrap_or(text).trim_start() }
}

/// Whether a line begins with a command: G or M and a number.
fn is_code(text: &str) -> bool {
    let code = text.split_ascii_whitespace().next().unwrap_or_default();
    let number = code.strip_prefix(['G', 'M', 'g', 'm']).unwrap_or_default();
    (1..=4).contains(&number.len()) && number.bytes().all(|byte| byte.is_ascii_digit())
}

/// A word's letter and its value. A word without a letter is its own.
fn parted(word: &str) -> (String, &str) {
    match word.chars().next().filter(char::is_ascii_alphabetic) {
        Some(letter) => (letter.to_ascii_uppercase().to_string(), &word[1..]),
        None => (word.to_owned(), ""),
    }
}

/// `x_min: open`
fn switch_in(text: &str) -> Option<(String, &str)> {
    let (name, state) = text.split_once(':')?;
    let (name, state) = (name.trim().to_ascii_lowercase(), state.trim());
    let is_switch = name.ends_with("_min") || name.ends_with("_max") || name == "z_probe" || name == "probe";
    let is_state = ["open", "TRIGGERED", "NOT TRIGGERED"].contains(&state);
    (is_state && (is_switch || name.starts_with("filament"))).then_some((name, state))
}

/// Lines that set nothing: headings, remarks, answers, and reports that a printer makes on its own.
fn is_noise(text: &str) -> bool {
    const BEGINNINGS: [&str; 12] =
        [";", "ok", "wait", "start", "busy:", "T:", "T0:", "X:", "Cap:", "//", "Send:", "SENT:"];
    text.is_empty()
        || BEGINNINGS.iter().any(|beginning| text.starts_with(beginning))
        || text.ends_with(':')
        // `Advanced: B<min_segment_time_us> S<min_feedrate>`, `Filament settings: Disabled`
        || (text.contains(':') && text.contains('<'))
        || ["Reporting endstop status", "Filament settings: Disabled"].contains(&text)
        || text.starts_with("Soft endstops")
}
