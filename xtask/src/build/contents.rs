//! The contents of an image: their sizes, and symbols that it must not have.

use super::Elf;
use anyhow::{Result, bail};
use corehbot::gcode::Treatment;
use corehbot::machine;
use corehbot::settings::table;
use object::elf::{SHF_ALLOC, SHT_NOBITS};
use object::read::elf::ElfSection32;
use object::{Endianness, Object as _, ObjectSection as _, ObjectSymbol as _, SectionFlags};

/// A resource of the processor and how much of it may be used.
struct Budget {
    name: &'static str,
    bytes: u64,
    of: &'static str,
}

/// Code, constants and initial values.
const FLASH: Budget = Budget { name: "flash", bytes: 476 * 1024, of: "480 KiB after the bootloader" };

/// The same of QEMU's image, which has the plants of bed and heaters in it. No chip has to hold it.
const FLASH_WITH_PLANT: Budget = Budget { name: "flash", bytes: 542 * 1024, of: "544 KiB that it is linked for" };

/// Variables without the stack, which takes the 32 KiB that are left (memory.x). Second sensors took 400 bytes: their
/// limits in each copy of the settings, their filters and curves. The supply's switch and PTC took 200. Guards of
/// heat take 110 bytes for each heater since they compare it with its own first hour: 400, and 300 for its storing.
const RAM: Budget = Budget { name: "static RAM", bytes: 80_950, of: "128 KiB with the stack" };

/// Variables that do not begin as zeros: each has its first bytes in flash too. The queues and the status begin as
/// zeros, so they take none.
const FIRST_VALUES: Budget = Budget { name: "first values", bytes: 1024, of: "variables that are not zeros, in flash" };

/// Why an image has no doubles.
const DOUBLES: &str = "the processor has no double precision, and steps are integers";

/// Why a symbol must not be in an image, if it must not. The names belong to the Rust allocator and to the runtime
/// library's floating point (ARM RTABI, section 4.1.2; libgcc's names end in the mode of their operands).
fn objection(name: &str) -> Option<&'static str> {
    if ["__rust_alloc", "__rustc_alloc", "__rg_alloc"].iter().any(|part| name.contains(part)) {
        Some("all memory is static")
    } else if name.starts_with("__aeabi_d") || name.starts_with("__") && name.ends_with("df3") {
        Some(DOUBLES)
    } else if name.starts_with("__aeabi_f") {
        Some("the processor computes single precision itself")
    } else {
        None
    }
}

/// The sections that take memory, and whether each has bytes in flash.
fn allocated<'e, 'd>(elf: &'e Elf<'d>) -> impl Iterator<Item = (ElfSection32<'d, 'e, Endianness>, bool)> {
    let takes_memory = |section: &ElfSection32<'d, 'e, Endianness>| {
        let SectionFlags::Elf { sh_flags } = section.flags() else { return false };
        sh_flags & u64::from(SHF_ALLOC) != 0 && section.size() > 0
    };
    elf.sections().filter(takes_memory).map(|section| {
        let has_bytes = section.elf_section_header().sh_type.get(elf.endian()) != SHT_NOBITS;
        (section, has_bytes)
    })
}

/// All bytes of flash.
pub fn flash(elf: &Elf<'_>) -> u64 {
    allocated(elf).filter(|(_, has_bytes)| *has_bytes).map(|(section, _)| section.size()).sum()
}

/// Prints how much each part takes, and says which budget is exceeded.
pub fn weigh(elf: &Elf<'_>, has_plant: bool) -> Result<Vec<String>> {
    let (mut ram, mut first_values) = (0, 0);
    for (section, has_bytes) in allocated(elf) {
        let is_written = matches!(section.name()?, ".data" | ".bss" | ".uninit");
        ram += if is_written { section.size() } else { 0 };
        first_values += if is_written && has_bytes { section.size() } else { 0 };
        println!("{:<16} {:>8} at {:#010x}", section.name()?, section.size(), section.address());
    }
    let address = |name| elf.symbols().find(|symbol| symbol.name() == Ok(name)).map(|symbol| symbol.address());
    let (Some(start), Some(end)) = (address("_stack_start"), address("_stack_end")) else {
        bail!("the image does not say where its stack is");
    };
    println!("{:<16} {:>8} at {end:#010x}", "stack", start - end);
    let mut complaints = Vec::new();
    let of_flash = if has_plant { FLASH_WITH_PLANT } else { FLASH };
    for (budget, bytes) in [(of_flash, flash(elf)), (RAM, ram), (FIRST_VALUES, first_values)] {
        println!("{:<16} {bytes:>8} of {:>7} allowed ({})", budget.name, budget.bytes, budget.of);
        if bytes > budget.bytes {
            complaints.push(format!("{} is {} bytes over its budget", budget.name, bytes - budget.bytes));
        }
    }
    Ok(complaints)
}

/// Forbidden symbols in the image. QEMU's image `has_plant`: the heat plant in place of a machine computes in doubles,
/// as in the simulator.
pub fn forbidden(elf: &Elf<'_>, has_plant: bool) -> Vec<String> {
    let mut complaints = Vec::new();
    for name in elf.symbols().filter_map(|symbol| symbol.name().ok()) {
        if let Some(reason) = objection(name).filter(|reason| !has_plant || *reason != DOUBLES) {
            complaints.push(format!("{name} is in the image, but {reason}"));
        }
    }
    complaints.extend(texts_for_people(elf));
    complaints
}

/// Says which text for people is in the image: only programs on a computer show them, and all would take 14 KB.
fn texts_for_people(elf: &Elf<'_>) -> Option<String> {
    let sections: Vec<&[u8]> = allocated(elf).filter_map(|(section, _)| section.data().ok()).collect();
    let is_in_image = |line: &str| sections.iter().any(|bytes| has(bytes, line.as_bytes()));
    let line = texts().find(|line| line.len() > LONG && is_in_image(line))?;
    Some(format!("{line:?} is in the image, where it only costs flash"))
}

/// What settings mean, and what codes do. The reference to refused codes has the words of their answers.
fn texts() -> impl Iterator<Item = &'static str> {
    let settings = table::described().flat_map(|(_, text)| text.meaning.iter().copied());
    let codes = machine::described().filter(|line| line.text.treatment != Treatment::Refused);
    settings.chain(codes.map(|line| line.text.does))
}

/// Characters of a text that stands nowhere by chance.
const LONG: usize = 24;

/// Whether some bytes are in others.
fn has(bytes: &[u8], wanted: &[u8]) -> bool {
    bytes.windows(wanted.len()).any(|window| window == wanted)
}

#[cfg(test)]
mod tests {
    use super::{LONG, has, objection, texts};

    #[test]
    fn a_name_that_only_looks_like_arithmetic_is_none() {
        assert!(objection("__aeabi_dmul").is_some());
        assert!(objection("__adddf3").is_some());
        assert!(objection("_ZN8contexts13CONSOLE_WAKER17h434a119d3ddf3bf7E").is_none());
        assert!(objection("__aeabi_uldivmod").is_none());
    }

    #[test]
    fn a_meaning_would_be_found_among_other_bytes() {
        assert!(has(b"\0\x01 Steps a millimetre (M92).\0", b" Steps a millimetre (M92)."));
        assert!(!has(b"", b" Steps"));
        // Most settings and codes have a line that is long enough to be looked for.
        let long = texts().filter(|line| line.len() > LONG).count();
        assert!(long > 150, "{long}");
    }
}
