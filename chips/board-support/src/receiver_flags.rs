//! Handling of a USART receiver's flags while DMA takes its bytes.
//!
//! A read of the status register and then of the data register clears the flags that stood at the first read. These are
//! idle and errors (RM0390, 25.6.1: IDLE, ORE, NF, FE). But the data register belongs to the DMA. If we read it, we
//! swallow a byte that arrives between both reads. If we do not, the next read is the DMA's. So
//!
//! - When the line is idle we read only the status. The flag stays, so its interrupt is switched off. The DMA clears
//!   the flag with the next byte, because the USART cannot tell its reads from ours. Once the flag is clear, the next
//!   look for bytes (every millisecond) switches the interrupt on again. If some USART did tell the reads apart, the
//!   interrupt would stay off and bytes would be found a millisecond late. Nothing but time depends on it.
//! - After an error we do read the data, because an overrun receiver takes no more bytes before. That may swallow a
//!   byte, so [`Ring::mark_damage`](crate::ring::Ring::mark_damage) marks the next one too.
//! - Every read of the status is handled, wherever it happens: an unhandled read could clear an error unseen.
//!
//! | flag | set by | cleared by |
//! |---|---|---|
//! | at rest | one frame of silence after a byte | a read of the status, then the DMA's read of the next byte |
//! | error | a byte that is damaged or has no room | a read of the status, then our read of the data |

/// Flags, as one read of the status register finds them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Flags {
    /// The line has rested for a frame since the last byte.
    pub is_at_rest: bool,
    /// A byte was damaged or lost.
    pub is_damaged: bool,
}

/// The action that flags ask for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum News {
    /// Nothing.
    None,
    /// Bytes may be waiting, and nothing else will tell of them.
    Rest,
    /// The place in the ring is to be marked, now.
    Damage,
}

/// The registers.
pub trait Receiving {
    /// Reads the data register and discards its content.
    fn discard(&mut self);

    /// Whether a line at rest raises the interrupt.
    fn is_watching(&mut self) -> bool;

    /// Enables or disables the idle interrupt.
    fn watch(&mut self, rest: bool);
}

/// In the interrupt: answers a look.
#[inline]
pub fn answer(flags: Flags, registers: &mut impl Receiving) -> News {
    if flags.is_damaged {
        registers.discard();
        return News::Damage;
    }
    if flags.is_at_rest && registers.is_watching() {
        registers.watch(false);
        return News::Rest;
    }
    News::None
}

/// Whenever there was no byte to be taken, with the interrupt held off: answers a look that is made if the interrupt is
/// off.
#[inline]
pub fn watch_again<R: Receiving>(registers: &mut R, look: impl FnOnce(&mut R) -> Flags) -> News {
    if registers.is_watching() {
        return News::None;
    }
    let flags = look(registers);
    if !flags.is_at_rest {
        registers.watch(true);
    }
    answer(Flags { is_at_rest: false, ..flags }, registers)
}

#[cfg(test)]
#[path = "receiver_tests.rs"]
mod tests;
