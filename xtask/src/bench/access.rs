//! Accesses: the loads and stores of an instruction, and the values that it leaves in registers (ARM DDI 0403E, A5 and
//! A7.7).
//!
//! Only as far as a straight line needs it: an instruction that is not decoded here accesses nothing, and its result is
//! unknown.

/// Registers, r0 to r15; `Some` if the content is known.
pub type Registers = [Option<u32>; 16];

/// The program counter and the stack pointer.
const PC: usize = 15;
const SP: usize = 13;

/// A load or a store.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Access {
    /// The register that holds the address.
    pub base: usize,
    /// A register that is added.
    pub index: Option<usize>,
    /// Bytes that are added.
    pub offset: i32,
    /// Whether it stores.
    pub is_store: bool,
    /// Words, one behind the other.
    pub words: u64,
}

impl Access {
    const fn one(base: u16, offset: i32, is_store: bool) -> Self {
        Self { base: base as usize & 15, index: None, offset, is_store, words: 1 }
    }

    /// Where it goes to, if that is known. `at` is the instruction's address.
    pub fn address(&self, registers: &Registers, at: u64) -> Option<u32> {
        if self.index.is_some() {
            return None;
        }
        // A literal is found from the next instruction but one, at a whole word.
        let base = if self.base == PC { Some((at as u32 + 4) & !3) } else { registers[self.base] };
        base.map(|base| base.wrapping_add_signed(self.offset))
    }
}

/// The effect of an instruction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Effect {
    /// The load or store.
    pub access: Option<Access>,
    /// The registers that it writes, a bit each.
    pub written: u16,
    /// The register that holds a known value afterwards, and that value.
    pub known: Option<(usize, u32)>,
}

impl Effect {
    const NONE: Self = Self { access: None, written: 0, known: None };

    const fn writes(register: u16) -> Self {
        Self { written: 1 << (register & 15), ..Self::NONE }
    }

    const fn known(register: u16, value: u32) -> Self {
        Self { known: Some((register as usize & 15, value)), ..Self::writes(register) }
    }

    /// One register is loaded or stored.
    const fn access(access: Access, register: u16) -> Self {
        let written = if access.is_store { 0 } else { 1 << (register & 15) };
        Self { access: Some(access), written, known: None }
    }

    /// Some are; the base may change.
    const fn several(base: u16, list: u16, is_store: bool) -> Self {
        let access = Access { words: list.count_ones() as u64, ..Access::one(base, 0, is_store) };
        let written = if is_store { 0 } else { list } | if base == SP as u16 { 0 } else { 1 << base };
        Self { access: Some(access), written, known: None }
    }
}

/// The effect of the instruction with these first and next half words; `before` holds the registers.
pub fn effect(first: u16, second: u16, before: &Registers) -> Effect {
    if first >> 11 < 0b11101 { narrow(first, before) } else { wide(first, second, before) }
}

