//! The sequence that ends what OUT endpoints may get (RM0390 rev 6, section 31.16: disabling of endpoints).

use crate::bits::{CGONAK, DCTL, EPDIS, EPDISD, EPENA, GINTSTS, GONAKEFF, SGONAK, SNAK, doepctl, doepint};
use crate::receive::receive;
use crate::registers::Registers;
use crate::state::State;
use crate::wait::{POLLS, until_set};
use embassy_sync::blocking_mutex::raw::RawMutex;

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
