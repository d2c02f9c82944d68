//! The sequence that ends what an IN endpoint sends (RM0390 rev 6, section 31.16: disabling of endpoints).

use crate::bits::{EPDIS, EPDISD, EPENA, INEPNE, SNAK, STALL, USBAEP, diepctl, diepint};
use crate::registers::Registers;
use crate::wait::{flush, until_set};

/// Ends what an IN endpoint sends, and empties its FIFO. With `halt` it is halted in the same step.
pub fn stop_in(registers: impl Registers, n: usize, halt: bool) {
    let stall = if halt { STALL } else { 0 };
    if registers.read(diepctl(n)) & EPENA == 0 {
        return registers.set(diepctl(n), SNAK | stall);
    }
    registers.set(diepctl(n), SNAK);
    until_set(registers, diepint(n), INEPNE);
    // The packet may have gone out meanwhile.
    if registers.read(diepctl(n)) & EPENA != 0 {
        registers.set(diepctl(n), SNAK | EPDIS | stall);
        until_set(registers, diepint(n), EPDISD);
    } else {
        registers.set(diepctl(n), stall);
    }
    registers.write(diepint(n), EPDISD | INEPNE);
    flush(registers, n);
}

/// Whether an endpoint, by its control register, belongs to the configuration that the host chose.
pub fn is_active(registers: impl Registers, control: u32) -> bool {
    registers.read(control) & USBAEP != 0
}
