//! `cargo xtask build`: the image of a board, as ELF and as `firmware.bin`, and whether it keeps its promises.

pub mod binary;
mod contents;
pub mod instruction;
mod last_resort;
mod sizes;
mod step_path;

use crate::checkout;
use crate::images;
use anyhow::{Context as _, Result, bail, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use corehbot_boards::{Entry, PACKAGES, Package, entries};
use corehbot_host::image::set_board;
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
    #[arg(value_parser = board_parser())]
    board: Board,
    /// Prints the bytes of each room, and the largest functions.
    #[arg(long)]
    sizes: bool,
}

/// A board that can be flashed, and the package that makes its image.
#[derive(Clone, Copy)]
pub struct Board {
    /// The board.
    pub entry: &'static Entry,
    package: &'static Package,
}

/// Finds boards by their keys, as machine files have them.
pub fn board_parser() -> impl TypedValueParser<Value = Board> {
    let values = entries().map(|entry| PossibleValue::new(entry.board.connectors.key).help(entry.board.name));
    PossibleValuesParser::new(values).try_map(|key| Board::called(&key).ok_or("there is no such board"))
}

impl Board {
    /// Every board.
    pub fn all() -> impl Iterator<Item = Self> {
        PACKAGES.iter().flat_map(|package| package.boards.iter().map(move |entry| Self { entry, package }))
    }

    /// The board with that key.
    pub fn called(key: &str) -> Option<Self> {
        Self::all().find(|board| board.key() == key)
    }

    /// Its name for people.
    pub const fn title(self) -> &'static str {
        self.entry.board.name
    }

    /// Its key, as machine files have it.
    pub const fn key(self) -> &'static str {
        self.entry.board.connectors.key
    }

    /// Whether the ELF file is for it: one that boards share is for the first of them, and `firmware.bin` alone for
    /// another.
    pub fn has_elf(self) -> bool {
        self.package.boards.first().is_some_and(|first| first.board.connectors.key == self.key())
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
    let image = image(args.board)?;
    if args.sizes {
        print!("\n{}", sizes::of(&read(&image.elf)?)?);
    }
    Ok(())
}

/// Builds, weighs and examines an image, and says where it is.
pub fn image(board: Board) -> Result<Image> {
    let elf_path = images::build_image(board.package.name)?;
    let data = read(&elf_path)?;
    let elf = Elf::parse(&*data)?;
    examine(&elf, true)?;
    let (start, mut binary) = binary::extract(&elf, board.package.largest_gap)?;
    let wanted = board.entry.start;
    ensure!(start == wanted, "the image is at {start:#010x}, and the {} starts one at {wanted:#010x}", board.title());
    set_board(&mut binary, board.key())?;
    let binary_path = write(&binary, board.key())?;
    println!("ELF     {}", elf_path.display());
    println!("binary  {} ({} bytes, at {start:#010x})", binary_path.display(), binary.len());
    Ok(Image { elf: elf_path, binary: binary_path, start })
}

/// Weighs and examines the images of all boards, which have been built.
pub fn examine_all() -> Result<String> {
    let boards = images::boards()?;
    for package in &boards {
        println!("\n{package}");
        let data = read(&images::image(package)?)?;
        // The emulator's board writes its steps into a file from the step interrupt.
        let is_flashable = package != crate::qemu::BOARD;
        examine(&Elf::parse(&*data)?, is_flashable).with_context(|| package.clone())?;
        if package == sizes::PACKAGE {
            sizes::of(&data)?.check().with_context(|| package.clone())?;
        }
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
    let mut complaints = contents::weigh(elf, !and_step_path)?;
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
