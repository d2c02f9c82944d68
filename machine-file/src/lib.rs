//! Machine files: settings as TOML that a person writes; read, checked, written and described.
//!
//! For commands, other tools and web pages. Only [`read`] and [`read_text`] open a file; everything else goes from text
//! to values and back.
//!
//! Every key is optional and overrides the prototype's value, except for `[mechanism]`, which lists all motors or is
//! left out. An unknown key or a value outside its legal range is an error that names both. Keys, kinds, ranges and
//! meanings come from the rows of all settings (`corehbot::settings::rows`). So this crate names only settings that
//! follow laws of their own.
//!
//! | file | job |
//! |---|---|
//! | [`file_kind`] | what a file is, by its content, and what to do with it |
//! | `keys` | every key, and the subjects of tables |
//! | [`texts`](body) | the owner's texts, and what is wrong with them |
//! | `numbers`, `value`, `thermistor` | a value of TOML as a setting has it, and the reverse |
//! | `reader`, `resolution` | a file to settings |
//! | `written`, `template` | settings to a file, and a new one |
//! | `schema`, `reference` | keys for editors, and for docs/reference/settings.md |
//! | `translation` | another firmware's configuration to a machine file, with a verdict on every part |
//! | `klipper` | configurations of Klipper |
//! | `marlin` | answers of a printer with Marlin |
//! | `configuration_h` | the source of Marlin's settings |
//! | `reprap` | config.g of RepRapFirmware |
//! | `peers` | keys of Klipper and Marlin, and ours |
//! | `pattern` | patterns of names |
//! | [`printable`] | texts of others that must not command a terminal |
//! | `problems`, `unreached`, `unwise`, `place`, `error` | all that is wrong with a file, and where |
//!
//! `examples/machines/prototype.toml` shows every key. A file that names a `board` must use its connectors.

#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod amplified;
pub mod configuration_h;
mod error;
pub mod file_kind;
mod keys;
pub mod klipper;
pub mod marlin;
mod numbers;
mod pattern;
mod peers;
mod place;
pub mod printable;
mod problems;
mod reader;
mod reference;
pub mod reprap;
mod resolution;
mod schema;
pub mod short;
pub mod template;
mod texts;
mod thermistor;
mod translation;
mod unreached;
mod unwise;
mod value;
mod written;

use anyhow::{Context as _, anyhow, ensure};
use corehbot::connectors::BoardConnectors;
use corehbot::settings::Settings;
use corehbot_twin::description::Description;
pub use error::MachineFileError;
use file_kind::{FileKind, Wanted, WrongFile, text_of};
pub use place::{Place, nearest, with_suggestion, words};
pub use problems::{Problem, problems};
use reader::Given;
pub use reference::reference;
use resolution::resolution;
pub use schema::schema;
use std::path::Path;
pub use texts::{NamedText, TextError, body};
pub use translation::{Kind, OfKey, OfSection, Report, Translation, Verdict};
pub use written::{keyed, written};

/// A machine as its file describes it.
#[derive(Clone, PartialEq, Debug)]
pub struct Machine {
    /// The machine's name in the file.
    pub name: Option<String>,
    /// The board that it says it has; every connector of the settings is on it.
    pub board: Option<&'static BoardConnectors>,
    /// Its settings, all in range.
    pub settings: Settings,
    /// Its belts, masses and motors, for the twin. No board keeps them.
    pub twin: Description,
    /// The owner's texts. An image has them ([`body`]), and the memory of settings does not.
    pub texts: Vec<NamedText>,
}

/// The machine of the file at `path`, which is its name unless it says another.
///
/// # Errors
/// The error, after the file's name, line and column.
pub fn read(path: &Path) -> anyhow::Result<Machine> {
    let text = read_text(path)?;
    let mut machine = parse(&text).map_err(|error| match error.place(&text) {
        Some(place) => anyhow!("{}:{place}: {error}", path.display()),
        None => anyhow!("{}: {error}", path.display()),
    })?;
    machine.name = machine.name.or_else(|| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
    Ok(machine)
}

/// The text of the machine file at `path`.
///
/// # Errors
/// It cannot be read, or is another kind of file.
pub fn read_text(path: &Path) -> anyhow::Result<String> {
    let cannot = || format!("cannot open {}", path.display());
    ensure!(!path.is_dir(), "{}: {}", cannot(), WrongFile { kind: FileKind::Folder, wanted: Wanted::Machine });
    let bytes = std::fs::read(path).with_context(cannot)?;
    let kind = FileKind::of(&bytes[..bytes.len().min(file_kind::START)], bytes.len() as u64);
    Wanted::Machine.check(kind).with_context(|| path.display().to_string())?;
    Ok(text_of(&bytes))
}

/// The settings of a machine file.
///
/// # Errors
/// The error, in words for the person who wrote the file.
pub fn load(text: &str) -> Result<Settings, MachineFileError> {
    parse(text).map(|machine| machine.settings)
}

/// The machine of a machine file.
///
/// # Errors
/// The error, in words for the person who wrote the file.
pub fn parse(text: &str) -> Result<Machine, MachineFileError> {
    let mut given = Given::read(text)?;
    // The first one in the file.
    let place = |error: &MachineFileError| error.place(text).map(|place| (place.line, place.column));
    match std::mem::take(&mut given.errors).into_iter().min_by_key(place) {
        Some(error) => Err(error),
        None => together(given),
    }
}

/// The machine of keys that are each legal.
///
/// # Errors
/// Keys that do not go together.
fn together(given: Given) -> Result<Machine, MachineFileError> {
    let mut s = given.settings()?;
    for axis in 0..4 {
        resolution(&mut s, axis, &given)?;
    }
    s.check_machine().map_err(MachineFileError::Settings)?;
    s.check_connectors(given.board.unwrap_or(&BoardConnectors::ANY)).map_err(MachineFileError::Connectors)?;
    Ok(Machine { name: given.name, board: given.board, settings: s, twin: given.twin, texts: given.texts })
}

#[cfg(test)]
mod tests;
