//! An image's bytes: the machine and the board in its block.
//!
//! Images are built without a machine. Each has a block for one ([`corehbot::storage::put_machine`]), so an image for a
//! machine needs no compiler. Boards that differ in pins alone share an image, and its block names the board.

use anyhow::{Context as _, Result, ensure};
use corehbot::connectors::BoardConnectors;
use corehbot::settings::Settings;
use corehbot::storage::{
    BLOCK, MARK, Receipt, TEXT_MARK, board_of, boards_of, choose_board, clear_machine, put_machine, put_texts,
};
use corehbot_boards as boards;
use memchr::memmem;

/// Takes the machine and the owner's texts out of an image.
///
/// # Errors
/// If the bytes are not an image.
pub fn clear(image: &mut [u8]) -> Result<()> {
    clear_machine(block_in(image)?);
    put_owner_texts(image, &[])
}

/// Puts the owner's texts into an image, in place of others.
///
/// # Errors
/// If it has no place for them, or they are too long.
pub fn put_owner_texts(image: &mut [u8], body: &[u8]) -> Result<()> {
    match only_place(image, &TEXT_MARK) {
        Some(block) => ensure!(put_texts(block, body), "the texts are too long for an image"),
        None => ensure!(body.is_empty(), "an image of earlier firmware: it has no place for texts"),
    }
    Ok(())
}

/// Puts a machine into the bytes of an image, and returns the identity of its record.
///
/// # Errors
/// If the bytes are not an image, or the board lacks connectors of the machine.
pub fn put(image: &mut [u8], machine: &mut Settings) -> Result<Receipt> {
    let board = board_in(image)?;
    machine.name_connectors(board);
    machine.check_connectors(board)?;
    put_machine(block_in(image)?, machine).context(
        "the settings of this machine are too long for an image: send it to the board (`corehbot config send`)",
    )
}

/// Puts an image on the board of that key.
///
/// # Errors
/// If the bytes are not an image, or the image does not run on that board.
pub fn set_board(image: &mut [u8], key: &str) -> Result<()> {
    let block = block_in(image)?;
    let is_known = choose_board(block, key);
    let boards = boards_of(block).collect::<Vec<_>>().join(", ");
    ensure!(!boards.is_empty(), "an image of earlier firmware: it does not name its boards");
    ensure!(is_known, "an image for {boards}, not for {key}");
    Ok(())
}

/// The board that an image is on.
///
/// # Errors
/// If the bytes are not an image, or of a board that is not known.
pub fn board_in(image: &mut [u8]) -> Result<&'static BoardConnectors> {
    board_called(board_of(block_in(image)?).context("the image does not say which board it is for")?)
}

/// The machine block of an image.
fn block_in(image: &mut [u8]) -> Result<&mut [u8; BLOCK]> {
    only_place(image, &MARK).context("not an image of this firmware: it has no place for a machine")
}

/// The block behind a mark, if an image has one with that mark.
fn only_place<'i, const BYTES: usize>(image: &'i mut [u8], mark: &[u8]) -> Option<&'i mut [u8; BYTES]> {
    let mut places = memmem::find_iter(&*image, mark);
    let (first, second) = (places.next(), places.next());
    let place = first.filter(|_| second.is_none());
    place.and_then(|at| image.get_mut(at..at + BYTES)).and_then(|block| block.try_into().ok())
}

/// The board of that key, of those that are built.
///
/// # Errors
/// There is none.
pub fn board_called(key: &str) -> Result<&'static BoardConnectors> {
    let real = || boards::all().filter(|board| !board.is_simulated);
    let found = real().find(|board| board.key == key);
    found.with_context(|| format!("no board is called {key}: {}", real().map(|b| b.key).collect::<Vec<_>>().join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::connectors::ConnectorName;
    use corehbot::storage::{blank_block, machine_of};
    use corehbot_boards::nucleo::CONNECTORS as NUCLEO;
    use corehbot_boards::octopus::CONNECTORS as OCTOPUS;

    /// Something before and after a block.
    fn image(board: &BoardConnectors) -> Vec<u8> {
        [&[7; 100][..], &blank_block(&[board]), &[9; 50]].concat()
    }

    #[test]
    fn an_image_that_boards_share_is_put_on_one() {
        let mut bytes = [&[7; 100][..], &blank_block(&[&OCTOPUS, &NUCLEO]), &[9; 50]].concat();
        assert_eq!(board_in(&mut bytes).unwrap(), &OCTOPUS);
        set_board(&mut bytes, "nucleo").unwrap();
        assert_eq!(board_in(&mut bytes).unwrap(), &NUCLEO);
        let error = set_board(&mut bytes, "sim").unwrap_err();
        assert_eq!(error.to_string(), "an image for octopus, nucleo, not for sim");
    }

    #[test]
    fn a_machine_changes_its_block_alone() {
        let mut bytes = image(&OCTOPUS);
        let mut machine = Settings::prototype();
        machine.keepalive_s = 7;
        put(&mut bytes, &mut machine).unwrap();
        assert!(bytes[..196] == image(&OCTOPUS)[..196] && bytes[100 + BLOCK..] == [9; 50]);
        assert_eq!(machine_of(block_in(&mut bytes).unwrap()), Ok(machine));
        // Another one takes its place.
        put(&mut bytes, &mut Settings::prototype()).unwrap();
        assert_eq!(machine_of(block_in(&mut bytes).unwrap()), Ok(Settings::prototype()));
    }

    #[test]
    fn a_file_without_connectors_means_those_of_the_board() {
        let (mut bytes, mut machine) = (image(&NUCLEO), Settings::prototype());
        put(&mut bytes, &mut machine).unwrap();
        let sockets = machine.wiring.motors.map(|plug| plug.connector.to_string());
        assert_eq!(sockets[..4], ["X", "Y", "A", "Z"]);
        assert!(sockets[4..].iter().all(String::is_empty));
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let wrong =
            |mut bytes: Vec<u8>, mut machine: Settings| format!("{:#}", put(&mut bytes, &mut machine).unwrap_err());
        let fine = Settings::prototype();
        assert_eq!(wrong(vec![0; 5000], fine), "not an image of this firmware: it has no place for a machine");
        assert_eq!(wrong([image(&OCTOPUS), image(&OCTOPUS)].concat(), fine), wrong(vec![], fine));
        let printer = image(&BoardConnectors { key: "printer", ..OCTOPUS });
        let keys: Vec<_> = boards::entries().map(|entry| entry.board.connectors.key).collect();
        assert_eq!(wrong(printer, fine), format!("no board is called printer: {}", keys.join(", ")));
        let mut machine = fine;
        machine.wiring.motors[1] = machine.wiring.motors[0];
        assert_eq!(wrong(image(&OCTOPUS), machine), "motor m1 and motor m4 have the same connector, M0");
        machine.wiring.motors[1].connector = ConnectorName::lit("M8");
        let text = "motor m4: the BTT Octopus has no connector M8; it has M0, M1, M2, M3, M4, M5, M6, M7";
        assert_eq!(wrong(image(&OCTOPUS), machine), text);
    }
}
