//! `cargo xtask build`: the image of a board, as ELF and as `firmware.bin`, and whether it keeps its promises.

mod binary;
mod contents;
mod instruction;
mod step_path;

use crate::checkout;
use anyhow::{Context as _, Result, bail};
use object::Endianness;
use object::elf::FileHeader32;
use object::read::elf::ElfFile;
use std::path::{Path, PathBuf};

/// An image, read.
type Elf<'d> = ElfFile<'d, FileHeader32<Endianness>>;

/// Which image to build.
#[derive(clap::Args)]
pub struct Args {
    /// The board.
    board: Board,
}

/// A board that can be flashed.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Board {
    /// BTT Octopus V1.0 or V1.1.
    Octopus,
    /// Nucleo-F446RE with a CNC shield.
    Nucleo,
}

impl Board {
    const fn name(self) -> &'static str {
        match self {
            Self::Octopus => "octopus",
            Self::Nucleo => "nucleo",
        }
    }
}

/// Builds, weighs and examines an image.
pub fn main(args: &Args) -> Result<()> {
    let name = args.board.name();
    let elf_path = checkout::build_image(&format!("corehbot-{name}"))?;
    let data = std::fs::read(&elf_path).with_context(|| format!("cannot open {}", elf_path.display()))?;
    let elf = Elf::parse(&*data)?;
    let binary = binary::extract(&elf)?;
    let mut complaints = contents::weigh(&elf)?;
    complaints.extend(contents::forbidden(&elf));
    let (report, in_step_path) = step_path::examine(&elf)?;
    println!("{report}");
    complaints.extend(in_step_path);
    if !complaints.is_empty() {
        bail!("{}", complaints.join("; "));
    }
    let binary_path = write(&binary, name)?;
    println!("ELF     {}", elf_path.display());
    println!("binary  {} ({} bytes)", binary_path.display(), binary.len());
    Ok(())
}

/// Writes `firmware.bin`, the name that the Octopus's bootloader looks for, into a folder of the board's.
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
