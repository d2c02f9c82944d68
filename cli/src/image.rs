//! `corehbot image`: an image for a board, with the machine of a file in it.
//!
//! It needs no compiler: an image has a block for a machine ([`corehbot_host::image`]).

use anyhow::{Context as _, Result, bail};
use clap::Args;
use corehbot::connectors::BoardConnectors;
use corehbot::storage::Receipt;
use corehbot_host::image::{board_called, board_in, clear, put, put_owner_texts, set_board};
use corehbot_host::input;
use corehbot_host::output::Outputs;
use corehbot_host::say::say;
use corehbot_host::status::DONE;
use corehbot_host::stop::Stop;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_machine_file::{self as machine_file, Machine};
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
                put_owner_texts(&mut bytes, &machine_file::body(&machine.texts))
                    .with_context(|| file.display().to_string())?;
                Some((machine, receipt))
            }
            None => {
                clear(&mut bytes)?;
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
            Some((machine, receipt)) => {
                let texts = match machine.texts.len() {
                    0 => String::new(),
                    1 => ", 1 text".to_owned(),
                    count => format!(", {count} texts"),
                };
                format!("{} {receipt}{texts}", machine.name.as_deref().unwrap_or("a machine"))
            }
            None => "without a machine: it moves nothing before it gets one".to_owned(),
        };
        let (output, bytes, board) = (args.output.display(), self.bytes.len(), self.board.key);
        say(format_args!("{output}: {bytes} bytes for the board {board}, {machine}"))?;
        Ok(DONE)
    }
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
