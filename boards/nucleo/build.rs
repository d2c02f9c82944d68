//! Link arguments: memory.x in the repository's root folder, with this board's addresses.

#[path = "../link.rs"]
mod link;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    if link::is_for_board()? {
        println!("cargo:rustc-link-search={}", env!("CARGO_MANIFEST_DIR"));
        println!("cargo:rerun-if-changed=settings.x");
        // No bootloader: the ST-LINK writes to the start of flash.
        link::link(&["-Tsettings.x"], &["--defsym=flash_start=0x08000000", "--defsym=flash_size=512K"]);
    }
    Ok(())
}
