//! The sequences that end a transfer under way (RM0390 rev 6, section 31.16: disabling of endpoints).

use crate::bits::{
    CGONAK, DCTL, EPDIS, EPDISD, EPENA, GINTSTS, GONAKEFF, INEPNE, SGONAK, SNAK, STALL, USBAEP, diepctl, diepint,
    doepctl, doepint,
};
use crate::interrupt::receive;
use crate::registers::Registers;
use crate::state::State;
use crate::wait::{POLLS, flush, until_set};
use embassy_sync::blocking_mutex::raw::RawMutex;

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

/// Ends what OUT endpoints may get: all whose number `is_wanted` has, but endpoint 0, which cannot be disabled.
pub fn stop_out<M: RawMutex, const N: usize>(
    registers: impl Registers,
    state: &State<M, N>,
    is_wanted: impl Fn(usize) -> bool,
) {
    let is_enabled = |n: &usize| registers.read(doepctl(*n)) & EPENA != 0;
    if !(1..N).filter(|n| is_wanted(*n)).any(|n| is_enabled(&n)) {
        return;
    }
    registers.write(DCTL, SGONAK);
    // It takes effect when its entry is popped from the receive FIFO.
    for _ in 0..POLLS {
        if registers.read(GINTSTS) & GONAKEFF != 0 {
            break;
        }
        receive(registers, state);
    }
    for n in (1..N).filter(|n| is_wanted(*n)).filter(is_enabled) {
        registers.set(doepctl(n), SNAK | EPDIS);
        until_set(registers, doepint(n), EPDISD);
        registers.write(doepint(n), EPDISD);
    }
    registers.write(DCTL, CGONAK);
}

/// Whether an endpoint, by its control register, belongs to the configuration that the host chose.
pub fn is_active(registers: impl Registers, control: u32) -> bool {
    registers.read(control) & USBAEP != 0
}
