//! Link arguments: memory.x in the repository's root folder, with this board's addresses.

#[path = "../link.rs"]
mod link;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    if link::is_for_board()? {
        // The application lies after the bootloader of 32 KiB.
        link::link(&[], &["--defsym=flash_start=0x08008000", "--defsym=flash_size=480K"]);
    }
    Ok(())
}
