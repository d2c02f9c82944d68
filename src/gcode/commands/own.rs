//! Rows of another room's own table. That room has all of a command in one file, from its words to its effect.
//!
//! `parse_with` looks for a code or name there if no row of this room has it. Such a command is its row and the text of
//! its words, which is in order: the command reads its words by the methods of [`OwnCommand`].

use super::Command;
use super::grammar::{Grammar, Letters, in_order};
use super::row::{Begin, Text, Treatment};
use super::table::Line;
use crate::gcode::axes::axis_words;
use crate::gcode::code::Code;
use crate::gcode::lexer::{has, number, switch};
use crate::gcode::number::Number;
use crate::gcode::parts::AxisWords;

/// What a command is for a print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Nature {
    /// It changes nothing. It is carried out in any state of a print.
    Report,
    /// It changes something that is no part of the program, as the user or a host may at any time.
    Aside,
    /// It changes how later lines of the program are carried out.
    Mode,
    /// It moves, heats or waits. It is refused after the firmware has ended a print.
    Work,
    /// It sets the target of a heater by S or R, and is `Work` if that is above 0. It is carried out in any other case.
    Heat,
    /// It is `Work` with T, and `Aside` without.
    WorkWithT,
}

/// The part of a row that the firmware needs.
#[derive(Clone, Copy, Debug)]
pub struct OwnRow {
    begin: Begin,
    grammar: Option<&'static Grammar>,
    letters: Letters,
    nature: Nature,
    is_said_on_connecting: bool,
}

