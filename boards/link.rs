//! Shared by the build scripts of all boards: memory.x in the repository's root folder becomes a link argument, with
//! the addresses of the board.

use std::env;
use std::error::Error;
use std::path::Path;

/// Whether an image is made; otherwise the crate is built for its tests on the host, which need no link arguments.
pub fn is_for_board() -> Result<bool, Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../link.rs");
    Ok(env::var("CARGO_CFG_TARGET_OS")? == "none")
}

/// Links with `memory.x`; `scripts` come before the chip's own, `place` says where the flash lies.
pub fn link(scripts: &[&str], place: &[&str]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    println!("cargo:rerun-if-changed={}", root.join("memory.x").display());
    println!("cargo:rustc-link-search={}", root.display());
    // Functions of the same instructions are one: 1.2 KB of the Octopus's image. Nothing compares their addresses.
    for argument in ["--nmagic", "--icf=all"].iter().chain(scripts).chain(&["-Tlink.x", "-Tdefmt.x"]).chain(place) {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
