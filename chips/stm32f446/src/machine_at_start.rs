//! The machine to start as, and the board as that is plugged into it.
//!
//! It is the one that is stored, or else that of the image. A board that has neither, or not the connectors of its machine, still
//! talks and reports, put together as the prototype in the usual places; but no motor gets power, and what it says is why.

use core::fmt;

use corehbot::settings::{ConnectorError, Settings};
use corehbot::storage::{machine_of, stored_machine};
use embassy_futures::block_on;
use static_cell::StaticCell;

use crate::board_storage::BoardStorage;
use crate::wiring::{Board, Image, Plugged};

/// What a board starts as.
pub struct Start {
    /// The machine.
    pub settings: &'static Settings,
    /// The board with the machine plugged in.
    pub plugged: &'static Plugged,
    /// Why it is no machine.
    pub lack: Option<Lack>,
}

/// Why a board has no machine.
#[derive(Clone, Copy)]
pub enum Lack {
    /// None is stored, and the image has none.
    Nothing,
    /// The board has not what the machine is plugged into.
    Connector(ConnectorError),
}

impl Lack {
    /// Why no motor gets power.
    #[must_use]
    pub const fn reason(&self) -> &'static str {
        match self {
            Self::Nothing => "this board has no machine",
            Self::Connector(_) => "its machine is not for this board",
        }
    }
}

impl fmt::Display for Lack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str(
                "echo:this board has no machine, so no motor gets power: send one (corehbot config send) or flash an image with one",
            ),
            Self::Connector(error) => write!(f, "echo:the machine is not used: {error}"),
        }
    }
}

/// Finds the machine. A function that is not inlined, so that its settings are on the stack for as long as it runs.
#[inline(never)]
pub fn machine_at_start(image: &Image, board: &'static Board, storage: &mut BoardStorage) -> Start {
    static MACHINE: StaticCell<Settings> = StaticCell::new();
    static PLUGGED: StaticCell<Plugged> = StaticCell::new();
    let machine = MACHINE.init(Settings::prototype());
    let made = machine_of(image.block());
    if let Ok(made) = &made {
        *machine = *made;
    }
    machine.name_connectors(board.connectors);
    // The board's memory answers at once; nothing here waits for anybody else.
    let stored = block_on(stored_machine(storage));
    let nothing = (made.is_err() && stored.is_none()).then_some(Lack::Nothing);
    // Whatever else is stored is for the Console, which looks again, and tells what it finds.
    if let Some(mut stored) = stored.filter(|stored| !stored.is_built_as(machine)) {
        stored.name_connectors(board.connectors);
        *machine = stored;
    }
    let (plugged, lack) = match board.plugged(machine) {
        Ok(plugged) => (plugged, nothing),
        Err(error) => {
            *machine = Settings::prototype();
            machine.name_connectors(board.connectors);
            (board.usual(), Some(Lack::Connector(error)))
        }
    };
    Start { settings: machine, plugged: PLUGGED.init(plugged), lack }
}
