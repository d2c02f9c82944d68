//! Plain settings: those of rows with a [`SettingLine`], by the M-code that sets them. And the conditions of some
//! codes.

use super::Settings;
use super::line::SettingLine;
use super::rows::{Field, Key, Visitor};
use super::table::ALL;

/// The part of the firmware that must be told of new values.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Owner {
    /// None: the next move, message or check reads them while others wait.
    Readers,
    /// Every part that knows the size of a step. Motion rests first.
    Motors,
    /// The heater control, which has a copy.
    Heaters,
    /// The program's zero, which moves with it.
    Origins,
    /// The place of z and of the mesh. Motion rests first.
    Probe,
}

/// What a code needs that its rows do not say. `machine::setup::rules` has the rules of codes.
#[derive(Clone, Copy, Debug)]
pub struct Condition {
    /// The number of the code.
    pub code: u16,
    /// Who gets its values.
    pub owner: Owner,
    /// Letters with a number that belong to its rule and to no row.
    pub beside: &'static [&'static str],
    /// Whether `gcode` has a row for it: its words are not those of all plain codes.
    pub has_words: bool,
}

impl Condition {
    /// None.
    const fn none(code: u16) -> Self {
        Self { code, owner: Owner::Readers, beside: &[], has_words: false }
    }
}

/// The codes with a condition.
pub const CONDITIONS: &[Condition] = &[
    Condition { owner: Owner::Motors, ..Condition::none(92) },
    Condition { owner: Owner::Origins, ..Condition::none(206) },
    Condition { owner: Owner::Probe, ..Condition::none(851) },
    // A letter chooses the rule for corners; B is Marlin's.
    Condition { beside: &["X", "Y", "J", "B"], has_words: true, ..Condition::none(205) },
    Condition { owner: Owner::Heaters, has_words: true, ..Condition::none(301) },
    Condition { owner: Owner::Heaters, has_words: true, ..Condition::none(304) },
];

/// The condition of a code.
#[must_use]
pub const fn condition(code: u16) -> Condition {
    let mut conditions = CONDITIONS;
    while let [first, others @ ..] = conditions {
        if first.code == code {
            return *first;
        }
        conditions = others;
    }
    Condition::none(code)
}

/// The number of lines.
const COUNT: usize = {
    let (mut count, mut files) = (0, ALL);
    while let [file, other_files @ ..] = files {
        let mut rows = file.rows;
        while let [row, others @ ..] = rows {
            count += row.lines.len();
            rows = others;
        }
        files = other_files;
    }
    count
};

/// The lines of all rows.
const LINES: [&SettingLine; COUNT] = {
    let mut all = [&SettingLine::NONE; COUNT];
    let (mut count, mut files) = (0, ALL);
    while let [file, other_files @ ..] = files {
        let mut rows = file.rows;
        while let [row, others @ ..] = rows {
            let mut lines = *row.lines;
            while let [line, next @ ..] = lines {
                all[count] = line;
                count += 1;
                lines = next;
            }
            rows = others;
        }
        files = other_files;
    }
    all
};

/// The most words of a code.
pub const MOST_WORDS: usize = {
    let (mut most, mut lines) = (0, LINES.as_slice());
    while let [first, others @ ..] = lines {
        let (mut words, mut of_code) = (condition(first.number).beside.len(), lines);
        while let [line, others @ ..] = of_code {
            words += if line.number == first.number { line.letters.len() } else { 0 };
            of_code = others;
        }
        most = if words > most { words } else { most };
        lines = others;
    }
    most
};

/// The codes with lines of that kind, and how many they are.
const fn codes(which: Which) -> ([u16; COUNT], usize) {
    let (mut codes, mut count, mut lines) = ([0; COUNT], 0, LINES.as_slice());
    while let [line, others @ ..] = lines {
        let is_wanted = match which {
            Which::All => true,
            Which::Machine => !line.is_of_axes() && !condition(line.number).has_words,
            Which::Axes => line.is_of_axes() && !condition(line.number).has_words,
        };
        if is_wanted && !holds(codes.split_at(count).0, line.number) {
            codes[count] = line.number;
            count += 1;
        }
        lines = others;
    }
    (codes, count)
}

/// Which codes.
#[derive(Clone, Copy)]
enum Which {
    All,
    Machine,
    Axes,
}

const fn holds(mut codes: &[u16], number: u16) -> bool {
    while let [code, others @ ..] = codes {
        if *code == number {
            return true;
        }
        codes = others;
    }
    false
}

const EVERY: ([u16; COUNT], usize) = codes(Which::All);
const OF_MACHINE: ([u16; COUNT], usize) = codes(Which::Machine);
const OF_AXES: ([u16; COUNT], usize) = codes(Which::Axes);

/// The M-codes that set plain settings.
pub const CODES: &[u16] = EVERY.0.split_at(EVERY.1).0;

/// Of these, the ones with a letter for each setting of the machine and no other words.
pub const MACHINE_CODES: &[u16] = OF_MACHINE.0.split_at(OF_MACHINE.1).0;

/// Of these, the ones with a letter for each axis.
pub const AXIS_CODES: &[u16] = OF_AXES.0.split_at(OF_AXES.1).0;

/// The letters of a code: for each setting its own and older ones, then those of its rule.
pub fn letters(number: u16) -> impl Iterator<Item = &'static str> {
    let of_rows = LINES.iter().filter(move |line| line.number == number).flat_map(|line| line.letters);
    of_rows.chain(condition(number).beside).copied()
}

/// Whether it is a letter of a code.
#[must_use]
pub fn has_letter(number: u16, letter: u8) -> bool {
    let is_in = |letters: &[&str]| letters.iter().any(|letters| letters.as_bytes().contains(&letter));
    is_in(condition(number).beside) || LINES.iter().any(|line| line.number == number && is_in(line.letters))
}

/// A word of a line, and the setting that it sets.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// Its place among the [`letters`] of its code.
    pub place: usize,
    /// The line.
    pub line: &'static SettingLine,
    /// Its letters there: its own, and after `/` an older one.
    pub letters: &'static str,
    /// The setting.
    pub key: Key,
}

impl Word {
    /// The letter that names it in messages.
    #[must_use]
    pub fn letter(&self) -> &'static str {
        self.letters.get(..1).unwrap_or_default()
    }
}

/// Shows the settings of a code to a function.
struct OfCode<'a> {
    number: u16,
    place: usize,
    show: &'a mut dyn FnMut(Word, &mut dyn Field),
}

impl Visitor for OfCode<'_> {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        let of_part = key.row.line(key.part);
        if let Some((line, letters)) = of_part.filter(|(line, _)| line.number == self.number) {
            (self.show)(Word { place: self.place, line, letters, key }, field);
            self.place += 1;
        }
    }
}

impl Settings {
    /// Shows every plain setting of a code, which may be changed.
    pub fn visit_code(&mut self, number: u16, show: &mut dyn FnMut(Word, &mut dyn Field)) {
        self.visit(&mut OfCode { number, place: 0, show });
    }
}
