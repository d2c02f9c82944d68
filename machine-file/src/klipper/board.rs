//! Pins of a board: which connector each is, and on which board a configuration is.

use super::config::Config;
use super::pin::{Aliases, PinText};
use crate::translation::Kind;
use corehbot::connectors::{BoardConnectors, Output, Sensor};
use corehbot_boards::{Entry, entries};
use corehbot_wiring::Circuit;
use std::fmt::Debug;

/// Pins of a driver's socket.
pub(super) struct Socket {
    /// Its name on the board.
    pub name: &'static str,
    /// Step, direction, enable, UART.
    pub pins: [Option<String>; 4],
}

/// A connector for a contact.
#[derive(Clone)]
pub(super) struct InputPin {
    /// Its name on the board.
    pub name: &'static str,
    /// The way from it to its pin.
    pub circuit: Circuit,
    pin: String,
}

impl InputPin {
    /// A contact here as machine files have it. Klipper tells the level of a pin that has triggered, ours tells whether
    /// the contact opens or closes then; the circuit makes the one of the other.
    pub fn plug(&self, pin: &PinText) -> String {
        let is_high = !pin.is_inverted;
        let closes = self.circuit.is_high_when_open() != is_high;
        format!("{}{}", if closes { "!" } else { "" }, self.name)
    }

    /// What is to say of the resistor that Klipper was told to add, if the circuit asks for the other one.
    pub fn of_pull(&self, pin: &PinText) -> Option<(Kind, &'static str)> {
        match self.circuit {
            Circuit::Plain if pin.is_pulled_down => Some((Kind::NotYet, "its input is pulled up")),
            Circuit::Optocoupler if !pin.is_pulled_down => {
                Some((Kind::Approximated, "its input is pulled down, as its optocoupler needs it"))
            }
            Circuit::Plain | Circuit::Optocoupler => None,
        }
    }
}

/// The connectors of a board by their pins.
pub(super) struct Pins {
    /// The board.
    pub connectors: &'static BoardConnectors,
    /// Sockets of drivers.
    pub sockets: Vec<Socket>,
    inputs: Vec<InputPin>,
    outputs: Vec<(String, Output)>,
    sensors: Vec<(String, Sensor)>,
    fans: Vec<String>,
}

impl Pins {
    /// Those of a board with an image; a simulated board has none.
    pub fn of(board: &'static BoardConnectors) -> Option<Self> {
        let board = entries().find(|entry| entry.board.connectors.key == board.key)?.board;
        let sockets = board.connectors.sockets.iter().zip(board.sockets).map(|(name, slot)| Socket {
            name: name.as_str(),
            pins: [
                Some(pin_name(slot.step.port, slot.step.number())),
                Some(pin_name(slot.dir.port, slot.dir.number())),
                Some(pin_name(slot.enable.port, slot.enable.number())),
                slot.uart.map(|pin| pin_name(pin.port, pin.number())),
            ],
        });
        let inputs = board.connectors.inputs.iter().zip(board.inputs).map(|(name, input)| InputPin {
            name: name.as_str(),
            circuit: input.circuit,
            pin: pin_name(input.pin.port, input.pin.number()),
        });
        Some(Self {
            connectors: board.connectors,
            sockets: sockets.collect(),
            inputs: inputs.collect(),
            outputs: board
                .heaters
                .iter()
                .map(|heater| (pin_name(heater.pin.port, heater.pin.number()), heater.output))
                .collect(),
            sensors: board
                .thermistors
                .iter()
                .map(|input| (pin_name(input.pin.port, input.pin.number()), input.sensor))
                .collect(),
            fans: board.fans.iter().map(|fan| pin_name(fan.pin.port, fan.pin.number())).collect(),
        })
    }

    /// The socket with that step pin.
    pub fn socket(&self, step: &str) -> Option<&Socket> {
        self.sockets.iter().find(|socket| socket.pins[0].as_deref() == Some(step))
    }

