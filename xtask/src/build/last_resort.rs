//! The last resort: how many instructions lead from the entry of a fault's handler to heaters that are low.
//!
//! The limit is fifty instructions, without a loop. Every path of a fault begins with the same function, which lowers
//! the heaters' pins. The count runs from the handler's first instruction, along calls and long jumps, to the last one
//! of that function. Skipped code (behind a branch that is not taken) counts too, so the number is an upper bound, as
//! long as nothing on the path branches back.

use super::Elf;
use super::instruction::{Kind, decode};
use super::step_path::functions;
use anyhow::{Context as _, Result};
use object::{Object as _, ObjectSection as _};

/// The function that lowers them.
const LOWER: &str = "lower_heaters";

/// Handlers, by a part of their symbols: panics, HardFault with the overflow of the stack, NMI, interrupts that were
/// never enabled, the supply's detector.
const HANDLERS: [&str; 5] = ["rust_begin_unwind", "HardFault", "NonMaskableInt", "DefaultHandler", "PVD"];

/// Instructions that may lead there.
const MOST: usize = 50;

/// The length of the longest path as text, and the problems of the paths.
pub fn examine(elf: &Elf<'_>) -> Result<(String, Vec<String>)> {
    let (longest, complaints) = longest_way(elf)?;
    let report =
        format!("{:<16} {longest:>8} of {MOST:>8} instructions from a fault to heaters that are low", "last resort");
    Ok((report, complaints))
}

/// The length of the longest path in instructions, and the problems of the paths.
pub fn longest_way(elf: &Elf<'_>) -> Result<(usize, Vec<String>)> {
    let functions = functions(elf);
    let text = elf.section_by_name(".text").context("the image has no code")?;
    let (start, code) = (text.address(), text.data()?);
    let half = |at: u64| {
        let offset = (at - start) as usize;
        code.get(offset..offset + 2).map_or(0, |word| u16::from_le_bytes([word[0], word[1]]))
    };
    let find =
        |part: &str| functions.iter().find(|(_, (name, _))| *name == part || part.len() > 9 && name.contains(part));
    let (&target, _) = find(LOWER).with_context(|| format!("the image has no {LOWER}"))?;
    let mut longest = 0;
    let mut complaints = Vec::new();
    for handler in HANDLERS {
        let Some((&entry, _)) = find(handler) else {
            complaints.push(format!("the image has no {handler}"));
            continue;
        };
        let (mut at, mut begin, mut count) = (entry, entry, 0);
        let arrives = loop {
            let Some(&(_, size)) = functions.get(&begin).filter(|(_, size)| at < begin + size) else { break false };
            let first = half(at);
            let instruction = decode(first, half(at + 2));
            count += 1;
            if begin == target && is_return(first) {
                break true;
            }
            if count > 2 * MOST || goes_back(first) {
                break false;
            }
            at += instruction.length as u64;
            match instruction.kind {
                Kind::Branch(distance) => {
                    at = at.wrapping_add_signed(i64::from(distance) - instruction.length as i64 + 4);
                    begin = at;
                }
                _ if begin == target && at == begin + size => break true,
                Kind::Indirect => break false,
                _ => {}
            }
        };
        if !arrives || count > MOST {
            complaints.push(format!("{handler} does not lower the heaters within {MOST} instructions: {count} so far"));
        }
        longest = longest.max(count);
    }
    Ok((longest, complaints))
}

/// Whether it returns: `bx lr`, or `pop` with the program counter (ARM DDI 0403E, A7.7.20 and A7.7.99).
const fn is_return(first: u16) -> bool {
    first == 0x4770 || first >> 8 == 0xBD
}

/// Whether a short branch goes back: a loop (ARM DDI 0403E, A7.7.12, encodings T1 and T2: the sign is the highest bit
/// of the distance).
const fn goes_back(first: u16) -> bool {
    (first >> 12 == 0xD && first & 0x80 != 0 && first >> 8 & 0xF < 0xE)
        || (first >> 11 == 0b11100 && first & 0x400 != 0)
}

#[cfg(test)]
mod tests {
    use super::{goes_back, is_return};

    #[test]
    fn returns_are_told_from_other_instructions() {
        assert!([0x4770, 0xBD80, 0xBDF0].into_iter().all(is_return));
        assert!([0xBC80, 0x4718, 0xB580].into_iter().all(|other| !is_return(other)));
    }

    #[test]
    fn loops_are_told_from_other_branches() {
        // b .-2, bne .-6; b .+4, bne .+4, svc, push.
        assert!(goes_back(0xE7FD) && goes_back(0xD1FB));
        assert!([0xE000, 0xD100, 0xDFFF, 0xB5F0].into_iter().all(|other| !goes_back(other)));
    }
}
