//! A board as one machine is plugged into it.

use core::hint::black_box;

use corehbot::connectors::ConnectorName;
use corehbot::port::{EndstopSet, Motor, MotorSet};
use corehbot::settings::{ConnectorError, EndstopPlug, Settings};
use corehbot::storage::BLOCK;

use super::{Board, Pin, Slot};

impl Board {
    /// The machine block of the image. The compiler must not take what it compiles for what is there when it runs.
    #[must_use]
    pub fn machine(&self) -> &'static [u8; BLOCK] {
        black_box(self.machine)
    }

    /// The board with each motor of a machine at the driver, and each switch at the input, that it is plugged into. Drivers
    /// without a motor are left off.
    ///
    /// # Errors
    /// What is plugged in where the board has nothing for it.
    pub fn plugged(&self, machine: &Settings) -> Result<Self, ConnectorError> {
        machine.check_connectors(self.connectors)?;
        let mut board = *self;
        (board.slots, board.reversed, board.slow) = ([None; Motor::ALL.len()], MotorSet::NONE, MotorSet::NONE);
        let fitted = machine.mechanism.fitted();
        for (motor, place) in Motor::ALL.into_iter().zip(&mut board.slots).filter(|(motor, _)| fitted.has(*motor)) {
            let plug = machine.wiring.of(motor);
            let Some((usual, slot)) = self.socket(plug.connector) else { continue };
            let own = MotorSet::of(motor);
            *place = Some(slot);
            if plug.is_reversed != self.reversed.has(usual) {
                board.reversed = board.reversed.with(own);
            }
            if self.slow.has(usual) {
                board.slow = board.slow.with(own);
            }
        }
        let switches = &machine.wiring.endstops;
        let switches = [(EndstopSet::X, switches.x), (EndstopSet::Y, switches.y), (EndstopSet::Z, switches.z)];
        for ((endstop, plug), pin) in switches.into_iter().zip(&mut board.endstops) {
            *pin = self.input(plug).unwrap_or(*pin);
            if plug.is_normally_open {
                board.normally_open = board.normally_open.with(endstop);
            }
        }
        Ok(board)
    }

    /// The driver in the socket of that name, and the motor that is usually there.
    fn socket(&self, name: ConnectorName) -> Option<(Motor, Slot)> {
        let usual = Motor::ALL.into_iter().zip(self.slots).filter_map(|(motor, slot)| Some((motor, slot?)));
        self.connectors.sockets.iter().zip(usual).find_map(|(socket, found)| (*socket == name).then_some(found))
    }

    /// The pin of the input that a switch is plugged into.
    fn input(&self, plug: EndstopPlug) -> Option<Pin> {
        let mut inputs = self.connectors.endstops.iter().zip(self.endstops);
        inputs.find_map(|(input, pin)| (*input == plug.connector).then_some(pin))
    }
}