    /// The input with that pin. Of two connectors on one pin it is the one that works with the resistor that Klipper
    /// was told to add; without one, the one with the circuit `usual`.
    pub fn input(&self, pin: &PinText, usual: Circuit) -> Option<InputPin> {
        let here = || self.inputs.iter().filter(|input| input.pin == pin.name);
        let wanted = match (pin.is_pulled_up, pin.is_pulled_down) {
            (true, _) => Circuit::Plain,
            (false, true) => Circuit::Optocoupler,
            (false, false) => usual,
        };
        here().find(|input| input.circuit == wanted).or_else(|| here().next()).cloned()
    }

    /// The heater output.
    pub fn output(&self, pin: &str) -> Option<Output> {
        self.outputs.iter().find(|(known, _)| known == pin).map(|(_, output)| *output)
    }

    /// The names of all heater outputs.
    pub fn outputs(&self) -> String {
        let names: Vec<_> = self.outputs.iter().map(|(_, output)| output.name()).collect();
        if names.is_empty() { "none (there are none so far)".to_owned() } else { names.join(", ") }
    }

    /// The input of a sensor.
    pub fn sensor(&self, pin: &str) -> Option<Sensor> {
        self.sensors.iter().find(|(known, _)| known == pin).map(|(_, sensor)| *sensor)
    }

    /// The fan output, by its number.
    pub fn fan(&self, pin: &str) -> Option<usize> {
        self.fans.iter().position(|known| known == pin)
    }
}

/// A processor's pin, as its data sheet names it: `PF13`.
fn pin_name(port: impl Debug, number: usize) -> String {
    format!("P{port:?}{number}")
}

/// The board that most motors of a configuration are on, and then most fans. Of boards alike so far it is one that a
/// comment, a section or a file names, or else one that the firmware takes for granted on all of them.
pub(super) fn found(config: &Config, aliases: &Aliases) -> Option<&'static BoardConnectors> {
    let of = |key: &'static str| {
        let entries = config.entries.iter().filter(move |entry| entry.key == key && entry.replaced.is_none());
        let pins = entries.map(|entry| aliases.resolve(&entry.value)).filter(PinText::is_on_board);
        pins.map(|pin| pin.name).collect::<Vec<_>>()
    };
    let (steps, others) = (of("step_pin"), of("pin"));
    let fits = |entry: &Entry| {
        let pins = Pins::of(entry.board.connectors);
        let count = |names: &[String], is_here: fn(&Pins, &str) -> bool| {
            pins.as_ref().map_or(0, |pins| names.iter().filter(|name| is_here(pins, name)).count())
        };
        (count(&steps, |pins, name| pins.socket(name).is_some()), count(&others, |pins, name| pins.fan(name).is_some()))
    };
    let best = entries().map(fits).max().filter(|(most, _)| *most > 0)?;
    let alike: Vec<_> = entries().filter(|entry| fits(entry) == best).collect();
    if let [only] = alike[..] {
        return Some(only.board.connectors);
    }
    let unmarked = alike.iter().find(|entry| entry.board.marks.is_empty()).map(|entry| entry.board.connectors);
    let alike = alike.into_iter().map(|entry| entry.board.connectors);
    let names = config.sections.iter().map(|section| &section.name).chain(&config.files);
    let words = names.fold(config.comments.clone(), |words, name| words + &name.to_lowercase() + "\n");
    let named = |board: &BoardConnectors| {
        let spelled = [board.key.to_owned(), board.key.replace('-', " "), board.key.replace('-', "_")];
        spelled.iter().filter_map(|name| words.find(name)).min()
    };
    // The first one that is named, because notes on others come later; of two at one place the longer name, because
    // "octopus pro" names the Octopus too.
    let named = alike.filter_map(|board| Some((named(board)?, board)));
    let first = named.min_by_key(|(place, board)| (*place, std::cmp::Reverse(board.key.len())));
    first.map(|(_, board)| board).or(unmarked)
}
