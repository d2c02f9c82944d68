//! What is done with the flags of a USART's receiver, when the DMA takes its bytes.
//!
//! Whoever reads the status register and then the data register takes the flags back that stood at the first reading:
//! that the line rests, and errors (RM0390, 25.6.1: IDLE, ORE, NF, FE). But the data register is the DMA's. A byte that
//! arrives between both readings is swallowed if we read it, and the next reading is the DMA's only if we do not. So
//!
//! - when the line rests we read the status and nothing else. The flag stays, so its interrupt is switched off; the DMA
//!   takes the flag back with the next byte, for the USART cannot tell its readings from ours, and when the flag has gone,
//!   the interrupt is switched on again, by whoever looks for bytes (every millisecond). If some USART did tell them
//!   apart, the interrupt would stay off and bytes be found a millisecond late: nothing depends on it but time.
//! - after an error we do read the data: a receiver that was overrun takes no more bytes before. A byte may be
//!   swallowed
//!   by that, which is why [`Ring::mark_damage`](crate::ring::Ring::mark_damage) marks the next one too.
//! - every look at the status is answered, whoever looks: a look without an answer could take back an error unseen.
//!
//! | flag | set by | taken back by |
//! |---|---|---|
//! | at rest | one frame of silence after a byte | a look, then the DMA's reading of the next byte |
//! | error | a byte that is damaged or has no room | a look, then our reading of the data |

/// Flags, as one look at the status register finds them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Flags {
    /// The line has rested for a frame since the last byte.
    pub is_at_rest: bool,
    /// A byte was damaged or lost.
    pub is_damaged: bool,
}

/// What a look at them asks for.
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
    /// Reads the data register, and throws away what was in it.
    fn discard(&mut self);

    /// Whether a line at rest raises the interrupt.
    fn is_watching(&mut self) -> bool;

    /// Has a line at rest raise the interrupt, or not.
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
