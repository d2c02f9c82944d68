//! Traps: faults that happen in mid-motion, in code that is otherwise the image's own.
//!
//! A sound image cannot be made to panic or hang. So a jump replaces the first instructions of a context's
//! handler. It leads to a few instructions of ours, in flash that the image leaves free. These read a word in memory
//! that the model has and the F446 lacks. As long as the word is 0, they return to the handler.

use crate::firmware::{Firmware, branch};
use anyhow::{Result, bail};

/// Where the extra instructions lie: the last 4 KiB of flash.
const PLACE: u32 = 0x0807_F000;

/// The word that springs the trap: just beyond the RAM of the F446.
pub const TRIGGER: u32 = 0x2002_0000;

/// The core library's panic, which every image has. The image's handler reads no argument.
const PANIC: &str = "panic_fmt";

/// Interrupt control and state register: bit 31 pends the NMI (ARM DDI 0403E, B3.2.4).
const ICSR: u32 = 0xE000_ED04;

/// Interrupt set-pending register 0 (ARM DDI 0403E, B3.4.5): the supply's detector is interrupt 1 (RM0390, vector
/// table).
const ISPR: u32 = 0xE000_E200;

/// Where a context goes that has fallen into the trap.
pub const FALLEN: u32 = PLACE + 24;

/// The call of the panic there, as the image names it: within the instruction.
pub const PANIC_CALL: u32 = FALLEN + 2;

/// The place of a trap: the beginning of code that a context runs again and again.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Place {
    /// The step interrupt.
    Stepper,
    /// The step generator's.
    Generator,
    /// The control period.
    Thermal,
    /// The Console, where it sends orders to the control period: in thread mode, at every turn.
    Console,
}

impl Place {
    /// The function's symbol.
    const fn symbol(self) -> &'static str {
        match self {
            Self::Stepper => "SysTick",
            Self::Generator => "CAN2_SCE",
            Self::Thermal => "TIM5",
            Self::Console => "send_orders",
        }
    }
}

/// The effect of the trap.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Trap {
    /// `udf`
    IllegalInstruction,
    /// A read where nothing may be accessed: below RAM.
    BadPointer,
    /// Two words that are read at an odd address.
    Unaligned,
    /// A jump into data.
    ExecuteRam,
    /// A call of a function pointer that is 0.
    ExecuteZero,
    /// A loop without end.
    Hang,
    /// The same with all interrupts masked.
    MaskedHang,
    /// A panic.
    Panic,
    /// Pushes without end.
    StackOverflow,
    /// The exception that reports a stopped crystal (RM0390 rev 6, section 6.2.7). The model falls back to its own
    /// oscillator, but raises no exception, so the code pends it.
    ClockFailure,
    /// The supply falls below the level of its detector. The model has the detector, but no line from it to the
    /// processor, so the code pends the interrupt, if [`crate::watch`] has found detector and line armed.
    SupplyFalls,
}

/// An address in the middle of RAM, and one just below it.
const IN_RAM: u32 = 0x2001_0000;
const BELOW_RAM: u32 = 0x1FFF_FF00;

/// A loop without end that does nothing. The emulator takes a twentieth of the time for it that it takes for a lone
/// branch to itself.
fn endless() -> impl Iterator<Item = u16> {
    const NOPS: u16 = 500;
    // B, encoding T2, to where the loop begins (ARMv7-M manual, A7.7.12).
    let back = 0xE000 | (NOPS + 2).wrapping_neg() & 0x7FF;
    std::iter::repeat_n(0xBF00, NOPS.into()).chain([back])
}

