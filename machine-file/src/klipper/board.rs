//! Pins of a board: which connector each is, and on which board a configuration is.

use super::config::Config;
use super::pin::Aliases;
use corehbot::connectors::{BoardConnectors, Output, Sensor};
use corehbot_boards::{Entry, entries};
use std::fmt::Debug;

/// Pins of a driver's socket.
pub(super) struct Socket {
    /// Its name on the board.
    pub name: &'static str,
    /// Step, direction, enable, UART.
    pub pins: [Option<String>; 4],
}

/// The connectors of a board by their pins.
pub(super) struct Pins {
    /// The board.
    pub connectors: &'static BoardConnectors,
    /// Sockets of drivers.
    pub sockets: Vec<Socket>,
    inputs: Vec<(String, &'static str)>,
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
        let inputs = board
            .connectors
            .endstops
            .iter()
            .zip(board.inputs)
            .map(|(name, pin)| (pin_name(pin.port, pin.number()), name.as_str()));
        let probe = board
            .probe
            .and_then(|pin| Some((pin_name(pin.port, pin.number()), board.connectors.probes.first()?.as_str())));
        Some(Self {
            connectors: board.connectors,
            sockets: sockets.collect(),
            inputs: inputs.chain(probe).collect(),
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

    /// The input, and whether it is the probe's.
    pub fn input(&self, pin: &str) -> Option<(&'static str, bool)> {
        let name = self.inputs.iter().find(|(known, _)| known == pin)?.1;
        Some((name, self.connectors.probes.iter().any(|probe| probe.as_str() == name)))
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

/// The board that most motors of a configuration are on; of boards with the same pins, one that a comment, a
/// section or a file names.
pub(super) fn found(config: &Config, aliases: &Aliases) -> Option<&'static BoardConnectors> {
    let is_step = |key: &str| key == "step_pin";
    let steps: Vec<_> = config.entries.iter().filter(|entry| is_step(&entry.key) && entry.replaced.is_none()).collect();
    let steps: Vec<_> = steps.into_iter().map(|entry| aliases.resolve(&entry.value)).collect();
    let fits = |entry: &Entry| {
        let pins = Pins::of(entry.board.connectors);
        let is_here = |name: &str| pins.as_ref().is_some_and(|pins| pins.socket(name).is_some());
        steps.iter().filter(|pin| pin.is_on_board() && is_here(&pin.name)).count()
    };
    let best = entries().map(fits).max().filter(|most| *most > 0)?;
    let alike: Vec<_> = entries().filter(|entry| fits(entry) == best).map(|entry| entry.board.connectors).collect();
    if let [only] = alike[..] {
        return Some(only);
    }
    let names = config.sections.iter().map(|section| &section.name).chain(&config.files);
    let words = names.fold(config.comments.clone(), |words, name| words + &name.to_lowercase() + "\n");
    let named = |board: &BoardConnectors| {
        let spelled = [board.key.to_owned(), board.key.replace('-', " "), board.key.replace('-', "_")];
        spelled.iter().filter_map(|name| words.find(name)).min()
    };
    // The first one that is named, because notes on others come later; of two at one place the longer name, because
    // "octopus pro" names the Octopus too.
    let named = alike.into_iter().filter_map(|board| Some((named(board)?, board)));
    named.min_by_key(|(place, board)| (*place, std::cmp::Reverse(board.key.len()))).map(|(_, board)| board)
}