fn narrow(first: u16, before: &Registers) -> Effect {
    let (low, middle, high) = (first & 7, first >> 3 & 7, first >> 8 & 7);
    let five = i32::from(first >> 6 & 31);
    let offset = |size: i32, is_store| Effect::access(Access::one(middle, size * five, is_store), low);
    match first >> 11 {
        0b00100 => Effect::known(high, u32::from(first & 0xFF)),
        0b00101 => Effect::NONE,
        0b00000..=0b00011 => Effect::writes(low),
        0b00110 | 0b00111 | 0b10100 | 0b10101 => Effect::writes(high),
        // TST, CMP and CMN write nothing.
        0b01000 if first >> 10 & 1 == 0 => {
            if matches!(first >> 6 & 15, 8 | 10 | 11) {
                Effect::NONE
            } else {
                Effect::writes(low)
            }
        }
        0b01000 => {
            let (to, from) = (first >> 4 & 8 | low, first >> 3 & 15);
            match (first >> 8 & 3, before[usize::from(from)]) {
                (0b10, Some(value)) => Effect::known(to, value),
                (0b00 | 0b10, _) => Effect::writes(to),
                _ => Effect::NONE,
            }
        }
        0b01001 => Effect::access(Access::one(PC as u16, 4 * i32::from(first & 0xFF), false), high),
        0b01010 | 0b01011 => {
            let index = Some(usize::from(first >> 6 & 7));
            Effect::access(Access { index, ..Access::one(middle, 0, first >> 9 & 7 < 3) }, low)
        }
        0b01100 | 0b01101 => offset(4, first >> 11 & 1 == 0),
        0b01110 | 0b01111 => offset(1, first >> 11 & 1 == 0),
        0b10000 | 0b10001 => offset(2, first >> 11 & 1 == 0),
        0b10010 | 0b10011 => {
            Effect::access(Access::one(SP as u16, 4 * i32::from(first & 0xFF), first >> 11 & 1 == 0), high)
        }
        // PUSH and POP, with LR or PC as the ninth bit.
        0b10110 | 0b10111 if first >> 9 & 3 == 2 => {
            let is_store = first >> 11 & 1 == 0;
            let ninth = (first >> 8 & 1) << if is_store { 14 } else { 15 };
            Effect::several(SP as u16, first & 0xFF | ninth, is_store)
        }
        // Extensions and turns of bytes.
        0b10110 | 0b10111 if matches!(first >> 8, 0xB2 | 0xBA) => Effect::writes(low),
        0b11000 | 0b11001 => Effect::several(high, first & 0xFF, first >> 11 & 1 == 0),
        _ => Effect::NONE,
    }
}

fn wide(first: u16, second: u16, before: &Registers) -> Effect {
    let (base, is_store) = (first & 15, first >> 4 & 1 == 0);
    let (target, result) = (second >> 12, second >> 8 & 15);
    let sign = if first >> 7 & 1 == 1 { 1 } else { -1 };
    match first {
        _ if first & 0xFE40 == 0xE800 => Effect::several(base, second, is_store),
        _ if first & 0xFE40 == 0xE840 => {
            let access = Access { words: 2, ..Access::one(base, sign * 4 * i32::from(second & 0xFF), is_store) };
            let written = if is_store { 0 } else { 1 << target | 1 << result };
            Effect { access: Some(access), written, known: None }
        }
        _ if first & 0xFE00 == 0xF800 && base == PC as u16 => {
            Effect::access(Access::one(base, sign * i32::from(second & 0xFFF), false), target)
        }
        _ if first & 0xFE80 == 0xF880 => Effect::access(Access::one(base, i32::from(second & 0xFFF), is_store), target),
        // Offsets of 8 bits; without the tenth bit the base has changed only afterwards.
        _ if first & 0xFE00 == 0xF800 && second & 0x0800 != 0 => {
            let offset = i32::from(second & 0xFF) * if second & 0x200 != 0 { 1 } else { -1 };
            let offset = if second & 0x400 != 0 { offset } else { 0 };
            let effect = Effect::access(Access::one(base, offset, is_store), target);
            let changed = if second & 0x100 != 0 { 1 << base } else { 0 };
            Effect { written: effect.written | changed, ..effect }
        }
        _ if first & 0xFE00 == 0xF800 => {
            let index = Some(usize::from(second & 15));
            Effect::access(Access { index, ..Access::one(base, 0, is_store) }, target)
        }
        // MOVW, MOVT, MOV.
        _ if first & 0xFBF0 == 0xF240 => Effect::known(result, half(first, second)),
        _ if first & 0xFBF0 == 0xF2C0 => match before[usize::from(result)] {
            Some(low) => Effect::known(result, low & 0xFFFF | half(first, second) << 16),
            None => Effect::writes(result),
        },
        _ if first & 0xFBEF == 0xF04F => Effect::known(result, expanded(first, second)),
        // Products of 64 bits.
        _ if first & 0xFF80 == 0xFB80 => Effect { written: 1 << target | 1 << result, ..Effect::NONE },
        // Branches, and comparisons, which have no result register.
        _ if first & 0xF800 == 0xF000 && second & 0x8000 != 0 || result == PC as u16 => Effect::NONE,
        _ => Effect::writes(result),
    }
}

