//! `cargo xtask build`: the image of a board, as ELF and as `firmware.bin`, and whether it keeps its promises.

pub mod binary;
mod contents;
pub mod instruction;
mod last_resort;
mod step_path;

use crate::checkout;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot_cli::image::set_board;
use object::Endianness;
use object::elf::FileHeader32;
use object::read::elf::ElfFile;
use std::path::{Path, PathBuf};

/// An image, read.
pub type Elf<'d> = ElfFile<'d, FileHeader32<Endianness>>;

/// Which image to build.
#[derive(clap::Args)]
pub struct Args {
    /// The board.
    board: Board,
}

/// A board that can be flashed.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Board {
    /// BTT Octopus V1.0 or V1.1.
    Octopus,
    /// BTT Octopus Pro V1.0 with an STM32F446.
    OctopusPro,
    /// Fysetc Spider V1.x or V2.x with an STM32F446.
    Spider,
    /// Nucleo-F446RE with a CNC shield.
    Nucleo,
}

impl Board {
    /// Its key, as machine files have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Octopus => "octopus",
            Self::OctopusPro => "octopus-pro",
            Self::Spider => "spider",
            Self::Nucleo => "nucleo",
        }
    }

    /// The package that makes its image.
    const fn package(self) -> &'static str {
        match self {
            Self::Octopus | Self::OctopusPro | Self::Spider => "corehbot-octopus",
            Self::Nucleo => "corehbot-nucleo",
        }
    }

    /// Whether the ELF file is for it: one that boards share is for the first of them, and `firmware.bin` alone for
    /// another.
    pub const fn has_elf(self) -> bool {
        match self {
            Self::Octopus | Self::Nucleo => true,
            Self::OctopusPro | Self::Spider => false,
        }
    }

    /// Its name for people.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Octopus => "BTT Octopus",
            Self::OctopusPro => "BTT Octopus Pro",
            Self::Spider => "Fysetc Spider",
            Self::Nucleo => "Nucleo-F446RE",
        }
    }

    /// The processor as probe-rs names it.
    pub const fn chip(self) -> &'static str {
        match self {
            Self::Octopus | Self::OctopusPro => "STM32F446ZETx",
            Self::Spider => "STM32F446VETx",
            Self::Nucleo => "STM32F446RETx",
        }
    }

    /// Whether USB leads to the processor, and not to a debug probe.
    pub const fn has_usb(self) -> bool {
        match self {
            Self::Octopus | Self::OctopusPro | Self::Spider => true,
            Self::Nucleo => false,
        }
    }

    /// Whether its bootloader reads a card.
    pub const fn has_card_slot(self) -> bool {
        match self {
            Self::Octopus | Self::OctopusPro | Self::Spider => true,
            Self::Nucleo => false,
        }
    }

    /// Bytes that the image may leave free in one place.
    const fn largest_gap(self) -> u32 {
        match self {
            Self::Octopus | Self::OctopusPro | Self::Spider => binary::LARGEST_GAP,
            // Sectors 0 to 2 hold the vectors and the settings; the code begins behind them.
            Self::Nucleo => 0xC000,
        }
    }
}

/// An image that was built.
pub struct Image {
    /// With symbols, for probes.
    pub elf: PathBuf,
    /// `firmware.bin`.
    pub binary: PathBuf,
    /// Where the binary begins in flash.
    pub start: u32,
}

/// Builds, weighs and examines an image.
pub fn main(args: &Args) -> Result<()> {
    image(args.board).map(|_| ())
}

/// Builds, weighs and examines an image, and says where it is.
pub fn image(board: Board) -> Result<Image> {
    let name = board.name();
    let elf_path = checkout::build_image(board.package())?;
    let data = read(&elf_path)?;
    let elf = Elf::parse(&*data)?;
    examine(&elf, true)?;
    let (start, mut binary) = binary::extract(&elf, board.largest_gap())?;
    set_board(&mut binary, name)?;
    let binary_path = write(&binary, name)?;
    println!("ELF     {}", elf_path.display());
    println!("binary  {} ({} bytes, at {start:#010x})", binary_path.display(), binary.len());
    Ok(Image { elf: elf_path, binary: binary_path, start })
}

/// Weighs and examines the images of all boards, which have been built.
pub fn examine_all() -> Result<String> {
    let boards = checkout::boards()?;
    for package in &boards {
        println!("\n{package}");
        let data = read(&checkout::image(package)?)?;
        // The emulator's board writes its steps into a file from the step interrupt.
        let is_flashable = package != crate::qemu::BOARD;
        examine(&Elf::parse(&*data)?, is_flashable).with_context(|| package.clone())?;
    }
    Ok(boards.join(", "))
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("cannot open {}", path.display()))
}

/// Instructions from a fault to heaters that are low, in an image.
///
/// # Errors
/// If it is not an ELF file, or if some path of a fault does not lead there.
pub fn last_resort(image: &[u8]) -> Result<usize> {
    let (longest, complaints) = last_resort::longest_way(&Elf::parse(image)?)?;
    ensure!(complaints.is_empty(), "{}", complaints.join("; "));
    Ok(longest)
}

/// Fails if an image is too large or has forbidden contents; with `and_step_path` also if the step interrupt has.
fn examine(elf: &Elf<'_>, and_step_path: bool) -> Result<()> {
    let mut complaints = contents::weigh(elf)?;
    complaints.extend(contents::forbidden(elf, !and_step_path));
    if and_step_path {
        let (report, in_step_path) = step_path::examine(elf)?;
        println!("{report}");
        complaints.extend(in_step_path);
        let (report, in_last_resort) = last_resort::examine(elf)?;
        println!("{report}");
        complaints.extend(in_last_resort);
    }
    if complaints.is_empty() { Ok(()) } else { bail!("{}", complaints.join("; ")) }
}

/// Writes `firmware.bin`, the name that the Octopus's bootloader expects, into a folder of the board's.
fn write(binary: &[u8], board: &str) -> Result<PathBuf> {
    let folder = checkout::target_dir()?.join("firmware").join(board);
    let write = |folder: &Path| {
        std::fs::create_dir_all(folder)?;
        let path = folder.join("firmware.bin");
        std::fs::write(&path, binary)?;
        std::io::Result::Ok(path)
    };
    write(&folder).with_context(|| format!("cannot write into {}", folder.display()))
}
