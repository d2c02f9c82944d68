//! The firmware for the BTT Octopus V1.0 and V1.1, and for boards that differ from it in pins alone: the Octopus Pro
//! V1.0 and the Fysetc Spider. One image serves all of them; its machine block says on which it is.
//!
//! `cargo xtask build octopus` (or `octopus-pro`, `spider`) makes the image, and the README.md of each board describes
//! wiring and flashing.
#![cfg_attr(target_os = "none", no_std, no_main)]

use corehbot::connectors::{OCTOPUS, OCTOPUS_PRO, SPIDER};
use corehbot_stm32f446::wiring::Image;

#[path = "../../spider/wiring.rs"]
mod spider;
mod wiring;

#[cfg(test)]
mod spider_tests;
#[cfg(test)]
mod tests;

/// The image, which is on the first of its boards unless `corehbot image` says otherwise.
static IMAGE: Image = Image {
    boards: &[&wiring::BOARD, &wiring::PRO, &spider::BOARD],
    block: const { &corehbot::storage::blank_block(&[&OCTOPUS, &OCTOPUS_PRO, &SPIDER]) },
};

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    corehbot_stm32f446::run(&IMAGE, corehbot_stm32f446::eeprom)
}

#[cfg(not(target_os = "none"))]
fn main() {
    for board in IMAGE.boards {
        let key = board.connectors.key;
        eprintln!("this crate makes an image for the {}: run `cargo xtask build {key}`", board.name);
    }
}
