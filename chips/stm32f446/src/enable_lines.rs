//! The drivers' enable lines.

use corehbot::port::{DriverBus, MotorSet};

use crate::ports;
use crate::wiring::{Board, Port};

/// Switches drivers on and off.
pub struct EnableLines {
    board: &'static Board,
}

impl EnableLines {
    /// The enable lines of `board`, which are outputs already.
    pub const fn new(board: &'static Board) -> Self {
        Self { board }
    }
}

impl DriverBus for EnableLines {
    /// First finds all words and then stores them, with nothing but a step in between: the belt motors
    /// get their power within a microsecond or two.
    fn enable(&mut self, on: MotorSet) {
        let words = Port::ALL.map(|port| {
            let low = self.board.enable_lines(on, port);
            let high = self.board.enable_lines(MotorSet::ALL, port) & !low;
            high | low << 16
        });
        critical_section::with(|_| {
            for (port, word) in Port::ALL.into_iter().zip(words) {
                ports::store(ports::registers(port), word);
            }
        });
    }
}
