//! The interrupt: empties the receive FIFO, and wakes the tasks that wait.

use crate::bits::{
    DAINT, DAINTMSK, ENUMDNE, EPENA, ESUSP, GINTMSK, GINTSTS, GRXSTSP, IEPINT, OEPINT, OUT_DATA, OUT_DONE, RXFLVL,
    SETUP_DATA, STUP, USBRST, USBSUSP, WKUPINT, diepctl, diepint, doepint, fifo,
};
use crate::registers::Registers;
use crate::state::State;
use crate::stop::stop_in;
use embassy_sync::blocking_mutex::raw::RawMutex;

/// Events of the bus, which the task handles.
pub const BUS_EVENTS: u32 = USBRST | ENUMDNE | ESUSP | USBSUSP | WKUPINT;

/// Entries of the receive FIFO in one call: each is two words or more of its 128 at most. What comes after them raises
/// the interrupt again.
const ENTRIES: usize = 64;

/// Handles an interrupt of the core.
pub fn on_interrupt<M: RawMutex, const N: usize>(registers: impl Registers, state: &State<M, N>) {
    let mask = registers.read(GINTMSK);
    let pending = registers.read(GINTSTS) & mask;
    if pending & BUS_EVENTS != 0 {
        // The task handles them, and asks for them again.
        registers.write(GINTMSK, mask & !BUS_EVENTS);
        if pending & USBRST != 0 {
            state.end_requests();
        }
        state.bus.wake();
    }
    for _ in 0..ENTRIES {
        if !receive(registers, state) {
            break;
        }
    }
    if registers.read(GINTSTS) & (IEPINT | OEPINT) == 0 {
        return;
    }
    let endpoints = registers.read(DAINT) & registers.read(DAINTMSK);
    for (n, waker) in state.ins.iter().enumerate().filter(|(n, _)| endpoints >> n & 1 != 0) {
        let flags = registers.read(diepint(n));
        registers.write(diepint(n), flags);
        waker.wake();
    }
    for (n, waker) in state.outs.iter().enumerate().filter(|(n, _)| endpoints >> (n + 16) & 1 != 0) {
        let flags = registers.read(doepint(n));
        registers.write(doepint(n), flags);
        if n == 0 && flags & STUP != 0 {
            state.publish();
            // Whatever waits for the earlier request ends.
            state.ins.iter().take(1).for_each(embassy_sync::waitqueue::AtomicWaker::wake);
        }
        waker.wake();
    }
}

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
