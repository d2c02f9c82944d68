//! The budget of the QEMU image, which holds the whole core: what fits here fits the Octopus.

use super::Verdict;
use crate::checkout;
use crate::qemu::BOARD;
use anyhow::{Context as _, Result, bail};
use object::elf::{FileHeader32, SHF_ALLOC, SHT_NOBITS};
use object::read::elf::{ElfFile, ElfSection32};
use object::{Endianness, Object as _, ObjectSection as _, ObjectSymbol as _, SectionFlags};

/// A resource of the processor and how much of it may be used.
struct Budget {
    name: &'static str,
    bytes: u64,
    reason: &'static str,
}

/// Code, constants and initial values.
const FLASH: Budget = Budget {
    name: "flash",
    bytes: 192 * 1024,
    reason: "480 KiB behind the bootloader; drivers, heaters, settings storage and USB are still to come",
};

/// Static variables without the stack.
const RAM: Budget = Budget {
    name: "static RAM",
    bytes: 64 * 1024,
    reason: "128 KiB; a deeper look-ahead and the parts still to come need the other half",
};

/// The stack of all contexts together.
const STACK: Budget = Budget {
    name: "stack",
    bytes: 40 * 1024,
    reason: "start-up carries the core's parts through it; later all contexts together take 4 KiB",
};

/// Parts of names that no image may hold, and why.
const FORBIDDEN: [(&str, &str); 6] = [
    ("__rust_alloc", "all memory is static"),
    ("__rustc_alloc", "all memory is static"),
    ("__rg_alloc", "all memory is static"),
    ("__aeabi_d", "the processor has no double precision, and steps are integers"),
    ("__aeabi_f", "the processor computes single precision itself"),
    ("df3", "the processor has no double precision, and steps are integers"),
];

/// Weighs the image and looks for what should not be in it.
pub fn check() -> Result<Verdict> {
    let path = checkout::build_image(BOARD)?;
    let data = std::fs::read(&path).with_context(|| format!("cannot open {}", path.display()))?;
    let elf = ElfFile::<FileHeader32<Endianness>>::parse(&*data)?;
    let (mut flash, mut ram) = (0, 0);
    for section in elf.sections().filter(is_loaded) {
        let has_bytes = section.elf_section_header().sh_type.get(elf.endian()) != SHT_NOBITS;
        let is_written = matches!(section.name()?, ".data" | ".bss" | ".uninit");
        flash += if has_bytes { section.size() } else { 0 };
        ram += if is_written { section.size() } else { 0 };
    }
    let address = |name| elf.symbols().find(|symbol| symbol.name() == Ok(name)).map(|symbol| symbol.address());
    let stack = match (address("_stack_start"), address("_stack_end")) {
        (Some(start), Some(end)) => start - end,
        _ => bail!("the image does not say where its stack is"),
    };
    let mut excess = Vec::new();
    println!("{:<12} {:>8} {:>8}", "", "bytes", "budget");
    for (budget, bytes) in [(FLASH, flash), (RAM, ram), (STACK, stack)] {
        println!("{:<12} {bytes:>8} {:>8}  {}", budget.name, budget.bytes, budget.reason);
        if bytes > budget.bytes {
            excess.push(format!("{} is {} bytes over its budget", budget.name, bytes - budget.bytes));
        }
    }
    for name in elf.symbols().filter_map(|symbol| symbol.name().ok()) {
        if let Some((_, reason)) = FORBIDDEN.iter().find(|(part, _)| name.contains(part)) {
            excess.push(format!("{name} is in the image, but {reason}"));
        }
    }
    if !excess.is_empty() {
        bail!("{}", excess.join("; "));
    }
    Ok(Verdict::Passed(format!("{flash} bytes of flash, {ram} of RAM")))
}

/// Whether a section takes room on the processor.
fn is_loaded(section: &ElfSection32<'_, '_>) -> bool {
    matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & u64::from(SHF_ALLOC) != 0)
}
