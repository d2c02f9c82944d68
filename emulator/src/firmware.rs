//! The image under test: an ELF file, exactly as the build made it, after a stand-in for the bootloader.
//!
//! A test may change single words of the copy in memory, to cause a fault that a sound image cannot have. The digest is
//! always the digest of the unchanged file.

use crate::bootloader::{Bootloader, RESET};
use crate::wiring::Wiring;
use anyhow::{Context, Result, bail};
use corehbot::settings::Settings;
use corehbot_host::image;
use object::read::elf::ElfFile32;
use object::{Object, ObjectSegment, ObjectSymbol};
use rigless::image::Image;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Flash and RAM of the STM32F446xE (RM0390 rev 6, section 2.2.2): the model has more of both.
const FLASH: std::ops::Range<u64> = 0x0800_0000..0x0808_0000;
const RAM: std::ops::Range<u64> = 0x2000_0000..0x2002_0000;

/// An image ready to run.
#[derive(Clone, Debug)]
pub struct Firmware {
    /// The file.
    pub path: PathBuf,
    /// Its SHA-256 in hexadecimal.
    pub sha256: String,
    /// The bootloader in front of it.
    pub bootloader: Bootloader,
    bytes: Vec<u8>,
    /// Bytes in addition to the image.
    extra: Vec<(u32, Vec<u8>)>,
}

