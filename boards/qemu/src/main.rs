//! The firmware on QEMU's mps2-an386: the same core as on a printer, on an emulated Cortex-M4F.
//!
//! `cargo xtask qemu FILE.gcode` builds and runs it. Steps go into a file instead of to pins, and the
//! command line of the emulator says which machine this is.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod an386;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this crate makes an image for an emulator: run `cargo xtask qemu FILE.gcode`");
}
