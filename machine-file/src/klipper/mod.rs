//! Klipper: its configuration as a machine file, with a verdict on every key.
//!
//! Nothing here opens a file: [`Files`] does, and the command has one.
//!
//! | file | job |
//! |---|---|
//! | `config` | texts to sections and keys |
//! | `pin`, `board` | pins to connectors |
//! | `found` | which board it is on |
//! | `work` | the translation so far |
//! | `stepper` | a motor |
//! | `motors`, `drivers`, `axes`, `heat`, `fans`, `probe`, `bed` | one part of a machine each |
//! | `macros` | the owner's lines of G-code |
//! | `defaults` | Klipper's defaults where its files say nothing |
//! | `tables` | keys that are one number, and remarks on the rest |
//! | `report` | the verdict on every key |
//!
//! The report goes through all keys of the configuration. So a key that no part knows has a verdict too.

mod axes;
mod bed;
mod board;
mod config;
mod defaults;
mod drivers;
mod fans;
mod found;
mod heat;
mod macros;
mod motors;
mod pin;
mod probe;
mod report;
mod stepper;
mod tables;
mod work;

pub use crate::pattern::{is_pattern, matches};
use crate::short::short;
pub use crate::translation::{Kind, Report, Translation, Verdict};
use board::Pins;
pub use config::{At, Config, Entry, Files, Mistake, Section};
use corehbot::connectors::BoardConnectors;
use defaults::{DEFAULTS, PROBE};
use found::Pinned;
use pin::Aliases;
use tables::NUMBERS;
use work::{DEFAULT, Work};

/// Translates a configuration for a board, or for the board that its pins and comments name.
///
/// # Errors
/// Klipper would not read it, or the board cannot be told.
pub fn translate(config: &Config, board: Option<&'static BoardConnectors>) -> Result<Translation, String> {
    if let Some(mistake) = axes::refused(config) {
        return Err(format!("no configuration that Klipper reads\n{mistake}"));
    }
    if board.is_none() && !config.has_printer() {
        let text = "no printer is in it, neither [printer] nor [stepper_x]: give the printer.cfg that includes it";
        return Err(text.to_owned());
    }
    let aliases = Aliases::of(config);
    let is_given = board.is_some();
    let pinned = Pinned::of(config, &aliases);
    let board = board.map_or_else(|| pinned.board(), Ok)?;
    let pins =
        Pins::of(board, &pinned).ok_or_else(|| format!("the {} has no pins: name another --board", board.key))?;
    let mut work = Work::new(config, &pins, &aliases);
    let from = if is_given { "--board" } else { "by its pins" };
    work.lines.set("board", board.key.into(), from);
    if let Some(text) = pinned.strange_on(board) {
        work.notes.push(Verdict::new(Kind::Decide, text));
    }
    for (at, pattern) in &config.missing {
        let text = format!(
            "{}: there is no file {}: copy it to its place, or take out the line; the rest was read",
            config.place(*at),
            short(pattern)
        );
        work.notes.push(Verdict::new(Kind::Decide, text));
    }
    motors::motors(&mut work);
    axes::axes(&mut work);
    heat::heat(&mut work);
    fans::fans(&mut work);
    probe::probe(&mut work);
    bed::bed(&mut work);
    probe::filament(&mut work);
    probe::shapers(&mut work);
    numbers(&mut work);
    axes::extruder(&mut work);
    defaults(&mut work);
    axes::step_rates(&mut work);
    macros::macros(&mut work);
    of_chip(&mut work, &pinned, board);
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
        if let Some((entry, number)) = work.number(row.section, row.key) {
            work.take_number(entry, row.to, number * row.times);
        }
    }
}

/// Sets all keys of ours that nothing has set and that Klipper's defaults say.
fn defaults(work: &mut Work<'_>) {
    let config = work.config;
    let is_there = |pattern: &str| {
        let is_meant = |name: &str| if pattern == PROBE { probe::is_probe(name) } else { matches(pattern, name) };
        pattern.is_empty() || config.sections.iter().any(|section| is_meant(&section.name))
    };
    for row in DEFAULTS.iter().filter(|row| is_there(row.section)) {
        for path in row.to {
            if work.lines.get(path).is_none() {
                work.set_default(path, row.number * row.times);
            }
        }
    }
    // Klipper refuses every move of an axis that is not homed (`kinematics/*.py`, "Must home axis first").
    work.lines.set("require_homing", true.into(), DEFAULT);
}

/// A processor on the given board that is not the board's: with all pins of the board it is a variant of it.
fn of_chip(work: &mut Work<'_>, pinned: &Pinned, board: &BoardConnectors) {
    let entry = corehbot_boards::entries().find(|entry| entry.board.connectors.key == board.key);
    let is_variant = entry.is_some_and(|entry| pinned.fits(entry) && pinned.is_other_chip(entry));
    if let Some((serial, _)) = work.value(pin::FIRST_MCU, "serial").filter(|_| is_variant) {
        let text = format!("these are the pins of the {}, but with another processor: no image is for it", board.name);
        work.say(serial, Kind::Decide, text);
    }
}
