//! Defines: which `#define`s of the files count.
//!
//! `//#define` is off. A condition that needs names of Marlin's other files may be unknown. Then all of its branches
//! are read, and if a name gets two values, neither counts.

use super::expression::{Names, Number, value};
use std::collections::{BTreeMap, BTreeSet};

/// A define that counts, as far as is known.
#[derive(Clone, Debug)]
pub(super) struct Define {
    pub name: String,
    pub value: String,
    pub file: usize,
    pub line: usize,
}

/// All defines.
#[derive(Default)]
pub(super) struct Defines {
    /// In the order of the files.
    pub all: Vec<Define>,
    /// The defines of a name that count: one, or several with different values.
    current: BTreeMap<String, Vec<usize>>,
    /// Defines that an `#undef` took back, and its line.
    undone: BTreeMap<usize, usize>,
    /// Names that the files know, also those that are off.
    known: BTreeSet<String>,
}

/// A condition: whether its branch counts, and whether one of its branches did.
struct Condition {
    is_on: Option<bool>,
    was_on: Option<bool>,
}

/// Defines that are kept: Marlin's files have some thousand, off ones too.
const MOST: usize = 20_000;

impl Defines {
    /// Reads files, one after the other.
    pub fn read(files: &[(&str, &str)]) -> Self {
        let mut defines = Self::default();
        let parts = |line: &str| {
            let rest = line.trim_start_matches(['/', ' ', '\t']).strip_prefix("#define")?;
            rest.trim_start().split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().map(str::to_owned)
        };
        for (_, text) in files {
            defines.known.extend(text.lines().filter_map(parts));
        }
        for (file, (_, text)) in files.iter().enumerate() {
            defines.file(file, text);
        }
        defines
    }

    fn file(&mut self, file: usize, text: &str) {
        let (mut open, mut is_comment, mut joined) = (Vec::new(), false, String::new());
        let mut first = 0;
        for (number, line) in text.lines().enumerate() {
            if joined.is_empty() {
                first = number + 1;
            }
            joined += &without_comments(line, &mut is_comment);
            if let Some(before) = joined.trim_end().strip_suffix('\\') {
                joined = before.to_owned() + " ";
                continue;
            }
            if self.all.len() < MOST {
                self.line(file, first, joined.trim(), &mut open);
            }
            joined.clear();
        }
    }

    fn line(&mut self, file: usize, line: usize, text: &str, open: &mut Vec<Condition>) {
        let Some(rest) = text.strip_prefix('#') else { return };
        let rest = rest.trim_start();
        let (word, rest) = rest
            .split_once(|c: char| c.is_whitespace() || c == '(')
            .map_or((rest, ""), |(word, _)| (word, rest[word.len()..].trim()));
        let is_on = |open: &[Condition]| open.iter().all(|condition| condition.is_on != Some(false));
        let condition = |this: &Self, open: &[Condition]| match is_on(open) {
            true => value(rest, this, 0).map(Number::is_true),
            false => Some(false),
        };
        match word {
            "if" => {
                let is = condition(self, open);
                open.push(Condition { is_on: is, was_on: is });
            }
            "ifdef" | "ifndef" => {
                let is = self.is_defined(rest).map(|is| is == (word == "ifdef"));
                // The guard of an include is off only where it would hide the file.
                let is = if word == "ifndef" && rest.ends_with("_H") { Some(true) } else { is };
                open.push(Condition { is_on: is, was_on: is });
            }
            "elif" => {
                let Some(last) = open.pop() else { return };
                let is = if last.was_on == Some(true) { Some(false) } else { condition(self, open) };
                let was_on = match (last.was_on, is) {
                    (_, Some(true)) => Some(true),
                    (Some(false), Some(false)) => Some(false),
                    (was, _) => was,
                };
                open.push(Condition { is_on: is, was_on });
            }
            "else" => {
                let Some(last) = open.last_mut() else { return };
                last.is_on = last.was_on.map(|was| !was);
            }
            "endif" => drop(open.pop()),
            "define" if is_on(open) => {
                let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
                let (name, value) = rest.split_at(end);
                // A macro with arguments is no setting.
                if !name.is_empty() && !value.starts_with('(') {
                    let is_sure = open.iter().all(|condition| condition.is_on == Some(true));
                    self.define(name, value.trim(), file, line, is_sure);
                }
            }
            "undef" if is_on(open) => {
                for number in self.current.remove(rest).unwrap_or_default() {
                    self.undone.insert(number, line);
                }
            }
            _ => {}
        }
    }

