//! The machine over a serial line: MACHINE_GET says its record in pieces, MACHINE_PUT takes the pieces of another one, and
//! MACHINE_STORE stores it after the checks that every record has to pass, and those of the board's connectors. `corehbot config`
//! is the other end.
//!
//! Pieces come one after the other, each on a line of its own; lines have numbers and checksums as in a print, and a record has
//! a checksum over all of it.

use crate::gcode::MachineRecord;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::machine_answer::{MachineAnswer, MachineRefusal};
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::machine_pieces::PIECE;
use crate::port::{DriverBus, Pend};
use crate::settings::Settings;
use crate::storage::{Receipt, machine_in, record_of};
use heapless::Vec;

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// MACHINE_GET, MACHINE_PUT and MACHINE_STORE.
    pub(in crate::machine) async fn exchange_machine(
        &mut self,
        order: MachineRecord<'_>,
    ) -> Result<Answer<'static>, Interrupt> {
        Ok(Answer::Machine(match order {
            MachineRecord::Get => match self.ports.drivers.refusal() {
                Some(why) => MachineAnswer::Refused(MachineRefusal::NoMachine(why)),
                None => self.say_pieces().await?,
            },
            MachineRecord::Put { at, hex } => match self.machine_pieces.put(at.into(), hex) {
                Ok(()) => return Ok(Answer::Nothing),
                Err(error) => MachineAnswer::Refused(MachineRefusal::Piece(error)),
            },
            MachineRecord::Store => {
                let stored = match self.machine_that_came() {
                    Ok(machine) => self.store_machine(&machine).await?,
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
    async fn say_pieces(&mut self) -> Result<MachineAnswer<'static>, Interrupt> {
        let length = record_of(&self.settings, self.machine_pieces.begin()).unwrap_or_default();
        self.machine_pieces.end(length);
        let mut at = 0;
        while let Some(piece) = self.machine_pieces.piece(at).and_then(|piece| Vec::<u8, PIECE>::from_slice(piece).ok())
        {
            self.tell(Answer::Machine(MachineAnswer::Piece(at, &piece))).await?;
            at += PIECE;
        }
        Ok(MachineAnswer::End(length))
    }

    /// The machine that was put together from pieces, if this board can be it.
    fn machine_that_came(&self) -> Result<Settings, MachineRefusal> {
        let machine = machine_in(self.machine_pieces.record()).map_err(MachineRefusal::Record)?;
        machine.check_connectors(self.ports.drivers.connectors()).map_err(MachineRefusal::Connectors)?;
        Ok(machine)
    }

    /// Stores a machine, and takes it over if it is put together as this one. Otherwise the next start does.
    async fn store_machine(
        &mut self,
        machine: &Settings,
    ) -> Result<Result<(Receipt, bool), MachineRefusal>, Interrupt> {
        let receipt = match self.save(machine).await? {
            Ok(receipt) => receipt,
            Err(error) => return Ok(Err(MachineRefusal::Storage(error))),
        };
        let counts = machine.is_built_as(&self.settings) && self.ports.drivers.refusal().is_none();
        self.machine_pieces.is_stored = !counts;
        if counts {
            self.use_settings(*machine).await?;
        }
        Ok(Ok((receipt, counts)))
    }
}
