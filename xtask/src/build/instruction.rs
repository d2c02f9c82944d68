//! Thumb instructions, as far as the step path is concerned (ARM DDI 0403E, A5).

/// The kinds of instructions that matter here.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Calls, or jumps to, a place this far from the instruction's address plus 4.
    Branch(i32),
    /// A call through a register.
    Indirect,
    /// UDIV or SDIV.
    Division,
    /// Uses the floating point unit.
    Float,
    /// Anything else.
    Other,
}

/// An instruction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Instruction {
    /// Its length in bytes.
    pub length: usize,
    /// Its kind.
    pub kind: Kind,
}

/// Decodes an instruction from its first and its next half word.
pub const fn decode(first: u16, second: u16) -> Instruction {
    // The five upper bits 0b11101, 0b11110 and 0b11111 begin an instruction of two half words.
    if first >> 11 < 0b11101 {
        // BLX register. BX is a return or, from a register other than LR, a tail call.
        let is_indirect = first & 0xFF87 == 0x4780 || (first & 0xFF87 == 0x4700 && first & 0x78 != 0x70);
        return Instruction { length: 2, kind: if is_indirect { Kind::Indirect } else { Kind::Other } };
    }
    let kind = if matches!(first & 0xFFF0, 0xFB90 | 0xFBB0) && second & 0xF0F0 == 0xF0F0 {
        Kind::Division
    } else if first & 0xEC00 == 0xEC00 && matches!(second & 0x0F00, 0x0A00 | 0x0B00) {
        Kind::Float
    } else if first & 0xF800 == 0xF000 && second & 0x9000 == 0x9000 {
        Kind::Branch(distance(first, second))
    } else {
        Kind::Other
    };
    Instruction { length: 4, kind }
}

/// How far BL and the unconditional B.W go (encodings T1 and T4).
const fn distance(first: u16, second: u16) -> i32 {
    let (first, second) = (first as u32, second as u32);
    let sign = first >> 10 & 1;
    let i1 = !(second >> 13 ^ sign) & 1;
    let i2 = !(second >> 11 ^ sign) & 1;
    let bits = sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1;
    (bits << 7).cast_signed() >> 7
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_of_interest_are_distinguished_from_others() {
        // Assembled by llvm-mc for a Cortex-M4.
        let cases = [
            ([0xFBB1, 0xF5F6], 4, Kind::Division),   // udiv r5, r1, r6
            ([0xFB91, 0xF5F6], 4, Kind::Division),   // sdiv r5, r1, r6
            ([0xFBA1, 0x2303], 4, Kind::Other),      // umull r2, r3, r1, r3
            ([0xFB05, 0x1116], 4, Kind::Other),      // mls r1, r5, r6, r1
            ([0xEE30, 0x0A20], 4, Kind::Float),      // vadd.f32 s0, s0, s1
            ([0xED2D, 0x8B02], 4, Kind::Float),      // vpush {d8}
            ([0xE92D, 0x0F00], 4, Kind::Other),      // push.w {r8, r9, r10, r11}
            ([0x47A0, 0x0000], 2, Kind::Indirect),   // blx r4
            ([0x4720, 0x0000], 2, Kind::Indirect),   // bx r4
            ([0x4770, 0x0000], 2, Kind::Other),      // bx lr
            ([0xF7FF, 0xFFFE], 4, Kind::Branch(-4)), // bl .
            ([0xF000, 0xB800], 4, Kind::Branch(0)),  // b.w .+4
            ([0xF000, 0x80AA], 4, Kind::Other),      // beq.w
            ([0xF3BF, 0x8F5F], 4, Kind::Other),      // dmb sy
        ];
        for ([first, second], length, kind) in cases {
            assert_eq!(decode(first, second), Instruction { length, kind }, "{first:04x} {second:04x}");
        }
    }
}
