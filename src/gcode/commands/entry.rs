//! Entries: rows of the machine's table of commands. A file there has all of a command, from its words to its effect.
//!
//! A command is its row and the text of its words, which is in order: it reads them by the methods of [`TableCommand`].

use super::Command;
use super::grammar::{Grammar, Letters, in_order};
use super::row::{Begin, Text, Treatment};
use crate::gcode::axes::{axis_flags, axis_words};
use crate::gcode::code::Code;
use crate::gcode::lexer::{Words, has, is_outside, number, numbers, skip_blanks, switch};
use crate::gcode::number::Number;
use crate::gcode::parts::{AxisFlags, AxisWords, Flaw};
use crate::text::trim_end;

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
    /// It is `Work`, and later lines of the program go on from where it ends, as after a move.
    Move,
}

/// What a row says of its command, each yes or no.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Mark {
    /// Hosts send it to a stopped machine when they connect, and nothing is missing on the plate without it.
    SaidOnConnecting,
    /// It is carried out on a stopped machine, too.
    AnsweredWhenStopped,
    /// It acts between M28 and M29, where other lines are a file.
    ActsInUpload,
    /// A line that is too long and came cut is carried out all the same.
    MayBeCut,
    /// Motion rests before it.
    AfterRest,
    /// It is refused if there is no probe.
    NeedsProbe,
    /// It finds out about the bed: a print cannot go on without it.
    FindsBed,
}

/// Marks, as the bits of a number.
#[derive(Clone, Copy, Debug)]
struct Marks(u8);

impl Marks {
    const fn has(self, mark: Mark) -> bool {
        self.0 & 1 << mark as u8 != 0
    }
}

/// What a line is, besides what its grammar says.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verdict<'a> {
    /// The command.
    InOrder,
    /// Nothing but `ok` is to be said.
    Silent,
    /// Another firmware's, which this one does not know.
    Unknown,
    /// A condition: the job ends.
    Condition,
    /// Its words are not in order.
    Flawed(Flaw<'a>),
}

impl<'a> From<Option<Flaw<'a>>> for Verdict<'a> {
    fn from(flaw: Option<Flaw<'a>>) -> Self {
        flaw.map_or(Self::InOrder, Self::Flawed)
    }
}

/// Judges the words behind a code with that number, or behind a name (0).
type Judge = for<'a> fn(u16, &'a [u8]) -> Verdict<'a>;

/// Whether a line is [`Nature::Work`].
type IsWork = fn(&TableCommand<'_>) -> bool;

/// The part of a row that the firmware needs.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    begin: Begin,
    grammar: Option<&'static Grammar>,
    judge: Option<Judge>,
    is_work: Option<IsWork>,
    letters: Letters,
    nature: Nature,
    marks: Marks,
}

