//! Safe levels: drivers off, heaters and fans off, in any context and at any time.

use core::sync::atomic::{AtomicU32, Ordering};

use crate::ports::{self, Speed};
use crate::wiring::{Board, Pin, Port};

/// The words for BSRR. Until a board is known they are 0, and its pins are inputs, which its resistors make safe.
static WORDS: [AtomicU32; Port::ALL.len()] = [const { AtomicU32::new(0) }; Port::ALL.len()];

/// Makes the board's outputs outputs, safe from the first instant on. Heaters come first.
pub fn adopt(board: &Board) {
    for port in Port::ALL {
        WORDS[port as usize].store(board.safe_levels(port), Ordering::Relaxed);
    }
    assume();
    let slots = || board.slots.iter().flatten();
    for pin in board.loads {
        ports::make_output(*pin);
    }
    for pin in slots().map(|slot| slot.enable) {
        ports::make_output(pin);
    }
    for pin in slots().flat_map(|slot| [slot.step, slot.dir]) {
        // The pins supplied by the power switch (PC13 to PC15) drive only slow edges (STM32F446 datasheet, pin definitions).
        if !is_weak(pin) {
            ports::speed_up(pin, Speed::Medium);
        }
        ports::make_output(pin);
    }
}

fn is_weak(pin: Pin) -> bool {
    pin.port == Port::C && pin.number() >= 13
}

/// Sets all outputs to their safe levels.
pub fn assume() {
    for port in Port::ALL {
        ports::store(ports::registers(port), WORDS[port as usize].load(Ordering::Relaxed));
    }
}
