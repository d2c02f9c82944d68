//! Pins as Klipper writes them, and other names for them.

use super::config::Config;
use std::collections::BTreeMap;

/// The controller that a pin without a name belongs to.
pub(super) const FIRST_MCU: &str = "mcu";

/// A pin.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct PinText {
    /// `!`: low counts.
    pub is_inverted: bool,
    /// `^`: a resistor to 3.3 V.
    pub is_pulled_up: bool,
    /// `~`: a resistor to ground.
    pub is_pulled_down: bool,
    /// The controller: `mcu`, or the name of another one.
    pub chip: String,
    /// `PF13`, or `virtual_endstop` and the like.
    pub name: String,
}

impl PinText {
    /// Reads a pin. Klipper wants `^` or `~` before `!`, and the controller behind them.
    pub fn read(text: &str) -> Self {
        let mut pin = Self {
            is_inverted: false,
            is_pulled_up: false,
            is_pulled_down: false,
            chip: FIRST_MCU.to_owned(),
            name: String::new(),
        };
        let mut rest = text.trim();
        while let Some(sign) = rest.chars().next().filter(|sign| "^~!".contains(*sign)) {
            pin.is_inverted |= sign == '!';
            pin.is_pulled_up |= sign == '^';
            pin.is_pulled_down |= sign == '~';
            rest = rest[1..].trim_start();
        }
        if let Some((chip, name)) = rest.split_once(':') {
            pin.chip = chip.trim().to_owned();
            rest = name;
        }
        pin.name = rest.trim().to_owned();
        pin
    }

    /// Whether it is on the main board.
    pub fn is_on_board(&self) -> bool {
        self.chip == FIRST_MCU
    }
}

/// Other names of pins, from `[board_pins]`.
#[derive(Default)]
pub(super) struct Aliases(BTreeMap<(String, String), String>);

impl Aliases {
    pub fn of(config: &Config) -> Self {
        let mut aliases = BTreeMap::new();
        let is_of = |name: &str| name == "board_pins" || name.starts_with("board_pins ");
        for section in config.sections.iter().filter(|section| is_of(&section.name)) {
            let chips = config.find(&section.name, "mcu").and_then(|entry| config.entries.get(entry));
            let chips = chips.map_or(FIRST_MCU, |entry| &entry.value);
            let number = config.section(&section.name);
            let lists = config.entries.iter().filter(|entry| Some(entry.section) == number);
            for list in lists.filter(|entry| entry.key.starts_with("aliases") && entry.replaced.is_none()) {
                for (name, pin) in list.value.split([',', '\n']).filter_map(|pair| pair.split_once('=')) {
                    for chip in chips.split([',', '\n']) {
                        let key = |name: &str| (chip.trim().to_owned(), name.trim().to_owned());
                        let pin = aliases.get(&key(pin)).cloned().unwrap_or_else(|| pin.trim().to_owned());
                        aliases.insert(key(name), pin);
                    }
                }
            }
        }
        Self(aliases)
    }

    /// The pin by the processor's name, whatever name it was written by.
    pub fn resolve(&self, text: &str) -> PinText {
        let mut pin = PinText::read(text);
        if let Some(name) = self.0.get(&(pin.chip.clone(), pin.name.clone())) {
            pin.name.clone_from(name);
        }
        pin
    }
}
