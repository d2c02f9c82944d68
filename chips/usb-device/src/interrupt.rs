//! The interrupt: empties the receive FIFO, and wakes the tasks that wait.

use crate::bits::{
    DAINT, DAINTMSK, ENUMDNE, ESUSP, GINTMSK, GINTSTS, IEPINT, OEPINT, STUP, USBRST, USBSUSP, WKUPINT, diepint, doepint,
};
use crate::receive::receive;
use crate::registers::Registers;
use crate::state::State;
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
        // The task handles them, and asks for them again. Until then their flags would raise this interrupt again.
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
    // Read again: emptying the FIFO may have finished transfers.
    if registers.read(GINTSTS) & (IEPINT | OEPINT) == 0 {
        return;
    }
    let endpoints = registers.read(DAINT) & registers.read(DAINTMSK);
    for (n, waker) in state.ins.iter().enumerate().filter(|(n, _)| endpoints >> n & 1 != 0) {
        let flags = registers.read(diepint(n));
        // Cleared before the wake, so that what comes afterwards raises the interrupt again. Writing a flag's 1 clears
        // it.
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