    fn define(&mut self, name: &str, value: &str, file: usize, line: usize, is_sure: bool) {
        let number = self.all.len();
        self.all.push(Define { name: name.to_owned(), value: value.to_owned(), file, line });
        let current = self.current.entry(name.to_owned()).or_default();
        let same = |other: &usize| self.all.get(*other).is_some_and(|other| other.value == value);
        if is_sure && current.iter().all(same) {
            current.clear();
        }
        current.push(number);
    }

    /// The define of a name, unless several disagree.
    pub fn find(&self, name: &str) -> Option<&Define> {
        match self.current.get(name)?[..] {
            [only] => self.all.get(only),
            _ => None,
        }
    }

    /// The line that took a define back.
    pub fn undone(&self, number: usize) -> Option<usize> {
        self.undone.get(&number).copied()
    }

    /// Another define of the same name with another value.
    pub fn rival(&self, define: &Define) -> Option<&Define> {
        let all = self.current.get(&define.name)?.iter().filter_map(|number| self.all.get(*number));
        all.into_iter().find(|other| other.value != define.value)
    }

    /// The number of a name.
    pub fn of(&self, name: &str) -> Option<f64> {
        value(&self.find(name)?.value, self, 0).map(|number| number.value)
    }

    /// Whether a name is switched on.
    pub fn has(&self, name: &str) -> bool {
        self.is_enabled(name) == Some(true)
    }

    /// The numbers of a list, or of one number.
    pub fn list(&self, name: &str) -> Vec<Option<f64>> {
        let Some(define) = self.find(name) else { return Vec::new() };
        let inner = define.value.trim().trim_start_matches('{').trim_end_matches('}');
        let mut parts = vec![String::new()];
        let mut depth = 0;
        for letter in inner.chars() {
            match letter {
                '(' => depth += 1,
                ')' => depth -= 1,
                ',' if depth == 0 => {
                    parts.push(String::new());
                    continue;
                }
                _ => {}
            }
            if let Some(last) = parts.last_mut() {
                last.push(letter);
            }
        }
        parts.iter().map(|part| value(part, self, 0).map(|number| number.value)).collect()
    }

    /// The numbers of a list of pairs.
    pub fn pairs(&self, name: &str) -> Vec<Vec<Option<f64>>> {
        let Some(define) = self.find(name) else { return Vec::new() };
        let inner = define.value.split('{').filter_map(|part| part.split_once('}'));
        let number = |text: &str| value(text, self, 0).map(|number| number.value);
        inner.map(|(pair, _)| pair.split(',').map(number).collect()).collect()
    }

    /// The type of the driver of an axis.
    pub fn driver(&self, axis: &str) -> Option<&str> {
        self.find(&format!("{axis}_DRIVER_TYPE")).map(|define| define.value.as_str())
    }

    /// The middle and the edges of the bed (`Marlin/src/inc/Conditionals-5-post.h`): the middle of a bed is at 0 or
    /// half its size, and half of a whole number is whole in C.
    fn of_bed(&self, name: &str, depth: usize) -> Option<Number> {
        let (axis, of) = name.split_once('_')?;
        if !["X", "Y"].contains(&axis) || !["CENTER", "MIN_BED", "MAX_BED"].contains(&of) {
            return None;
        }
        let size = self.number(&format!("{axis}_BED_SIZE"), depth + 1)?;
        let half = size.over(Number::whole(2.0))?;
        let centred = self.has("BED_CENTER_AT_0_0");
        let (centre, least) = if centred { (0.0, -half.value) } else { (half.value, 0.0) };
        let value = match of {
            "CENTER" => centre,
            "MIN_BED" => least,
            _ => least + size.value,
        };
        Some(Number { value, is_whole: size.is_whole })
    }

