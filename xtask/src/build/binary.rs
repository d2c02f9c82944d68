//! The binary: the content of flash, from its first byte to its last.

use super::Elf;
use anyhow::{Result, ensure};
use object::elf::PT_LOAD;
use object::read::elf::ProgramHeader as _;

/// Flash that is erased.
const ERASED: u8 = 0xFF;

/// The loaded segments in the order of their addresses, with gaps of at most `largest_gap` bytes, and their first
/// address.
pub fn extract(elf: &Elf<'_>, largest_gap: u32) -> Result<(u32, Vec<u8>)> {
    let endian = elf.endian();
    let mut parts = Vec::new();
    for header in elf.elf_program_headers() {
        if header.p_type(endian) == PT_LOAD && header.p_filesz(endian) > 0 {
            let bytes = header.data(endian, elf.data());
            ensure!(bytes.is_ok(), "a segment of the image lies outside of its file");
            parts.push((header.p_paddr(endian), bytes.unwrap_or_default()));
        }
    }
    parts.sort_by_key(|part| part.0);
    Ok((parts.first().map_or(0, |part| part.0), join(&parts, largest_gap)?))
}

fn join(parts: &[(u32, &[u8])], largest_gap: u32) -> Result<Vec<u8>> {
    let mut binary = Vec::new();
    let Some(start) = parts.first().map(|part| part.0) else { return Ok(binary) };
    for (address, bytes) in parts {
        let offset = (address - start) as usize;
        ensure!(offset >= binary.len(), "two segments of the image overlap at {address:#010x}");
        ensure!(offset - binary.len() <= largest_gap as usize, "the image has a hole before {address:#010x}");
        binary.resize(offset, ERASED);
        binary.extend_from_slice(bytes);
    }
    Ok(binary)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_stand_at_their_addresses() {
        let join = |parts: &[(u32, &[u8])]| join(parts, corehbot_boards::Package::ALIGNMENT);
        assert_eq!(join(&[(0x0800_8000, &[1, 2]), (0x0800_8004, &[3])]).unwrap(), [1, 2, 0xFF, 0xFF, 3]);
        assert!(join(&[(0, &[1, 2]), (1, &[3])]).is_err());
        assert!(join(&[(0, &[1]), (0x2000_0000, &[3])]).is_err());
    }
}
