//! Program: the speed that the lines of a file command, followed line by line.
//!
//! The planner knows the speed that a move may have, but not always why. So the speed is read from the file again, with
//! the words that change it: F, G20, G21 and M220.

use super::Source;
use super::rules::Rules;
use crate::file_line::words;
use corehbot::settings::Settings;

/// mm an inch.
const INCH: f64 = 25.4;

/// The feed before the first F in mm/s, as the firmware has it (`Modal::new`).
const FIRST_FEED: f64 = 50.0;

/// Feed overrides that the firmware accepts, in percent (M220).
const PERCENT: [f64; 2] = [10.0, 999.0];

/// The modal state of the lines so far.
pub(super) struct Program {
    line: u32,
    kind: u16,
    /// mm in the unit of lines.
    unit: f64,
    /// In mm/s, before the override.
    feed: f64,
    percent: f64,
    /// M220 B.
    kept_percent: f64,
    /// Whether the present line moves at its feed.
    has_feed: bool,
    /// The rules that were in force, each once, and the present one.
    rules: Vec<Rules>,
    present: usize,
}

/// So many rules are told apart. A slicer uses some acceleration for each type of line.
const MOST_RULES: usize = 1000;

impl Program {
    pub fn new(settings: &Settings) -> Self {
        Self {
            rules: vec![Rules::new(settings)],
            present: 0,
            line: 0,
            kind: crate::slicer::UNNAMED,
            unit: 1.0,
            feed: FIRST_FEED,
            percent: 100.0,
            kept_percent: 100.0,
            has_feed: false,
        }
    }

    /// The next line is sent.
    pub fn read(&mut self, line: u32, kind: u16, command: &str) {
        (self.line, self.kind) = (line, kind);
        let mut words = words(command);
        let code = words.next();
        self.has_feed = matches!(code, Some(('G', Some(0.0..=3.0))));
        if !self.has_feed {
            self.follow_rules(command);
        }
        let Some((letter, Some(code))) = code else { return };
        let mut word = |wanted: char| words.by_ref().find(|(letter, _)| *letter == wanted);
        match (letter, code) {
            ('G', 0.0..=3.0) => {
                if let Some((_, Some(feed))) = word('F')
                    && feed > 0.0
                {
                    self.feed = feed * self.unit / 60.0;
                }
            }
            ('G', 20.0) => self.unit = INCH,
            ('G', 21.0) => self.unit = 1.0,
            ('M', 220.0) => self.override_feed(command),
            _ => {}
        }
    }

    fn follow_rules(&mut self, command: &str) {
        let Some(mut rules) = self.rules.get(self.present).copied() else { return };
        rules.read(command, self.unit);
        let known = self.rules.iter().position(|known| *known == rules);
        if known.is_none() && self.rules.len() < MOST_RULES {
            self.rules.push(rules);
        }
        self.present = known.unwrap_or(self.rules.len() - 1);
    }

    /// The rules of a move.
    pub fn rules(&self, source: &Source) -> &Rules {
        // The first are always there.
        self.rules.get(usize::from(source.rules)).unwrap_or(&self.rules[0])
    }

    fn override_feed(&mut self, command: &str) {
        let word = |wanted: char| words(command).find(|(letter, _)| *letter == wanted);
        if word('B').is_some() {
            self.kept_percent = self.percent;
        } else if word('R').is_some() {
            self.percent = self.kept_percent;
        } else if let Some((_, Some(percent))) = word('S') {
            self.percent = percent.clamp(PERCENT[0], PERCENT[1]);
        }
    }

    /// Why a move is planned now.
    pub fn source(&self) -> Source {
        let feed = self.has_feed.then_some(self.feed);
        Source { line: self.line, kind: self.kind, feed, rules: self.present as u16 }
    }

    /// The feed override in force, of 1.
    pub const fn share(&self) -> f64 {
        self.percent / 100.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_feed_stays_until_the_next_and_has_the_unit_of_its_line() {
        let mut program = Program::new(&Settings::prototype());
        let mut feed = |command: &str| {
            program.read(1, 0, command);
            program.source().feed.map(|feed| feed * program.share())
        };
        assert_eq!(feed("G1 X5"), Some(50.0));
        assert_eq!(feed("G1 X5 F600"), Some(10.0));
        assert_eq!(feed("G28"), None);
        assert_eq!(feed("G2 X1 Y1 I2 J2"), Some(10.0));
        assert_eq!(feed("M220 S50"), None);
        assert_eq!(feed("G0 X9"), Some(5.0));
        assert_eq!(feed("G20"), None);
        assert_eq!(feed("G1 X1 F60"), Some(12.7));
        assert_eq!(feed("G21"), None);
        assert_eq!(feed("M220 B"), None);
        assert_eq!(feed("M220 S100"), None);
        assert_eq!(feed("G1 X1 F60"), Some(1.0));
        assert_eq!(feed("M220 R"), None);
        assert_eq!(feed("G1 X2 F0"), Some(0.5));
    }
}
