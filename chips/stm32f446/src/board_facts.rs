//! Facts of the board that the core asks for.

use corehbot::connectors::BoardConnectors;
use corehbot::port::BoardFacts;

use crate::{clock_check, heater_registers, supply};

/// This board.
pub struct ThisBoard {
    /// Its connectors.
    pub connectors: &'static BoardConnectors,
    /// The owner's texts in its image.
    pub texts: &'static [u8],
    /// Why no motor gets power, if that is so.
    pub refusal: Option<&'static str>,
}

impl BoardFacts for ThisBoard {
    fn connectors(&self) -> &'static BoardConnectors {
        self.connectors
    }

    fn texts(&self) -> &'static [u8] {
        self.texts
    }

    fn refusal(&self) -> Option<&'static str> {
        self.refusal
    }

    fn warnings(&self) -> [Option<&'static str>; 2] {
        [supply::warning(), clock_check::warning()]
    }

    fn registers_set_right(&self) -> u32 {
        heater_registers::times_set_right()
    }
}
