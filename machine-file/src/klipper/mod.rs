//! Klipper: its configuration as a machine file, with a verdict on every key.
//!
//! Nothing here opens a file: [`Files`] does, and the command has one.
//!
//! | file | job |
//! |---|---|
//! | `config` | texts to sections and keys |
//! | `pin`, `board` | pins to connectors |
//! | `work` | the translation so far |
//! | `motors`, `axes`, `heat`, `probe`, `bed` | one part of a machine each |
//! | `tables` | keys that are one number, and remarks on the rest |
//! | `report` | what became of every key |
//!
//! The report goes through all keys of the configuration. So a key that no part knows has a verdict too.

mod axes;
mod bed;
mod board;
mod config;
mod heat;
mod motors;
mod pin;
mod probe;
mod report;
mod tables;
mod work;

pub use crate::pattern::{is_pattern, matches};
pub use crate::translation::{Kind, Report, Translation, Verdict};
use board::Pins;
pub use config::{At, Config, Entry, Files, Mistake, Section};
use corehbot::connectors::BoardConnectors;
use pin::Aliases;
use tables::NUMBERS;
use work::Work;

/// Translates a configuration for a board, or for the board that its pins and comments name.
///
/// # Errors
/// The board cannot be told.
pub fn translate(config: &Config, board: Option<&'static BoardConnectors>) -> Result<Translation, String> {
    let aliases = Aliases::of(config);
    let is_given = board.is_some();
    let board = board
        .or_else(|| board::found(config, &aliases))
        .ok_or("cannot tell the board: no board with an image, or several, have these step pins; say --board")?;
    let pins = Pins::of(board).ok_or_else(|| format!("the {} has no pins: name another --board", board.key))?;
    let mut work = Work::new(config, &pins, &aliases);
    let from = if is_given { "--board" } else { "by its step pins" };
    work.lines.set("board", board.key.into(), from);
    motors::motors(&mut work);
    axes::axes(&mut work);
    heat::heat(&mut work);
    probe::probe(&mut work);
    bed::bed(&mut work);
    probe::filament(&mut work);
    probe::shapers(&mut work);
    numbers(&mut work);
    let head = format!(
        "#:schema ./machine.schema.json\n# From {}, for the {}. `corehbot config check` checks it.\n",
        config.files.first().map_or("a configuration of Klipper", String::as_str).escape_debug(),
        board.name
    );
    let text = head + &work.lines.text();
    Ok(Translation::new(text, report::report(&work, board)))
}

/// Keys that are one number.
fn numbers(work: &mut Work<'_>) {
    let config = work.config;
    for row in NUMBERS.iter().filter(|row| config.section(row.section).is_some()) {
        match (work.number(row.section, row.key), row.default) {
            (Some((entry, number)), _) => work.take_number(entry, row.to, number * row.times),
            (None, Some(default)) if work.lines.get(row.to).is_none() => work.set_default(row.to, default),
            (None, _) => {}
        }
    }
}
