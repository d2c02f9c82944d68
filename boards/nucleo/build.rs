//! Link arguments: the memory map of the root with this board's addresses.

use std::env;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    println!("cargo:rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo:rustc-link-search={}", root.display());
    println!("cargo:rustc-link-search={}", env!("CARGO_MANIFEST_DIR"));
    println!("cargo:rerun-if-changed=settings.x");
    // No bootloader: the ST-LINK writes to the start of flash.
    let place = ["--defsym=flash_start=0x08000000", "--defsym=flash_size=512K"];
    for argument in ["--nmagic", "-Tsettings.x", "-Tlink.x", "-Tdefmt.x"].into_iter().chain(place) {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
