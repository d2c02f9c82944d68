//! The receive FIFO: its entries go to whom they are for.

use crate::bits::{EPENA, GINTSTS, GRXSTSP, OUT_DATA, OUT_DONE, RXFLVL, SETUP_DATA, diepctl, fifo};
use crate::registers::Registers;
use crate::state::State;
use crate::stop::stop_in;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// Takes an entry from the receive FIFO. Returns whether there was one.
pub fn receive<M: RawMutex, const N: usize>(registers: impl Registers, state: &State<M, N>) -> bool {
    if registers.read(GINTSTS) & RXFLVL == 0 {
        return false;
    }
    let entry = registers.read(GRXSTSP);
    let (n, length, status) = ((entry & 0xF) as usize, (entry >> 4 & 0x7FF) as usize, entry >> 17 & 0xF);
    let word = || registers.read(fifo(0));
    match status {
        SETUP_DATA if length == 8 => {
            state.begin_request([word(), word()]);
            if registers.read(diepctl(0)) & EPENA != 0 {
                // The host has given up the request before.
                stop_in(registers, 0, false);
            }
        }
        OUT_DATA => state.keep(n, length, word),
        // No other kind has data.
        _ => (0..length.div_ceil(4)).for_each(|_| _ = word()),
    }
    if status == OUT_DONE {
        state.complete(n);
        if let Some(waker) = state.outs.get(n) {
            waker.wake();
        }
    }
    true
}
