//! Pins of a board: which connector each is.

use super::found::{Pinned, printed};
use super::pin::PinText;
use crate::translation::Kind;
use corehbot::connectors::{BoardConnectors, Output, Sensor};
use corehbot_boards::entries;
use corehbot_wiring::Circuit;
use std::fmt::Debug;

/// The job of a fan's pin.
pub(super) const FAN: &str = "fan output";

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
    /// Whether the configuration is on this board: boards share names of pins by chance.
    is_its_own: bool,
    /// Whether its fans are.
    has_its_fans: bool,
}

impl Pins {
    /// Those of a board with an image; a simulated board has none. A configuration of another board has none of them.
    pub fn of(board: &'static BoardConnectors, pinned: &Pinned) -> Option<Self> {
        let entry = entries().find(|entry| entry.board.connectors.key == board.key)?;
        let board = entry.board;
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
            is_its_own: pinned.may_be(entry),
            has_its_fans: pinned.has_fans_of(entry),
        })
    }

    /// Whether a pin is one of this board.
    fn has(&self, pin: &PinText) -> bool {
        self.is_its_own && pin.is_on_board()
    }

    /// Why a pin is none of them for that job.
    pub fn elsewhere(&self, pin: &PinText, job: &str) -> String {
        match (pin.is_on_board(), self.is_its_own) {
            (false, _) => format!("{} is another board, and a machine has one so far", pin.chip),
            (true, false) => format!("{} is a pin of another board", pin.name),
            (true, true) if job == FAN && !self.has_its_fans => {
                format!("{} is a fan output of another version of the {}", pin.name, self.connectors.name)
            }
            (true, true) => format!("{} is no {job} of the {}", pin.name, self.connectors.name),
        }
    }

    /// The printed name of a pin that is on no connector of this board so far.
    pub fn printed(&self, pin: &PinText) -> Option<&'static str> {
        printed(self.connectors, pin).filter(|_| self.has(pin))
    }

    /// The socket with that step pin.
    pub fn socket(&self, step: &PinText) -> Option<&Socket> {
        self.sockets.iter().find(|socket| socket.pins[0].as_ref() == Some(&step.name)).filter(|_| self.has(step))
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
        here().find(|input| input.circuit == wanted).or_else(|| here().next()).filter(|_| self.has(pin)).cloned()
    }

    /// The heater output.
    pub fn output(&self, pin: &PinText) -> Option<Output> {
        self.outputs.iter().find(|(known, _)| *known == pin.name && self.has(pin)).map(|(_, output)| *output)
    }

    /// The names of all heater outputs.
    pub fn outputs(&self) -> String {
        let names: Vec<_> = self.outputs.iter().map(|(_, output)| output.name()).collect();
        if names.is_empty() { "none (there are none so far)".to_owned() } else { names.join(", ") }
    }

    /// The input of a sensor.
    pub fn sensor(&self, pin: &PinText) -> Option<Sensor> {
        self.sensors.iter().find(|(known, _)| *known == pin.name && self.has(pin)).map(|(_, sensor)| *sensor)
    }

    /// The fan output, by its number.
    pub fn fan(&self, pin: &PinText) -> Option<usize> {
        self.fans.iter().position(|known| *known == pin.name && self.has(pin) && self.has_its_fans)
    }
}

/// A processor's pin, as its data sheet names it: `PF13`.
fn pin_name(port: impl Debug, number: usize) -> String {
    format!("P{port:?}{number}")
}
