//! `corehbot image`: an image for a board, with the machine of a file in it.
//!
//! Images are built without a machine. Each has a block for one ([`corehbot::storage::put_machine`]), so an image for a
//! machine needs no compiler. Boards that differ in pins alone share an image, and its block names the board.

use crate::input;
use crate::output::Outputs;
use crate::say::say;
use crate::status::DONE;
use crate::stop::Stop;
use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use corehbot::connectors::BoardConnectors;
use corehbot::settings::Settings;
use corehbot::storage::{BLOCK, MARK, Receipt, board_of, boards_of, choose_board, clear_machine, put_machine};
use corehbot_boards as boards;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_machine_file::{self as machine_file, Machine};
use memchr::memmem;
use std::io::Write as _;
use std::path::PathBuf;

/// Folder of the images that came with the program, in the program's folder or its parent.
const IMAGES: &str = "images";

/// The image to make.
#[derive(Args)]
pub(crate) struct Image {
    /// The board: octopus, nucleo or another. Without --from, its image is taken from `images`, next to this program.
    #[arg(long, required_unless_present = "from")]
    board: Option<String>,
    /// Takes this image: one that `cargo xtask build` has made, or another machine's.
    #[arg(long, value_name = "IMAGE.bin")]
    from: Option<PathBuf>,
    /// The machine; without it, the image has no machine, and moves nothing.
    #[arg(long, alias = "settings", value_name = "M.toml")]
    machine: Option<PathBuf>,
    /// Where to write the image.
    #[arg(short, long, value_name = "firmware.bin")]
    output: PathBuf,
}

/// An image that can be written.
pub(crate) struct Prepared {
    bytes: Vec<u8>,
    board: &'static BoardConnectors,
    machine: Option<(Machine, Receipt)>,
    inputs: Vec<PathBuf>,
}

impl Prepared {
    /// Reads the files, and puts the machine in.
    pub(crate) fn new(args: &Image) -> Result<Self> {
        let wanted = args.board.as_deref().map(board_called).transpose()?;
        let path = match (&args.from, wanted) {
            (Some(path), _) => path.clone(),
            (None, Some(board)) => prebuilt(board)?,
            (None, None) => bail!("give --board or --from"),
        };
        let mut bytes = input::bytes(&path, Wanted::Image)?;
        if let Some(wanted) = wanted {
            set_board(&mut bytes, wanted.key).with_context(|| path.display().to_string())?;
        }
        let board = board_in(&mut bytes).with_context(|| path.display().to_string())?;
        let mut inputs = vec![path];
        let machine = match &args.machine {
            Some(file) => {
                inputs.push(file.clone());
                let mut machine = machine_file::read(file)?;
                let receipt = put(&mut bytes, &mut machine.settings).with_context(|| file.display().to_string())?;
                Some((machine, receipt))
            }
            None => {
                clear_machine(block_in(&mut bytes)?);
                None
            }
        };
        Ok(Self { bytes, board, machine, inputs })
    }

    /// Writes the image.
    pub(crate) fn write(self, args: &Image) -> Result<u8> {
        let mut outputs = Outputs::new(self.inputs.iter().map(PathBuf::as_path), Stop::default());
        let mut to = outputs.open(&args.output)?;
        to.write_all(&self.bytes).and_then(|()| to.flush())?;
        drop(to);
        outputs.keep()?;
        let machine = match &self.machine {
            Some((machine, receipt)) => format!("{} {receipt}", machine.name.as_deref().unwrap_or("a machine")),
            None => "without a machine: it moves nothing before it gets one".to_owned(),
        };
        let (output, bytes, board) = (args.output.display(), self.bytes.len(), self.board.key);
        say(format_args!("{output}: {bytes} bytes for the board {board}, {machine}"))?;
        Ok(DONE)
    }
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
fn board_in(image: &mut [u8]) -> Result<&'static BoardConnectors> {
    board_called(board_of(block_in(image)?).context("the image does not say which board it is for")?)
}

/// The machine block of an image.
fn block_in(image: &mut [u8]) -> Result<&mut [u8; BLOCK]> {
    let mut places = memmem::find_iter(image, &MARK);
    let (first, second) = (places.next(), places.next());
    let place = first.filter(|_| second.is_none());
    let block = place.and_then(|at| image.get_mut(at..at + BLOCK)).and_then(|block| block.try_into().ok());
    block.context("not an image of this firmware: it has no place for a machine")
}

fn board_called(key: &str) -> Result<&'static BoardConnectors> {
    let real = || boards::all().filter(|board| !board.is_simulated);
    let found = real().find(|board| board.key == key);
    found.with_context(|| format!("no board is called {key}: {}", real().map(|b| b.key).collect::<Vec<_>>().join(", ")))
}

/// The image for `board` that came with this program: one that may be on it.
fn prebuilt(board: &BoardConnectors) -> Result<PathBuf> {
    let program = std::env::current_exe().context("cannot find this program's own path")?;
    let folders: Vec<_> = program.ancestors().skip(1).take(2).map(|folder| folder.join(IMAGES)).collect();
    let files = folders.iter().filter_map(|folder| folder.read_dir().ok()).flatten();
    let mut paths: Vec<_> = files.filter_map(|file| Some(file.ok()?.path())).collect();
    paths.sort();
    let is_for_it =
        |path: &PathBuf| std::fs::read(path).is_ok_and(|mut bytes| set_board(&mut bytes, board.key).is_ok());
    paths.into_iter().find(is_for_it).with_context(|| {
        let places = folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>();
        format!("no image for {} lies in {}; name an image with --from", board.key, places.join(" or "))
    })
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
