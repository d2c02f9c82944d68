//! The firmware for the BTT Octopus V1.0 and V1.1.
//!
//! `cargo xtask build octopus` makes the image, and README.md says how to wire and flash it.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod wiring;

#[cfg(test)]
mod tests;

/// The image.
#[cfg(target_os = "none")]
static IMAGE: corehbot_stm32f446::wiring::Image = corehbot_stm32f446::wiring::Image {
    boards: &[&wiring::BOARD],
    block: const { &corehbot::storage::blank_block(&[&corehbot::connectors::OCTOPUS]) },
};

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    corehbot_stm32f446::run(&IMAGE, corehbot_stm32f446::eeprom)
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this crate makes an image for the {}: run `cargo xtask build octopus`", wiring::BOARD.name);
}