/// A line and its answers before the `ok`. An asterisk at the end of an answer stands for anything.
pub type Example = (&'static str, &'static [&'static str]);

/// A whole row. The firmware's table is made of these before it runs, and has neither texts nor examples.
#[derive(Clone, Copy, Debug)]
pub struct OwnEntry {
    row: OwnRow,
    family: &'static str,
    text: Text,
    examples: &'static [Example],
}

impl OwnEntry {
    const fn new(family: &'static str, begin: Begin) -> Self {
        let text = Text { treatment: Treatment::CarriedOut, words: "", does: "" };
        let (nature, is_said_on_connecting) = (Nature::Aside, false);
        let row = OwnRow { begin, grammar: None, letters: Letters::NONE, nature, is_said_on_connecting };
        Self { row, family, text, examples: &[] }
    }

    /// G-codes of the family with this heading in docs/reference/gcode.md.
    #[must_use]
    pub const fn g(family: &'static str, numbers: &'static [u16]) -> Self {
        Self::new(family, Begin::Code(b'G', numbers))
    }

    /// M-codes of the family with this heading in docs/reference/gcode.md.
    #[must_use]
    pub const fn m(family: &'static str, numbers: &'static [u16]) -> Self {
        Self::new(family, Begin::Code(b'M', numbers))
    }

    /// Names of the family with this heading in docs/reference/gcode.md.
    #[must_use]
    pub const fn name(family: &'static str, names: &'static [&'static str]) -> Self {
        Self::new(family, Begin::Name(names))
    }

    /// What it is for a print, if it is more than [`Nature::Aside`].
    #[must_use]
    pub const fn nature(mut self, nature: Nature) -> Self {
        self.row.nature = nature;
        self
    }

    /// Hosts send it to a stopped machine when they connect, and nothing is missing on the plate without it.
    #[must_use]
    pub const fn said_on_connecting(mut self) -> Self {
        self.row.is_said_on_connecting = true;
        self
    }

    /// It takes words alone, and refuses lines that are not in order. Without a grammar it takes any text.
    #[must_use]
    pub const fn grammar(mut self, grammar: &'static Grammar) -> Self {
        self.row.grammar = Some(grammar);
        self
    }

    /// Its words, and what it does, for docs/reference/gcode.md. Other letters than these are ignored.
    #[must_use]
    pub const fn does(mut self, words: &'static str, does: &'static str) -> Self {
        self.row.letters = self.row.letters.with(words.as_bytes());
        self.text.words = words;
        self.text.does = does;
        self
    }

    /// Lines with their answers, for a homed machine that has neither heaters nor a probe nor storage.
    #[must_use]
    pub const fn examples(mut self, examples: &'static [Example]) -> Self {
        self.examples = examples;
        self
    }

    /// Lines with their answers.
    pub fn its_examples(&self) -> impl Iterator<Item = Example> {
        self.examples.iter().copied()
    }

    /// The part that the firmware needs.
    #[must_use]
    pub const fn row(&self) -> OwnRow {
        self.row
    }

    /// The letter and numbers of its codes, and its names.
    pub(super) fn begin(&self) -> ((char, &'static [u16]), &'static [&'static str]) {
        self.row.begin.parts()
    }

    /// The row for people.
    pub fn line(&'static self) -> Line {
        let (codes, names) = self.begin();
        Line { family: self.family, codes, names, text: &self.text }
    }
}

/// A command of another room's table.
#[derive(Clone, Copy, Debug)]
pub struct OwnCommand<'a> {
    row: &'static OwnRow,
    place: usize,
    code: u16,
    text: &'a [u8],
}

impl<'a> OwnCommand<'a> {
    /// The place of its row in the table.
    #[must_use]
    pub const fn place(&self) -> usize {
        self.place
    }

    /// The number of its code; 0 for a name.
    #[must_use]
    pub const fn code(&self) -> u16 {
        self.code
    }

    /// What it is for a print.
    #[must_use]
    pub const fn nature(&self) -> Nature {
        self.row.nature
    }

    /// Whether hosts send it when they connect, and nothing is missing on the plate without it.
    #[must_use]
    pub const fn is_said_on_connecting(&self) -> bool {
        self.row.is_said_on_connecting
    }

    /// The number of a letter.
    #[must_use]
    pub fn number(&self, letter: u8) -> Option<Number> {
        number(self.text, letter)
    }

    /// Whether there is such a letter, with a number or without one.
    #[must_use]
    pub fn has(&self, letter: u8) -> bool {
        has(self.text, letter)
    }

    /// The switch in S: S0 is off, any other S is on.
    #[must_use]
    pub fn switch(&self) -> Option<bool> {
        switch(self.text)
    }

    /// The numbers of the axes.
    #[must_use]
    pub fn axes(&self) -> AxisWords {
        axis_words(self.text)
    }

    /// All that follows the code or name.
    #[must_use]
    pub const fn text(&self) -> &'a [u8] {
        self.text
    }
}

/// Two lines are the same command if the letters that it knows have the same numbers. The part that a line is for is
/// the same in each.
impl PartialEq for OwnCommand<'_> {
    fn eq(&self, other: &Self) -> bool {
        let word = |text, letter| (has(text, letter), number(text, letter));
        let selects = |letter| self.row.grammar.is_some_and(|grammar| grammar.selects(letter));
        let mut letters = (b'A'..=b'Z').filter(|letter| self.row.letters.has(*letter) && !selects(*letter));
        (self.place, self.code) == (other.place, other.code)
            && letters.all(|letter| word(self.text, letter) == word(other.text, letter))
    }
}

impl Eq for OwnCommand<'_> {}

/// The command of a name in such a table, with the text behind it.
pub(in crate::gcode) fn own_of_name<'a>(rows: &'static [OwnRow], name: &[u8], text: &'a [u8]) -> Option<Command<'a>> {
    let place = rows.iter().position(|row| row.begin.is_name(name))?;
    Some(Command::Own(OwnCommand { row: rows.get(place)?, place, code: 0, text }))
}

/// The command of a code in such a table.
pub(in crate::gcode) fn own_of_code<'a>(rows: &'static [OwnRow], code: Code, text: &'a [u8]) -> Option<Command<'a>> {
    let place = rows.iter().position(|row| row.begin.is_code(code, row.letters))?;
    let row = rows.get(place)?;
    let command = Command::Own(OwnCommand { row, place, code: code.number, text });
    Some(match row.grammar {
        Some(grammar) => in_order(command, grammar, row.letters, code, text),
        None => command,
    })
}