/// A line and its answers before the `ok`. An asterisk at the end of an answer stands for anything.
pub type Example = (&'static str, &'static [&'static str]);

/// A whole row. The firmware's table is made of these before it runs, and has neither texts nor examples.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    row: Row,
    family: &'static str,
    text: Text,
    examples: &'static [Example],
}

impl Entry {
    const fn new(family: &'static str, begin: Begin) -> Self {
        let text = Text { treatment: Treatment::CarriedOut, words: "", does: "" };
        let (letters, nature, marks) = (Letters::NONE, Nature::Aside, Marks(0));
        let row = Row { begin, grammar: None, judge: None, is_work: None, letters, nature, marks };
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

    /// A tool: T with any number.
    #[must_use]
    pub const fn t(family: &'static str) -> Self {
        Self::new(family, Begin::Code(b'T', &[0]))
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

    /// It is [`Nature::Work`] if that is so, and of its nature otherwise.
    #[must_use]
    pub const fn works_if(mut self, is_work: IsWork) -> Self {
        self.row.is_work = Some(is_work);
        self
    }

    /// This is so of it, too.
    #[must_use]
    pub const fn mark(mut self, mark: Mark) -> Self {
        self.row.marks.0 |= 1 << mark as u8;
        self
    }

    /// Its words are judged, after its grammar.
    #[must_use]
    pub const fn judge(mut self, judge: Judge) -> Self {
        self.row.judge = Some(judge);
        self
    }

    /// A subcode (`M862.3`) makes no difference; elsewhere it makes another command.
    #[must_use]
    pub const fn with_subcodes(mut self) -> Self {
        self.row.letters = self.row.letters.with_subcodes();
        self
    }

    /// It is answered `ok`, and nothing is done, for this reason.
    #[must_use]
    pub const fn silently(mut self, why: &'static str) -> Self {
        self.text.treatment = Treatment::Silent;
        self.judge(|_, _| Verdict::Silent).does("", why)
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

    /// It ends the job, and is answered so.
    #[must_use]
    pub const fn refused(self, answer: &'static str) -> Self {
        let mut entry = self.judge(|_, _| Verdict::Condition).does("", answer);
        entry.text.treatment = Treatment::Refused;
        entry
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
    pub const fn row(&self) -> Row {
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

/// A row for people: its family, its codes with their letter, its names, and its texts.
pub struct Line {
    /// The heading of its family.
    pub family: &'static str,
    /// The letter and the numbers of its codes.
    pub codes: (char, &'static [u16]),
    /// Its names.
    pub names: &'static [&'static str],
    /// Its texts.
    pub text: &'static Text,
}

/// A command of the table.
#[derive(Clone, Copy, Debug)]
pub struct TableCommand<'a> {
    row: &'static Row,
    place: usize,
    code: u16,
    text: &'a [u8],
}

impl<'a> TableCommand<'a> {
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

    /// Whether it is that code.
    #[must_use]
    pub fn is(&self, letter: char, number: u16) -> bool {
        self.code == number && self.row.begin.parts().0.0 == letter
    }

    /// Whether it is that name.
    #[must_use]
    pub fn is_named(&self, name: &str) -> bool {
        self.row.begin.parts().1.contains(&name)
    }

    /// What it is for a print.
    #[must_use]
    pub fn nature(&self) -> Nature {
        if self.row.is_work.is_some_and(|is_work| is_work(self)) { Nature::Work } else { self.row.nature }
    }

    /// Whether it changes how later lines of the program are carried out.
    #[must_use]
    pub const fn is_of_program(&self) -> bool {
        matches!(self.row.nature, Nature::Mode | Nature::Move)
    }

    /// Whether its row says so.
    #[must_use]
    pub const fn has_mark(&self, mark: Mark) -> bool {
        self.row.marks.has(mark)
    }

    /// The number of a letter.
    #[must_use]
    pub fn number(&self, letter: u8) -> Option<Number> {
        number(self.text, letter)
    }

    /// The numbers of letters.
    #[must_use]
    pub fn numbers<const N: usize>(&self, letters: &[u8; N]) -> [Option<Number>; N] {
        numbers(self.text, letters)
    }

    /// Its words, one after the other.
    #[must_use]
    pub const fn words(&self) -> Words<'a> {
        Words::new(self.text)
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

    /// The axes that are named, with a number or without one.
    #[must_use]
    pub fn flags(&self) -> AxisFlags {
        axis_flags(self.text)
    }

    /// Whether its words are a text, and not letters with numbers.
    #[must_use]
    pub const fn takes_text(&self) -> bool {
        self.row.grammar.is_none()
    }

    /// All that follows the code or name.
    #[must_use]
    pub const fn text(&self) -> &'a [u8] {
        self.text
    }

    /// The same without the blanks and line ends around it: a name.
    #[must_use]
    pub fn trimmed(&self) -> &'a [u8] {
        trim_end(skip_blanks(self.text), is_outside)
    }
}

/// Two lines are the same command if the letters that it knows have the same numbers. The part that a line is for is
/// the same in each. Those of a name have the same text behind it.
impl PartialEq for TableCommand<'_> {
    fn eq(&self, other: &Self) -> bool {
        if (self.place, self.code) != (other.place, other.code) {
            return false;
        }
        if let Begin::Name(_) = self.row.begin {
            return self.text == other.text;
        }
        let selects = |letter| self.row.grammar.is_some_and(|grammar| grammar.selects(letter));
        let word = |text, letter| (has(text, letter), number(text, letter));
        let mut letters = (b'A'..=b'Z').filter(|letter| self.row.letters.has(*letter) && !selects(*letter));
        letters.all(|letter| word(self.text, letter) == word(other.text, letter))
    }
}

impl Eq for TableCommand<'_> {}

/// The command of a name, with the text behind it.
pub(in crate::gcode) fn of_name<'a>(rows: &'static [Row], name: &[u8], text: &'a [u8]) -> Option<Command<'a>> {
    let place = rows.iter().position(|row| row.begin.is_name(name))?;
    judged(rows, place, None, text)
}

/// The command of a code.
pub(in crate::gcode) fn of_code<'a>(rows: &'static [Row], code: Code, text: &'a [u8]) -> Option<Command<'a>> {
    let place = rows.iter().position(|row| row.begin.is_code(code, row.letters))?;
    judged(rows, place, Some(code), text)
}

/// The command of a row, if its words are in order. `None` if the whole line is unknown.
fn judged<'a>(rows: &'static [Row], place: usize, code: Option<Code>, text: &'a [u8]) -> Option<Command<'a>> {
    let row = rows.get(place)?;
    let number = code.map_or(0, |code| code.number);
    let command = TableCommand { row, place, code: number, text };
    let command = match row.judge.map_or(Verdict::InOrder, |judge| judge(number, text)) {
        Verdict::InOrder => Command::Table(command),
        Verdict::Silent => Command::Silent,
        Verdict::Condition => Command::Condition,
        Verdict::Unknown => return None,
        Verdict::Flawed(flaw) => Command::Malformed(flaw),
    };
    Some(match (row.grammar, code) {
        (Some(grammar), Some(code)) => in_order(command, grammar, row.letters, code, text),
        _ => command,
    })
}
