//! The machine to start as, and the board as that is plugged into it.
//!
//! The machine is the stored one, or else the machine of the image. A board may have neither, or lack the connectors of
//! its machine. It then still talks and reports, as the prototype on the usual connectors. But no motor gets power, no
//! stored value counts, and its messages say why.

use core::fmt::Write as _;

use corehbot::settings::Settings;
use corehbot::storage::{machine_of, stored_machine};
use embassy_futures::block_on;
use heapless::String;
use static_cell::StaticCell;

use crate::board_storage::BoardStorage;
use crate::wiring::{Board, Image, Plugged};

/// Longest text about a machine that is not used: a motor or switch, a name of 8 letters, a board, and the names of all
/// its inputs.
const LONGEST_REASON: usize = 192;

/// The result of start-up.
pub struct Start {
    /// The machine.
    pub settings: &'static Settings,
    /// The board with the machine plugged in.
    pub plugged: &'static Plugged,
    /// Why there is no machine.
    pub refusal: Option<&'static str>,
}

/// Why a board without a machine gives no motor power.
const NO_MACHINE: &str = "this board has no machine: send one (corehbot config send) or flash an image with one";

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
    // The board's memory answers at once, so this never waits.
    let mut stored = block_on(stored_machine(storage));
    let has_none = made.is_err() && stored.is_none();
    if let Some(stored) = &mut stored {
        stored.name_connectors(board.connectors);
        // M502 goes back to the machine of the image, if the stored one has the same build.
        if made.is_err() || !stored.is_built_as(machine) {
            *machine = *stored;
        }
    }
    // Stored values count in any case for the Console, which reads them again and reports what it finds.
    let is_fit = stored.map_or(Ok(()), |stored| stored.check_connectors(board.connectors));
    let (plugged, refusal) = match is_fit.and_then(|()| board.plugged(machine)) {
        Ok(plugged) => (plugged, has_none.then_some(NO_MACHINE)),
        Err(error) => {
            static REASON: StaticCell<String<LONGEST_REASON>> = StaticCell::new();
            let reason = REASON.init(String::new());
            // Text that does not fit is left out.
            let _ = write!(reason, "the machine is not used: {error}");
            *machine = Settings::prototype();
            machine.name_connectors(board.connectors);
            (board.usual(), Some(reason.as_str()))
        }
    };
    Start { settings: machine, plugged: PLUGGED.init(plugged), refusal }
}
