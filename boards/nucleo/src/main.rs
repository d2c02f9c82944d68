//! The firmware for the bench rig: a Nucleo-F446RE with a CNC shield v3.
//!
//! `cargo xtask build nucleo` makes the image, and README.md describes wiring and flashing.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod wiring;

/// The image.
#[cfg(target_os = "none")]
static IMAGE: corehbot_stm32f446::wiring::Image = corehbot_stm32f446::wiring::Image {
    boards: &[&wiring::BOARD],
    block: const { &corehbot::storage::blank_block(&[&corehbot::connectors::NUCLEO]) },
};

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    corehbot_stm32f446::run(&IMAGE, corehbot_stm32f446::flash)
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this crate makes an image for the {}: run `cargo xtask build nucleo`", wiring::BOARD.name);
}
