//! The firmware for the bench rig: a Nucleo-F446RE with a CNC shield v3.
//!
//! `cargo xtask build nucleo` makes the image, and README.md describes wiring and flashing.
#![cfg_attr(target_os = "none", no_std, no_main)]

/// The image.
#[cfg(target_os = "none")]
static IMAGE: corehbot_stm32f446::wiring::Image = corehbot_stm32f446::wiring::Image {
    boards: const { &corehbot_boards::tables_of(corehbot_boards::NUCLEO) },
    block: const { &corehbot::storage::blank_block(&corehbot_boards::connectors_of(corehbot_boards::NUCLEO)) },
    texts: const { &corehbot::storage::blank_texts() },
};

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    corehbot_stm32f446::run(&IMAGE, corehbot_stm32f446::flash)
}

#[cfg(not(target_os = "none"))]
fn main() {
    let name = corehbot_boards::nucleo::BOARD.name;
    eprintln!("this crate makes an image for the {name}: run `cargo xtask build nucleo`");
}