impl Firmware {
    /// Reads the ELF file at `path`.
    ///
    /// # Errors
    /// If it cannot be read or holds anything outside the memory of the chip.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).with_context(|| format!("cannot open {}", path.display()))?;
        let sha256 = Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
        let firmware = Self { path: path.to_owned(), sha256, bootloader: Bootloader::Btt, bytes, extra: Vec::new() };
        for segment in firmware.file()?.segments() {
            let (start, end) = (segment.address(), segment.address() + segment.size());
            if !(inside(&FLASH, start, end) || inside(&RAM, start, end)) {
                bail!("{}: {start:#x} to {end:#x} is no memory of the STM32F446xE", path.display());
            }
        }
        Ok(firmware)
    }

    /// The initial memory; a firmware that needs a bootloader gets it in front.
    ///
    /// # Errors
    /// If the file is not an ELF file.
    pub fn images(&self, wiring: &Wiring) -> Result<Vec<Image>> {
        let mut images = vec![Image::new(&self.path, self.bytes.clone(), None)?];
        if wiring.application != RESET {
            images.push(Image::new(
                Path::new("bootloader"),
                self.bootloader.image(wiring.application),
                Some(RESET.into()),
            )?);
        }
        for (address, bytes) in &self.extra {
            images.push(Image::new(Path::new("extra"), bytes.clone(), Some((*address).into()))?);
        }
        Ok(images)
    }

    /// The address of a symbol, without the Thumb bit.
    ///
    /// # Errors
    /// If the image has no such symbol.
    pub fn symbol(&self, name: &str) -> Result<u32> {
        // As Rust mangles it: its length, then itself.
        let mangled = format!("{}{name}", name.len());
        let file = self.file()?;
        let found = file.symbols().find(|s| s.name().is_ok_and(|n| n == name || n.contains(&mangled)));
        let address = found.with_context(|| format!("the image has no symbol {name}"))?.address();
        Ok(address as u32 & !1)
    }

    /// Where the code of the function `name` is.
    ///
    /// # Errors
    /// If the image has no such function.
    pub fn function(&self, name: &str) -> Result<std::ops::Range<u64>> {
        let begin = u64::from(self.symbol(name)?);
        let file = self.file()?;
        let found = file.symbols().find(|s| s.name() == Ok(name));
        Ok(begin..begin + found.with_context(|| format!("the image has no function {name}"))?.size())
    }

    /// Puts `halfwords` over the code at `address`: the running code then differs from the file.
    ///
    /// # Errors
    /// If the image has nothing there.
    pub fn patch(&mut self, address: u32, halfwords: &[u16]) -> Result<()> {
        let offset = self.offset(address)?;
        let place = self.bytes.get_mut(offset..offset + 2 * halfwords.len()).context("beyond the image")?;
        for (cell, halfword) in place.chunks_exact_mut(2).zip(halfwords) {
            cell.copy_from_slice(&halfword.to_le_bytes());
        }
        Ok(())
    }

    /// Puts a machine into the image, as `corehbot image` does.
    ///
    /// # Errors
    /// If the image has no place for it, or its board no such connectors.
    pub fn put_machine(&mut self, machine: &mut Settings) -> Result<()> {
        image::put(&mut self.bytes, machine).map(|_| ())
    }

    /// Puts the image on another of its boards, as `corehbot image --board` does.
    ///
    /// # Errors
    /// If it may not be on that board.
    pub fn set_board(&mut self, key: &str) -> Result<()> {
        image::set_board(&mut self.bytes, key)
    }

    /// Puts `bytes` into flash in addition to the image.
    pub fn add(&mut self, address: u32, bytes: Vec<u8>) {
        self.extra.push((address, bytes));
    }

    /// The code at `address`.
    ///
    /// # Errors
    /// If the image has nothing there.
    pub fn halfword(&self, address: u32) -> Result<u16> {
        let offset = self.offset(address)?;
        match self.bytes.get(offset..offset + 2) {
            Some(&[low, high]) => Ok(u16::from_le_bytes([low, high])),
            _ => bail!("beyond the image"),
        }
    }

    /// The firmware's sum over its own image: FNV-1a over the words of code and constants (`image::sum` of
    /// chips/stm32f446). Patched words count.
    ///
    /// # Errors
    /// If the image does not say where they begin and end.
    pub fn sum(&self) -> Result<u32> {
        let (from, to) = (self.symbol("__stext")?, self.symbol("__erodata")?);
        // The bytes between both are erased flash.
        let mut flash = vec![0xFF; ((to & !3) - from) as usize];
        for segment in self.file()?.segments() {
            for (address, byte) in (segment.address()..).zip(segment.data()?) {
                let place = address.checked_sub(from.into()).and_then(|place| usize::try_from(place).ok());
                if let Some(cell) = place.and_then(|place| flash.get_mut(place)) {
                    *cell = *byte;
                }
            }
        }
        let words = flash.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word));
        Ok(words.fold(0x811C_9DC5, |sum: u32, word| (sum ^ word).wrapping_mul(0x0100_0193)))
    }

    /// The place in the file of the bytes for `address`.
    fn offset(&self, address: u32) -> Result<usize> {
        let at = u64::from(address);
        let found = self.file()?.segments().find_map(|segment| {
            let (offset, size) = segment.file_range();
            let begin = segment.address();
            (begin..begin + size).contains(&at).then(|| (offset + at - begin) as usize)
        });
        found.with_context(|| format!("the image has nothing at {address:#x}"))
    }

    fn file(&self) -> Result<ElfFile32<'_>> {
        ElfFile32::parse(self.bytes.as_slice()).with_context(|| format!("{} is not an ELF file", self.path.display()))
    }
}

fn inside(memory: &std::ops::Range<u64>, start: u64, end: u64) -> bool {
    memory.contains(&start) && end <= memory.end
}

/// `B.W` from `from` to `to` (ARMv7-M manual, A7.7.12, encoding T4).
#[must_use]
pub const fn branch(from: u32, to: u32) -> [u16; 2] {
    let offset = to.wrapping_sub(from.wrapping_add(4));
    let s = offset >> 31 & 1;
    let (i1, i2) = (offset >> 23 & 1, offset >> 22 & 1);
    let (j1, j2) = (1 ^ i1 ^ s, 1 ^ i2 ^ s);
    let high = 0xF000 | s << 10 | offset >> 12 & 0x3FF;
    let low = 0x9000 | j1 << 13 | j2 << 11 | offset >> 1 & 0x7FF;
    [high as u16, low as u16]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_are_encoded_as_the_assembler_does() {
        // arm-none-eabi-as: `b.w .` is f7ff bffe, `b.w .+4` is f000 b800.
        assert_eq!(branch(0x0800_8000, 0x0800_8000), [0xF7FF, 0xBFFE]);
        assert_eq!(branch(0x0800_8000, 0x0800_8004), [0xF000, 0xB800]);
    }
}
