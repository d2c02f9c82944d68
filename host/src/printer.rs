//! Printer: the simulated printer that commands have in common, as the command line names it.

use crate::input;
use anyhow::Result;
use clap::Args;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_machine_file::{self as machine_file, Machine};
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::options;
use corehbot_twin::description::Description;
use std::path::{Path, PathBuf};

/// The word for no storage, in place of an image.
const NO_STORAGE: &str = "none";

/// The printer that commands have in common.
#[derive(Clone, Args)]
pub struct Printer {
    /// The machine; without it, the CoreH-bot prototype.
    #[arg(long = "machine", alias = "settings", value_name = "M.toml")]
    machine_file: Option<PathBuf>,
    /// Keeps settings (M500) in this 4 KiB image of an EEPROM, which is created if it does not exist; `none` keeps
    /// nothing. Without it, `serve` keeps them in the user's folder for data, and other commands nowhere.
    #[arg(long, value_name = "E.bin")]
    storage: Option<PathBuf>,
    /// Starts as if homed, with the tool at this place in mm.
    #[arg(long, value_name = "X,Y,Z", value_parser = options::place, allow_hyphen_values = true)]
    pub assume_homed: Option<[Mm; 3]>,
}

impl Printer {
    /// One that keeps nothing.
    pub const fn new(machine_file: Option<PathBuf>, assume_homed: Option<[Mm; 3]>) -> Self {
        Self { machine_file, storage: None, assume_homed }
    }

    /// The machine.
    pub fn machine(&self) -> Result<Machine> {
        read_machine(self.machine_file.as_deref())
    }

    /// The files that define it.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        [self.machine_file.as_deref(), self.image()].into_iter().flatten()
    }

    /// The storage for its settings.
    pub fn eeprom(&self) -> Result<Option<Eeprom>> {
        let open = |path: &Path| {
            // A new one is made where there is none.
            if path.exists() {
                input::bytes(path, Wanted::Storage)?;
            }
            Eeprom::open(path)
        };
        self.image().map(open).transpose()
    }

    /// Whether the command line says where its settings are kept, or that they are not.
    pub const fn says_storage(&self) -> bool {
        self.storage.is_some()
    }

    fn image(&self) -> Option<&Path> {
        self.storage.as_deref().filter(|path| *path != Path::new(NO_STORAGE))
    }
}

fn read_machine(path: Option<&Path>) -> Result<Machine> {
    let Some(path) = path else {
        return Ok(Machine {
            name: Some("CoreH-bot prototype".to_owned()),
            board: None,
            settings: Settings::prototype(),
            twin: Description::default(),
            texts: Vec::new(),
        });
    };
    machine_file::read(path)
}
