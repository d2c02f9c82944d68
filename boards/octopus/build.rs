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
    // The application lies after the bootloader of 32 KiB.
    let place = ["--defsym=flash_start=0x08008000", "--defsym=flash_size=480K"];
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"].into_iter().chain(place) {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
