//! Waits for the core, each with a bound.

use crate::bits::{GRSTCTL, TXFFLSH};
use crate::registers::Registers;

/// Reads of a register until a wait is given up: at four cycles of 180 MHz or more each, 40 us. The core needs a few
/// clocks of its 48 MHz.
pub const POLLS: u32 = 2_000;

/// Waits until `bits` of the register are set. Returns whether they are.
pub fn until_set(registers: impl Registers, offset: u32, bits: u32) -> bool {
    (0..POLLS).any(|_| registers.read(offset) & bits == bits)
}

/// Empties the transmit FIFO of an endpoint.
pub fn flush(registers: impl Registers, n: usize) {
    registers.write(GRSTCTL, TXFFLSH | (n as u32) << 6);
    // Nothing is sent from a FIFO whose flush hangs: its endpoint is off.
    let _ = (0..POLLS).any(|_| registers.read(GRSTCTL) & TXFFLSH == 0);
}
