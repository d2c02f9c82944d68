//! Calls: the way to a panic, as the stack has it.
//!
//! The place in the source that a panic names stays unread. So the linker leaves out the places of all checks, their
//! files and their messages: 23 KB. The calls are worth more to a reader with the ELF file of the image, because they
//! also say who called the function that failed (docs/reference/errors.md#a-panic).
//!
//! r7 points to the record of the running function: the caller's r7, then the return address. Every function lays one,
//! because the compiler keeps the frame pointer on this target, and AAPCS fixes the record's form for it.

use core::arch::asm;
use core::fmt;
use core::ops::Range;

use crate::stack_guard;

/// The flash (RM0390, 2.2.2).
const FLASH: Range<u32> = 0x0800_0000..0x0808_0000;

/// SRAM1 and SRAM2 (RM0390, 2.2.2), without the last bytes, where no word begins.
const RAM: Range<u32> = 0x2000_0000..0x2000_0000 + stack_guard::RAM_SIZE - 3;

/// Calls that a text names. The first ones are the core library's own, three at most (panic_fmt, and before it
/// panic_display and panic_str, or the function of the check).
const NAMED: usize = 7;

/// The calls that lead to a place, the last one first. They end where the stack has no record any more, as at the entry
/// of an interrupt.
#[derive(Clone)]
pub struct Calls {
    record: u32,
}

impl Calls {
    /// Those that lead to the running function.
    #[inline(always)]
    pub fn here() -> Self {
        let record: u32;
        // SAFETY: copying a register touches neither memory nor stack nor flags.
        unsafe { asm!("mov {}, r7", out(reg) record, options(nomem, nostack, preserves_flags)) };
        Self { record }
    }
}

impl Iterator for Calls {
    type Item = u32;

    /// An address within the next instruction that calls: it has two or four bytes before the return address, whose
    /// bit 0 says Thumb.
    fn next(&mut self) -> Option<u32> {
        let (outer, back) = (word(self.record)?, word(self.record + 4)?);
        // The stack grows down, so an outer record lies above; anything else is none.
        self.record = if outer > self.record { outer } else { 0 };
        FLASH.contains(&back).then_some((back & !1) - 2)
    }
}

impl fmt::Display for Calls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.clone().take(NAMED).try_for_each(|call| write!(f, " {call:08x}"))
    }
}

/// The word at an address, if it is in RAM.
pub fn word(address: u32) -> Option<u32> {
    let is_there = RAM.contains(&address) && address.is_multiple_of(4);
    // SAFETY: the address is aligned and lies in RAM; any word is a valid u32.
    is_there.then(|| unsafe { core::ptr::read_volatile(address as *const u32) })
}