/// The replacement for the first instructions of `handler`, and the code for [`PLACE`].
fn detour(trap: Trap, handler: u32, panic: u32, first: [u16; 2]) -> ([u16; 2], Vec<u16>) {
    let [a, b] = branch(PLACE + 14, handler + 4);
    let mut code = vec![
        0xB401, // push {r0}
        0x4804, // ldr r0, =TRIGGER
        0x6800, // ldr r0, [r0]
        0xB938, // cbnz r0, trap
        0xBC01, // pop {r0}
        first[0], first[1], a, b, // b.w handler + 4
        0xBF00,
    ];
    let word = |code: &mut Vec<u16>, word: u32| code.extend([word as u16, (word >> 16) as u16]);
    word(&mut code, TRIGGER);
    match trap {
        Trap::IllegalInstruction => code.push(0xDE00),
        Trap::Hang => code.extend(endless()),
        // cpsid i
        Trap::MaskedHang => {
            code.push(0xB672);
            code.extend(endless());
        }
        // ldr r0, =address; ldr r0, [r0]; b .
        Trap::BadPointer => {
            code.extend([0x4802, 0x6800, 0xE7FE, 0xBF00, 0xBF00, 0xBF00]);
            word(&mut code, BELOW_RAM);
        }
        // ldr r0, =address; ldrd r0, r1, [r0]; b .
        Trap::Unaligned => {
            code.extend([0x4802, 0xE9D0, 0x0100, 0xE7FE, 0xBF00, 0xBF00]);
            word(&mut code, IN_RAM + 1);
        }
        // ldr r0, =address; bx r0
        Trap::ExecuteRam => {
            code.extend([0x4802, 0x4700, 0xBF00, 0xBF00, 0xBF00, 0xBF00]);
            word(&mut code, IN_RAM + 1);
        }
        // movs r0, #0; bx r0
        Trap::ExecuteZero => code.extend([0x2000, 0x4700]),
        // push {r0-r7}; b .-2
        Trap::StackOverflow => code.extend([0xB4FF, 0xE7FD]),
        Trap::ClockFailure => {
            // ldr r0, =ICSR; movs r1, #1; lsls r1, #31; str r1, [r0]; b .; nop
            code.extend([0x4802, 0x2101, 0x07C9, 0x6001, 0xE7FE, 0xBF00]);
            word(&mut code, ICSR);
        }
        Trap::SupplyFalls => {
            // ldr r0, =ISPR; movs r1, #2; str r1, [r0]; b to the pop; nop; nop: an interrupt of the same priority
            // waits.
            code.extend([0x4802, 0x2102, 0x6001, 0xE7F3, 0xBF00, 0xBF00]);
            word(&mut code, ISPR);
        }
        Trap::Panic => {
            // A call: BL differs from B.W in a bit (ARMv7-M manual, A7.7.12 and A7.7.18).
            let [first, second] = branch(FALLEN, panic);
            code.extend([first, second | 0x4000]);
        }
    }
    (branch(handler, PLACE), code)
}

impl Firmware {
    /// Lays a trap into the step interrupt: the running code then differs from the file.
    ///
    /// # Errors
    /// If the image has no such interrupt, or one that begins unexpectedly.
    pub fn lay(&mut self, trap: Trap) -> Result<()> {
        self.lay_in(Place::Stepper, trap)
    }

    /// Lays a trap into a context.
    ///
    /// # Errors
    /// If the image has no such function, or one that begins unexpectedly.
    pub fn lay_in(&mut self, place: Place, trap: Trap) -> Result<()> {
        let handler = self.symbol(place.symbol())?;
        let panic = if trap == Trap::Panic { self.symbol(PANIC)? } else { 0 };
        let first = [self.halfword(handler)?, self.halfword(handler + 2)?];
        // Only instructions that do the same elsewhere: `push` and `add r7, sp` or `mov r7, sp`, or the long `push`.
        let is_short = first[0] >> 8 == 0xB5 && (first[1] >> 8 == 0xAF || first[1] == 0x466F);
        if !(first[0] == 0xE92D || is_short) {
            bail!("{} begins with {first:04x?}", place.symbol());
        }
        let (begin, code) = detour(trap, handler, panic, first);
        self.patch(handler, &begin)?;
        self.add(PLACE, code.iter().flat_map(|c| c.to_le_bytes()).collect());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_literals_lie_where_the_code_looks_for_them() {
        let (_, code) = detour(Trap::Panic, 0x0801_0000, 0x0801_1000, [0xB5F0, 0xAF03]);
        let word = |at: usize| u32::from(code[at / 2]) | u32::from(code[at / 2 + 1]) << 16;
        assert_eq!(word(20), TRIGGER);
        // llvm-mc: `bl` from there to 0x08011000 is f791 fff2.
        assert_eq!(code[12..], [0xF791, 0xFFF2]);
        for (trap, wanted) in
            [(Trap::BadPointer, BELOW_RAM), (Trap::Unaligned, IN_RAM + 1), (Trap::ExecuteRam, IN_RAM + 1)]
        {
            let (_, code) = detour(trap, 0x0801_0000, 0, [0xB5F0, 0xAF03]);
            assert_eq!(u32::from(code[18]) | u32::from(code[19]) << 16, wanted);
        }
        // arm-none-eabi-as: `b .` is e7fe; this branch goes back by 500 halfwords more.
        assert_eq!(endless().last(), Some(0xE7FE - 500));
        let (_, code) = detour(Trap::ClockFailure, 0x0801_0000, 0, [0xB5F0, 0xAF03]);
        assert_eq!(u32::from(code[18]) | u32::from(code[19]) << 16, ICSR);
        let (_, code) = detour(Trap::SupplyFalls, 0x0801_0000, 0, [0xB5F0, 0xAF03]);
        assert_eq!(u32::from(code[18]) | u32::from(code[19]) << 16, ISPR);
    }
}