    fn has_tmc(&self) -> Option<bool> {
        let is_driver = |name: &&String| name.ends_with("_DRIVER_TYPE");
        let mut drivers = self.current.keys().filter(is_driver).filter_map(|name| self.find(name));
        Some(drivers.any(|driver| driver.value.starts_with("TMC")))
    }
}

impl Names for Defines {
    fn number(&self, name: &str, depth: usize) -> Option<Number> {
        let of = |is: bool| Some(Number::whole(if is { 1.0 } else { 0.0 }));
        match self.current.get(name) {
            Some(_) => {
                let define = self.find(name)?;
                if define.value.is_empty() { None } else { value(&define.value, self, depth) }
            }
            None if self.known.contains(name) => of(false),
            // Names that Marlin derives from settings (`Marlin/src/inc/Conditionals*.h`).
            None => match name {
                "HAS_TRINAMIC_CONFIG" | "HAS_STEALTHCHOP" | "HAS_TMC_UART" => self.has_tmc().and_then(of),
                "HAS_EXTRUDERS" | "HAS_HOTEND" | "HAS_E_TEMP_SENSOR" => of(self.of("EXTRUDERS")? > 0.0),
                "HAS_MULTI_EXTRUDER" | "HAS_MULTI_HOTEND" => of(self.of("EXTRUDERS")? > 1.0),
                "HOTENDS" | "E_STEPPERS" => self.of("EXTRUDERS").map(Number::whole),
                "HAS_HEATED_BED" => of(self.of("TEMP_SENSOR_BED")? != 0.0),
                "HAS_X_AXIS" | "HAS_Y_AXIS" | "HAS_Z_AXIS" => of(true),
                "HAS_CLASSIC_JERK" => of(self.has("CLASSIC_JERK")),
                "HAS_JUNCTION_DEVIATION" => of(!self.has("CLASSIC_JERK")),
                _ => self.of_bed(name, depth),
            },
        }
    }

    fn is_defined(&self, name: &str) -> Option<bool> {
        match (self.current.contains_key(name), self.known.contains(name)) {
            (true, _) => Some(true),
            (false, true) => Some(false),
            (false, false) => None,
        }
    }

    fn is_enabled(&self, name: &str) -> Option<bool> {
        match (self.current.get(name), self.known.contains(name)) {
            (Some(_), _) => {
                let value = self.find(name)?.value.as_str();
                Some(value.is_empty() || value == "1" || value == "true")
            }
            (None, true) => Some(false),
            (None, false) => self.number(name, 0).map(Number::is_true),
        }
    }

    fn is_of_driver(&self, macro_name: &str, axis: &str) -> Option<bool> {
        if !macro_name.starts_with("AXIS_") && !macro_name.starts_with("HAS_") {
            return None;
        }
        let driver = self.driver(axis).unwrap_or_default();
        match macro_name {
            "AXIS_IS_TMC" | "AXIS_IS_TMC_CONFIG" | "AXIS_HAS_UART" => Some(driver.starts_with("TMC")),
            "HAS_DRIVER" => {
                let mut names = self.current.keys().filter(|name| name.ends_with("_DRIVER_TYPE"));
                Some(names.any(|name| self.find(name).is_some_and(|define| define.value == axis)))
            }
            _ => None,
        }
    }
}

/// A line without its comments.
fn without_comments(line: &str, is_comment: &mut bool) -> String {
    let (mut kept, mut letters, mut is_text) = (String::new(), line.chars().peekable(), false);
    while let Some(letter) = letters.next() {
        let next = letters.peek().copied();
        match (letter, next) {
            ('*', Some('/')) if *is_comment => {
                letters.next();
                *is_comment = false;
            }
            _ if *is_comment => {}
            ('"', _) => {
                is_text = !is_text;
                kept.push(letter);
            }
            ('/', Some('/')) if !is_text => break,
            ('/', Some('*')) if !is_text => {
                letters.next();
                *is_comment = true;
            }
            _ => kept.push(letter),
        }
    }
    kept
}
