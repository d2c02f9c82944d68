//! The work on one configuration: a draft, and a look at the keys of the configuration.

use super::board::Pins;
use super::config::Config;
use super::pin::{Aliases, PinText};
use crate::translation::Kind;
use crate::translation::draft::Draft;
use corehbot_wiring::Circuit;
use std::ops::{Deref, DerefMut};

/// The comment behind a default.
pub(super) const DEFAULT: &str = "Klipper's default";

/// A configuration that is being translated: a draft that knows its configuration.
pub(super) struct Work<'c> {
    pub config: &'c Config,
    pub pins: &'c Pins,
    pub aliases: &'c Aliases,
    draft: Draft,
}

impl<'c> Work<'c> {
    pub fn new(config: &'c Config, pins: &'c Pins, aliases: &'c Aliases) -> Self {
        let places = config.entries.iter().map(|entry| config.place(entry.at));
        Self { config, pins, aliases, draft: Draft::new(places.collect()) }
    }

    /// The entry of a key, and its value.
    pub fn value(&self, section: &str, key: &str) -> Option<(usize, &'c str)> {
        let number = self.config.find(section, key)?;
        Some((number, self.config.entries.get(number)?.value.as_str()))
    }

    /// The entry of a key, and its number. A value that is no number is for the owner to decide.
    pub fn number(&mut self, section: &str, key: &str) -> Option<(usize, f64)> {
        let (entry, text) = self.value(section, key)?;
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Some((entry, number)),
            _ => {
                self.say(entry, Kind::Decide, "no number: correct it");
                None
            }
        }
    }

    /// The entry of a key, and the pin in it by the processor's name.
    pub fn pin(&self, section: &str, key: &str) -> Option<(usize, PinText)> {
        let (entry, text) = self.value(section, key)?;
        Some((entry, self.aliases.resolve(text)))
    }

    /// Whether a pin is on the main board; otherwise that is said of its entry.
    pub fn is_here(&mut self, entry: usize, pin: &PinText) -> bool {
        if !pin.is_on_board() {
            let text =
                format!("{} is another board, and a machine has one so far: move it to the main board", pin.chip);
            self.say(entry, Kind::Decide, text);
        }
        pin.is_on_board()
    }

    /// A contact at a pin that is no input of the board: what is not the pin is kept, which is whether it closes.
    pub fn foreign_input(&mut self, entry: usize, pin: &PinText, path: &str) {
        let place = self.pins.elsewhere(pin, "input");
        let closes = pin.is_inverted == Circuit::Plain.is_high_when_open();
        let how = if closes { ", behind `!`, because its contact closes" } else { "" };
        let pull = if pin.is_pulled_down { "; it was pulled down, which an input with an optocoupler is" } else { "" };
        self.lines.set(path, if closes { "!" } else { "" }.into(), "to decide");
        self.say(entry, Kind::Decide, format!("{place}: write its input into {path}{how}{pull}"));
    }

    /// Sets a key that Klipper's files may leave out to Klipper's default, which is not ours.
    pub fn set_default(&mut self, path: &str, number: f64) {
        self.set_number(path, number, DEFAULT);
    }
}

impl Deref for Work<'_> {
    type Target = Draft;

    fn deref(&self) -> &Draft {
        &self.draft
    }
}

impl DerefMut for Work<'_> {
    fn deref_mut(&mut self) -> &mut Draft {
        &mut self.draft
    }
}

/// Whether a value switches something on, in Python's words.
pub(super) fn is_true(text: &str) -> bool {
    ["true", "1", "yes", "on"].contains(&text.to_lowercase().as_str())
}
