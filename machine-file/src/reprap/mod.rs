//! RepRapFirmware's `config.g` as a machine file, with a verdict on every word.
//!
//! | file | job |
//! |---|---|
//! | `lines` | a text to commands and their words |
//! | `words` | its commands as words of Marlin: other units, and other names |
//! | `parts` | parts without a word of Marlin: sensors, switches, the probe, heaters |
//! | `tables` | remarks on the rest |
//!
//! RepRapFirmware has speeds in mm/min where Marlin has mm/s (M203, M566), and peak currents where a machine file has
//! root mean squares (M906).

mod lines;
mod parts;
mod tables;
mod words;

use crate::marlin::source::{Item, Source};
use crate::marlin::work::Work;
use crate::marlin::{Given, parts as of_words};
use crate::translation::{Kind, Translation, Verdict};
use corehbot::connectors::BoardConnectors;
use lines::Command;

/// Whether a text is a `config.g`: it maps drivers, kinematics or switches as only this firmware does.
#[must_use]
pub fn is_config(text: &str) -> bool {
    let commands = lines::read(text);
    let has = |code: &str, letters: &[char]| {
        let is = |command: &Command| command.code == code && letters.iter().any(|letter| command.has(*letter));
        commands.iter().any(is)
    };
    let is_other = text.lines().any(|line| line.starts_with('[') && line.trim_end().ends_with(']'));
    !is_other && (has("M584", &['X', 'Y', 'Z', 'E']) || has("M569", &['P']) || has("M574", &['X', 'Y', 'Z']))
}

/// Translates a text; `name` is the file.
#[must_use]
pub fn translate(name: &str, text: &str, given: Given) -> Translation {
    let commands = lines::read(text);
    let mut source = Source::of(vec![name.to_owned()]);
    for command in &commands {
        for word in &command.words {
            let key = format!("{}{}", command.chosen, word.letter);
            source.item(Item {
                section: command.code.clone(),
                key,
                value: word.value.clone(),
                file: 0,
                line: command.line,
            });
        }
    }
    words::words(&commands, &mut source);
    let (said, places) = (source.said(), source.places());
    let mut work = Work::of(&said, places);
    let parts = parts::Parts::of(&commands);
    parts.before(&mut work);
    of_words(&mut work, given);
    parts.after(&mut work);
    if given.board.is_none() {
        // Its pins have the names of Duet's boards, or of a board's own table.
        let text = "--board names the board that the machine gets: pins have other names here".to_owned();
        work.notes.push(Verdict::new(Kind::Approximated, text));
    }
    let board = given.board.unwrap_or(&BoardConnectors::ANY);
    source.translation(&work, board, "config.g", |item| tables::other(&item.section, &item.key))
}
