//! The step path: the code that the step interrupt can reach, and its forbidden contents.
//!
//! The handler and all functions that it calls are decoded. Code that leads to a panic ends the run and does not count.

use super::Elf;
use super::instruction::{Kind, decode};
use anyhow::{Context as _, Result};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SymbolKind};
use std::collections::BTreeMap;

/// The handler of the step timer, which is the core's own.
const HANDLER: &str = "SysTick";

/// Most bytes of the handler itself, which plays the plain events, nineteen of twenty. They are 11 of the 64 lines of
/// 16 bytes in the flash's cache (RM0390, 3.4.2), so that the generator's loops leave it there.
const LARGEST_HANDLER: u64 = 176;

/// Most bytes of the whole path: an eighth more than the cache holds, because a closely checked event does not go
/// through all of it.
const LARGEST: u64 = 1184;

/// The size of the path as text, and its problems.
pub fn examine(elf: &Elf<'_>) -> Result<(String, Vec<String>)> {
    let functions = functions(elf);
    let text = elf.section_by_name(".text").context("the image has no code")?;
    let (start, code) = (text.address(), text.data()?);
    let data = data_ranges(elf);
    let handler = functions.iter().find(|(_, (name, _))| *name == HANDLER);
    let mut waiting = vec![*handler.with_context(|| format!("the image has no {HANDLER}"))?.0];
    let mut seen: Vec<u64> = Vec::new();
    let mut complaints = Vec::new();
    let mut bytes = 0;
    while let Some(address) = waiting.pop() {
        let Some(&(name, size)) = functions.get(&address) else {
            complaints.push(format!("the step path leads to {address:#010x}, where no function is"));
            continue;
        };
        if seen.contains(&address) || name.contains("panic") {
            continue;
        }
        seen.push(address);
        bytes += size;
        if name == HANDLER && size > LARGEST_HANDLER {
            complaints.push(format!("{HANDLER} has {size} bytes, {LARGEST_HANDLER} are allowed"));
        }
        let end = address + size;
        let mut at = address;
        while at < end {
            if let Some(range) = data.iter().find(|range| range.contains(&at)) {
                at = range.end;
                continue;
            }
            let offset = (at - start) as usize;
            let half = |offset| code.get(offset..offset + 2).map_or(0, |word| u16::from_le_bytes([word[0], word[1]]));
            let instruction = decode(half(offset), half(offset + 2));
            let complain = |what: &str| format!("the step path has {what} at {at:#010x} in {name}");
            match instruction.kind {
                Kind::Division => complaints.push(complain("a division")),
                Kind::Float => complaints.push(complain("floating point")),
                Kind::Indirect => complaints.push(complain("a call through a pointer")),
                Kind::Branch(distance) => {
                    let target = at.wrapping_add_signed(4 + i64::from(distance));
                    if !(address..end).contains(&target) {
                        waiting.push(target);
                    }
                }
                Kind::Other => {}
            }
            at += instruction.length as u64;
        }
    }
    if bytes > LARGEST {
        complaints.push(format!("the step path has {bytes} bytes, {LARGEST} are allowed"));
    }
    let verdict =
        if complaints.is_empty() { "no division, float or call through a pointer" } else { "not as it must be" };
    Ok((
        format!("{:<16} {bytes:>8} of {LARGEST:>8} allowed, in {} function(s): {verdict}", "step path", seen.len()),
        complaints,
    ))
}

/// All functions of an image by their addresses: names, and sizes in bytes.
pub fn functions<'d>(elf: &Elf<'d>) -> BTreeMap<u64, (&'d str, u64)> {
    let code = elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0);
    // The lowest bit marks Thumb code.
    code.map(|symbol| (symbol.address() & !1, (symbol.name().unwrap_or_default(), symbol.size()))).collect()
}

/// Constants amid the code, which mapping symbols tell from it (`$d` begins them, `$t` ends them).
fn data_ranges(elf: &Elf<'_>) -> Vec<std::ops::Range<u64>> {
    let mut marks: Vec<(u64, bool)> = Vec::new();
    for symbol in elf.symbols() {
        match symbol.name() {
            Ok(name) if name == "$t" || name.starts_with("$t.") => marks.push((symbol.address() & !1, false)),
            Ok(name) if name == "$d" || name.starts_with("$d.") => marks.push((symbol.address() & !1, true)),
            _ => {}
        }
    }
    marks.sort_unstable();
    let ends = marks.iter().skip(1).map(|mark| mark.0).chain([u64::MAX]);
    marks.iter().zip(ends).filter(|(mark, _)| mark.1).map(|(mark, end)| mark.0..end).collect()
}
