//! The firmware for the BTT Octopus V1.0 and V1.1, and for boards that differ from it in pins alone. One image serves
//! all of them ([`OCTOPUS`] lists them); its machine block says on which it is.
//!
//! `cargo xtask build octopus`, or another of the boards, makes the image. The README.md of each board describes wiring
//! and flashing.
#![cfg_attr(target_os = "none", no_std, no_main)]

use corehbot_boards::{OCTOPUS, connectors_of, tables_of};
use corehbot_stm32f446::wiring::Image;

/// The image, which is on the first of its boards unless `corehbot image` says otherwise.
static IMAGE: Image = Image {
    boards: const { &tables_of(OCTOPUS) },
    block: const { &corehbot::storage::blank_block(&connectors_of(OCTOPUS)) },
    texts: const { &corehbot::storage::blank_texts() },
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

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::storage::{boards_of, choose_board};
    use corehbot_boards::{octopus, octopus_pro};

    #[test]
    fn the_image_has_a_table_for_every_board_that_it_names() {
        let mut block = *IMAGE.block;
        assert!(boards_of(IMAGE.block).eq(IMAGE.boards.iter().map(|board| board.connectors.key)));
        assert_eq!(IMAGE.board().map(|board| board.name), Some(octopus::BOARD.name));
        for board in IMAGE.boards {
            assert!(choose_board(&mut block, board.connectors.key));
            let image = Image { block: Box::leak(Box::new(block)), ..IMAGE };
            assert_eq!(image.board().map(|board| board.name), Some(board.name));
        }
        let elsewhere = Image { boards: const { &[&octopus_pro::BOARD] }, ..IMAGE };
        assert!(elsewhere.board().is_none());
    }
}
