//! Plain settings: those of rows with a [`Line`], by the M-code that sets them.

use super::Settings;
use super::line::Line;
use super::rows::{Field, Key, Visitor};
use super::table::ALL;

/// The number of rows with a line.
const COUNT: usize = {
    let (mut count, mut files) = (0, ALL);
    while let [file, other_files @ ..] = files {
        let mut rows = file.rows;
        while let [row, others @ ..] = rows {
            count += row.line.is_some() as usize;
            rows = others;
        }
        files = other_files;
    }
    count
};

/// The lines of all rows, one for each row.
const LINES: [&Line; COUNT] = {
    let mut lines = [&Line::NONE; COUNT];
    let (mut count, mut files) = (0, ALL);
    while let [file, other_files @ ..] = files {
        let mut rows = file.rows;
        while let [row, others @ ..] = rows {
            if let Some(line) = row.line {
                lines[count] = line;
                count += 1;
            }
            rows = others;
        }
        files = other_files;
    }
    lines
};

/// The most words of a code.
pub const MOST_WORDS: usize = {
    let (mut most, mut lines) = (0, LINES.as_slice());
    while let [first, others @ ..] = lines {
        let (mut words, mut of_code) = (0, lines);
        while let [line, others @ ..] = of_code {
            words += if line.number == first.number { line.letters.len() } else { 0 };
            of_code = others;
        }
        most = if words > most { words } else { most };
        lines = others;
    }
    most
};

/// The codes of the machine or of its axes, and how many they are.
const fn codes(of_axes: bool) -> ([u16; COUNT], usize) {
    let (mut codes, mut count, mut lines) = ([0; COUNT], 0, LINES.as_slice());
    while let [line, others @ ..] = lines {
        if line.is_of_axes() == of_axes && !holds(codes.split_at(count).0, line.number) {
            codes[count] = line.number;
            count += 1;
        }
        lines = others;
    }
    (codes, count)
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

const OF_MACHINE: ([u16; COUNT], usize) = codes(false);
const OF_AXES: ([u16; COUNT], usize) = codes(true);

/// The M-codes that set plain settings of the machine.
pub const MACHINE_CODES: &[u16] = OF_MACHINE.0.split_at(OF_MACHINE.1).0;

/// The M-codes that set plain settings of each axis.
pub const AXIS_CODES: &[u16] = OF_AXES.0.split_at(OF_AXES.1).0;

/// The letters of a code, for each setting its own and older ones.
pub fn letters(number: u16) -> impl Iterator<Item = &'static str> {
    LINES.iter().filter(move |line| line.number == number).flat_map(|line| line.letters).copied()
}

/// A word of a line, and the setting that it sets.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// Its place among the [`letters`] of its code.
    pub place: usize,
    /// The line.
    pub line: &'static Line,
    /// The setting.
    pub key: Key,
}

/// Shows the settings of a code to a function.
struct OfCode<'a> {
    number: u16,
    place: usize,
    show: &'a mut dyn FnMut(Word, &mut dyn Field),
}

impl Visitor for OfCode<'_> {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        if let Some(line) = key.row.line.filter(|line| line.number == self.number) {
            (self.show)(Word { place: self.place, line, key }, field);
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
