//! A step on the Octopus: the way of a plain event through the step interrupt of the image that is flashed.
//!
//! QEMU has no such board, so nothing runs here. The handler plays a plain event in a straight line, all of whose
//! branches lead elsewhere; the instructions up to its return are counted in the image.

use super::code::Code;
use super::cycles::{EXCEPTION, REFILL, cost};
use crate::build::instruction::{Kind, decode};
use anyhow::{Result, bail};

/// TIM2's vector: interrupt 28 behind 16 exceptions (RM0390, table 38).
const VECTOR: usize = 16 + 28;

/// More than this is no straight line.
const LONGEST: usize = 200;

/// What a plain event takes.
pub struct PlainStep {
    /// Instructions from the handler's first to its return.
    pub instructions: u64,
    /// Cycles with the exception's entry and return, by the costs of [`cost`].
    pub cycles: u64,
}

impl PlainStep {
    /// Follows the handler of an image.
    pub fn of(code: &Code<'_>) -> Result<Self> {
        let mut at = code.handler(VECTOR)?;
        let mut step = Self { instructions: 0, cycles: EXCEPTION };
        let mut follows_load = false;
        for _ in 0..LONGEST {
            let [first, second] = code.words(at);
            let cost = cost(first, second);
            step.instructions += 1;
            step.cycles += cost.cycles - u64::from(cost.is_load && follows_load);
            follows_load = cost.is_load;
            if is_return(first, second) {
                step.cycles += REFILL;
                return Ok(step);
            }
            // B in two bytes, and what leads elsewhere in four.
            if first >> 11 == 0b11100 || matches!(decode(first, second).kind, Kind::Branch(_) | Kind::Indirect) {
                bail!("the step interrupt jumps about at {at:#010x}: it is no straight line");
            }
            at += 2 * cost.length;
        }
        bail!("the step interrupt does not return within {LONGEST} instructions");
    }
}

/// POP, or LDM from SP, with PC; LDR of PC from SP; BX LR (ARM DDI 0403E, A7.7).
const fn is_return(first: u16, second: u16) -> bool {
    match first {
        0x4770 => true,
        0xE8BD => second & 0x8000 != 0,
        0xF85D => second & 0xF000 == 0xF000,
        _ => first & 0xFF00 == 0xBD00,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn returns_are_told_from_others() {
        assert!(is_return(0xBDF0, 0), "pop {{r4-r7, pc}}");
        assert!(is_return(0xE8BD, 0x81F0), "pop.w {{r4-r8, pc}}");
        assert!(is_return(0x4770, 0), "bx lr");
        assert!(!is_return(0xE8BD, 0x41F0), "pop.w {{r4-r8, lr}}");
        assert!(!is_return(0xB5F0, 0), "push");
        assert!(!is_return(0xF85D, 0x8B04), "ldr r8, [sp], #4");
    }
}
