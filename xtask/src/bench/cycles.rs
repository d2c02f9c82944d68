//! Cycles of a Cortex-M4 for an instruction from memory without wait states (ARM 100166, section 3.3).
//!
//! An estimate: costs that depend on data (division) or on neighbours (the pipeline's refill) have typical values.

/// Cycles of an exception from its request to the handler's first instruction, and from the return instruction to the
/// interrupted code: 12 and 10 (ARM 100166, 3.9, and ARM's article 103489845).
pub const EXCEPTION: u64 = 22;

/// Cycles for which the pipeline refills where an instruction leads elsewhere.
pub const REFILL: u64 = 2;

/// UDIV and SDIV take 2 to 12.
const DIVISION: u64 = 8;

/// VDIV.
const FLOAT_DIVISION: u64 = 14;

/// The cost of an instruction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cost {
    /// Cycles if it leads to the next one.
    pub cycles: u64,
    /// Whether it loads one register: another such load behind it takes a cycle less.
    pub is_load: bool,
    /// Half words.
    pub length: u64,
}

/// Costs of the instruction with these first and next half words.
pub const fn cost(first: u16, second: u16) -> Cost {
    if first >> 11 < 0b11101 { narrow(first) } else { wide(first, second) }
}

impl Cost {
    const fn narrow(cycles: u64) -> Self {
        Self { cycles, is_load: false, length: 1 }
    }

    const fn wide(cycles: u64) -> Self {
        Self { cycles, is_load: false, length: 2 }
    }

    const fn load(length: u64) -> Self {
        Self { cycles: 2, is_load: true, length }
    }
}

const fn narrow(first: u16) -> Cost {
    let several = 1 + (first as u8).count_ones() as u64;
    match first >> 11 {
        0b01001 | 0b01101 | 0b01111 | 0b10001 | 0b10011 => Cost::load(1),
        // Register offsets: the three stores come first.
        0b01010 | 0b01011 if first >> 9 & 7 >= 3 => Cost::load(1),
        0b11000 | 0b11001 => Cost::narrow(several),
        // PUSH and POP, with LR or PC as the ninth bit.
        0b10110 | 0b10111 if first >> 9 & 3 == 2 => Cost::narrow(several + (first >> 8 & 1) as u64),
        _ => Cost::narrow(1),
    }
}

const fn wide(first: u16, second: u16) -> Cost {
    match first {
        // LDM, STM, PUSH, POP.
        _ if first & 0xFE40 == 0xE800 => Cost::wide(1 + second.count_ones() as u64),
        // TBB and TBH; exclusive loads and stores; LDRD and STRD.
        _ if first & 0xFFF0 == 0xE8D0 && second & 0xFFE0 == 0xF000 => Cost::wide(2),
        _ if first & 0xFFE0 == 0xE840 || first & 0xFFE0 == 0xE8C0 => Cost::wide(2),
        _ if first & 0xFE40 == 0xE840 => Cost::wide(3),
        // LDR and its kin; STR takes one cycle.
        _ if first & 0xFE10 == 0xF810 => Cost::load(2),
        _ if matches!(first & 0xFFF0, 0xFB90 | 0xFBB0) => Cost::wide(DIVISION),
        // Barriers, and registers of the system.
        0xF3BF => Cost::wide(3),
        0xF3EF => Cost::wide(2),
        _ if first & 0xFFE0 == 0xF380 && second & 0xD000 == 0x8000 => Cost::wide(2),
        // VDIV; VLDR and VSTR; everything else.
        _ if first & 0xFFB0 == 0xEE80 && second & 0x0E00 == 0x0A00 => Cost::wide(FLOAT_DIVISION),
        _ if first & 0xFF20 == 0xED00 && second & 0x0E00 == 0x0A00 => Cost::wide(2),
        _ => Cost::wide(1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_those_of_the_manual() {
        // Assembled by llvm-mc for a Cortex-M4.
        let cases = [
            ([0x1840, 0], 1, false),       // adds r0, r0, r1
            ([0x6848, 0], 2, true),        // ldr r0, [r1, #4]
            ([0x6048, 0], 1, false),       // str r0, [r1, #4]
            ([0x5888, 0], 2, true),        // ldr r0, [r1, r2]
            ([0x5088, 0], 1, false),       // str r0, [r1, r2]
            ([0xB5F0, 0], 6, false),       // push {r4-r7, lr}
            ([0xBDF0, 0], 6, false),       // pop {r4-r7, pc}
            ([0xE92D, 0x0F00], 5, false),  // push.w {r8-r11}
            ([0xE9D0, 0x0102], 3, false),  // ldrd r0, r1, [r0, #8]
            ([0xE850, 0x1F00], 2, false),  // ldrex r1, [r0]
            ([0xF8D0, 0x1100], 2, true),   // ldr.w r1, [r0, #256]
            ([0xF8C0, 0x1100], 1, false),  // str.w r1, [r0, #256]
            ([0xFBB1, 0xF5F6], 8, false),  // udiv r5, r1, r6
            ([0xFBA1, 0x2303], 1, false),  // umull r2, r3, r1, r3
            ([0xEE30, 0x0A20], 1, false),  // vadd.f32 s0, s0, s1
            ([0xEE80, 0x0A20], 14, false), // vdiv.f32 s0, s0, s1
            ([0xF7FF, 0xFFFE], 1, false),  // bl .
        ];
        for ([first, second], cycles, is_load) in cases {
            let found = cost(first, second);
            assert_eq!((found.cycles, found.is_load), (cycles, is_load), "{first:04x} {second:04x}");
        }
    }
}
