//! The machine over a serial line: MACHINE_GET sends the record in pieces. MACHINE_PUT takes the pieces of another
//! record. MACHINE_STORE stores that record after it has passed all record checks and the checks of the board's
//! connectors. `corehbot config` is the other end.
//!
//! Pieces follow one another, each on its own line. They are put together in the one place for a record, which saving
//! and loading settings use too. So after MACHINE_STORE, M500, M501 or M504 the pieces come again from the first one.
//! Lines have numbers and checksums as in a print, and a checksum covers the whole record.

use super::stored::save;
use crate::gcode::MachineRecord;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::machine_answer::{MachineAnswer, MachineRefusal};
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::state::machine_pieces::{MachinePieces, PIECE};
use crate::port::{BoardFacts, Wake};
use crate::settings::Settings;
use crate::storage::{Receipt, machine_in, record_of};

/// MACHINE_GET, MACHINE_PUT and MACHINE_STORE.
pub(in crate::machine) async fn exchange_machine<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
    order: MachineRecord<'_>,
) -> Result<Answer<'static>, Interrupt> {
    Ok(Answer::Machine(match order {
        MachineRecord::Get => match main_loop.board.refusal() {
            Some(why) => MachineAnswer::Refused(MachineRefusal::NoMachine(why)),
            None => report_pieces(main_loop, pieces).await?,
        },
        MachineRecord::Put { at, hex } => match pieces.put(at.into(), hex) {
            Ok(()) => return Ok(Answer::Nothing),
            Err(error) => MachineAnswer::Refused(MachineRefusal::Piece(error)),
        },
        MachineRecord::Store => {
            let stored = match machine_that_came(main_loop, pieces) {
                Ok(machine) => store_machine(main_loop, pieces, &machine).await?,
                Err(refusal) => Err(refusal),
            };
            match stored {
                Ok((receipt, counts)) => MachineAnswer::Stored(receipt, counts),
                Err(refusal) => MachineAnswer::Refused(refusal),
            }
        }
    }))
}

/// Says the pieces of the machine's record, and gives its end.
async fn report_pieces<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
) -> Result<MachineAnswer<'static>, Interrupt> {
    let length = record_of(&main_loop.settings, pieces.begin()).unwrap_or_default();
    pieces.end(length);
    let mut at = 0;
    while let Some(piece) = pieces.piece(at) {
        main_loop.reply(Answer::Machine(MachineAnswer::Piece(at, piece))).await?;
        at += PIECE;
    }
    Ok(MachineAnswer::End(length))
}

/// The machine assembled from pieces, if it fits this board.
fn machine_that_came<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    pieces: &MachinePieces,
) -> Result<Settings, MachineRefusal> {
    let machine = machine_in(pieces.record()).map_err(MachineRefusal::Record)?;
    machine.check_connectors(main_loop.board.connectors()).map_err(MachineRefusal::Connectors)?;
    Ok(machine)
}

/// Stores a machine, and takes it over if it is put together as this one. Otherwise the next start does.
async fn store_machine<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
    machine: &Settings,
) -> Result<Result<(Receipt, bool), MachineRefusal>, Interrupt> {
    let receipt = match save(main_loop, machine, pieces.begin()).await? {
        Ok(receipt) => receipt,
        Err(error) => return Ok(Err(MachineRefusal::Storage(error))),
    };
    let counts = machine.is_built_as(&main_loop.settings) && main_loop.board.refusal().is_none();
    pieces.is_stored = !counts;
    if counts {
        main_loop.use_settings(machine).await?;
    }
    Ok(Ok((receipt, counts)))
}