/// The 16 bits of MOVW and MOVT.
const fn half(first: u16, second: u16) -> u32 {
    let (first, second) = (first as u32, second as u32);
    (first & 15) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF
}

/// A constant of 12 bits (ThumbExpandImm, A5.3.2).
const fn expanded(first: u16, second: u16) -> u32 {
    let (first, second) = (first as u32, second as u32);
    let twelve = (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF;
    let byte = twelve & 0xFF;
    match twelve >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (byte | 0x80).rotate_right(twelve >> 7),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_and_stores_are_found() {
        // Assembled by llvm-mc for a Cortex-M4.
        let cases = [
            ([0x6188, 0], Some((1, 24, true, 1)), 0),             // str r0, [r1, #24]
            ([0xF8CE, 0x4018], Some((14, 24, true, 1)), 0),       // str.w r4, [lr, #24]
            ([0x6948, 0], Some((1, 20, false, 1)), 1),            // ldr r0, [r1, #20]
            ([0xE9D0, 0x640C], Some((0, 48, false, 2)), 0x50),    // ldrd r6, r4, [r0, #48]
            ([0xE940, 0x1204], Some((0, -16, true, 2)), 0),       // strd r1, r2, [r0, #-16]
            ([0xB5F0, 0], Some((13, 0, true, 5)), 0),             // push {r4-r7, lr}
            ([0xE89E, 0x400A], Some((14, 0, false, 3)), 0x400A),  // ldm.w lr, {r1, r3, lr}
            ([0xF84D, 0x8D04], Some((13, -4, true, 1)), 1 << 13), // str r8, [sp, #-4]!
            ([0xF854, 0x0C04], Some((4, -4, false, 1)), 1),       // ldr r0, [r4, #-4]
            ([0x4823, 0], Some((15, 140, false, 1)), 1),          // ldr r0, [pc, #140]
            ([0x1840, 0], None, 1),                               // adds r0, r0, r1
            ([0xEB02, 0x05C2], None, 1 << 5),                     // add.w r5, r2, r2, lsl #3
            ([0xEBB2, 0x4F14], None, 0),                          // cmp.w r2, r4, lsr #16
            ([0xD134, 0], None, 0),                               // bne
        ];
        for ([first, second], access, written) in cases {
            let found = effect(first, second, &[None; 16]);
            let seen = found.access.map(|a| (a.base, a.offset, a.is_store, a.words));
            let mask = if access.is_some_and(|a| a.0 == 14) { found.written & written } else { found.written };
            assert_eq!((seen, mask), (access, written), "{first:04x} {second:04x}");
        }
    }

    #[test]
    fn constants_are_followed() {
        let mut registers = [None; 16];
        // mov.w r1, #0xE000E000; movw r2, #0x1000; movt r2, #0xE000; mov r8, r1; movs r0, #7
        for [first, second] in [[0xF04F, 0x21E0], [0xF241, 0x0200], [0xF2CE, 0x0200], [0x4688, 0], [0x2007, 0]] {
            if let Some((register, value)) = effect(first, second, &registers).known {
                registers[register] = Some(value);
            }
        }
        let expected = [Some(7), Some(0xE000_E000), Some(0xE000_1000)];
        assert_eq!((&registers[..3], registers[8]), (&expected[..], Some(0xE000_E000)));
        let load = effect(0x6948, 0, &registers).access.unwrap();
        assert_eq!(load.address(&registers, 0), Some(0xE000_E014));
        let literal = effect(0x4823, 0, &registers).access.unwrap();
        assert_eq!(literal.address(&registers, 0x0801_65FE), Some(0x0801_668C));
    }
}
