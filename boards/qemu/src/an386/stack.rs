//! The stack that all contexts share: how much of it a run has needed.

use core::ptr::{read_volatile, write_volatile};

use cortex_m::register::msp;

unsafe extern "C" {
    /// Above the stack's highest word (memory.x).
    static _stack_start: u32;
    /// The stack's lowest word.
    static _stack_end: u32;
}

fn bounds() -> (usize, usize) {
    (&raw const _stack_end as usize, &raw const _stack_start as usize)
}

/// Bytes there are.
pub fn size() -> usize {
    let (end, start) = bounds();
    start - end
}

/// Room for the stack frames of this file's functions.
const OWN: usize = 256;

/// Forgets the use so far, so that [`used`] reports only later use.
pub fn forget() {
    let end = bounds().0;
    for address in (end..(msp::read() as usize).saturating_sub(OWN)).step_by(size_of::<u32>()) {
        // SAFETY: the address is aligned and lies in RAM, far enough below the stack pointer that nothing of value is
        // there. This function's frame is smaller than OWN, and an interrupt that comes in between is over before the
        // loop goes on.
        unsafe { write_volatile(address as *mut u32, 0) };
    }
}

/// Bytes that were used since reset (QEMU clears RAM) or since [`forget`]: everything above the lowest
/// word that is not 0.
pub fn used() -> usize {
    let (end, start) = bounds();
    let is_untouched = |address: &usize| {
        // SAFETY: the address is aligned and lies in the stack, which is RAM. Any word is a valid u32, and a volatile
        // read of a changing word gives the old value or the new.
        unsafe { read_volatile(*address as *const u32) == 0 }
    };
    let untouched = (end..start).step_by(size_of::<u32>()).take_while(is_untouched).count();
    size() - untouched * size_of::<u32>()
}
