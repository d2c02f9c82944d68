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
    // link.x asks for a device.x that names the handlers of a vendor's table; here src/an386/vectors.rs
    // fills the whole table.
    let out = env::var("OUT_DIR")?;
    std::fs::write(Path::new(&out).join("device.x"), "")?;
    println!("cargo:rustc-link-search={out}");
    // The memory at 0 holds the vectors (ARM DAI 0386C, memory map). Sizes are those of the Octopus, so
    // that an image that fits here fits there.
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x", "--defsym=flash_start=0"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
    Ok(())
}
