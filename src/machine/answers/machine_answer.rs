//! Answers about a machine record on a serial line.

use crate::machine::state::machine_pieces::PieceError;
use crate::settings::ConnectorError;
use crate::storage::{Receipt, Rejected, SaveError};
use core::fmt;

/// The answers.
#[derive(Clone, Copy)]
pub(in crate::machine) enum MachineAnswer<'p> {
    /// MACHINE_GET: the piece at this place.
    Piece(usize, &'p [u8]),
    /// Behind the last piece: the whole length.
    End(usize),
    /// MACHINE_PUT or MACHINE_STORE refuse.
    Refused(MachineRefusal),
    /// MACHINE_STORE did it: the record, and whether it takes effect at once.
    Stored(Receipt, bool),
}

/// Why a machine is not taken. The stored machine stays as it is.
#[derive(Clone, Copy)]
pub(in crate::machine) enum MachineRefusal {
    /// A piece.
    Piece(PieceError),
    /// The assembled bytes are no valid record, or the record is not allowed.
    Record(Rejected),
    /// The board lacks a connector that the record uses.
    Connectors(ConnectorError),
    /// The storage.
    Storage(SaveError),
    /// MACHINE_GET: the board is no machine, and why.
    NoMachine(&'static str),
}

impl fmt::Display for MachineRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Piece(PieceError::Gap(there)) => put!(f, "the next piece belongs at {there}"),
            Self::Piece(PieceError::NoHex) => put!(f, "HEX needs two hexadecimal digits a byte"),
            Self::Piece(PieceError::TooLong) => put!(f, "no machine is so long"),
            Self::Record(why) => why.fmt(f),
            Self::Connectors(error) => error.fmt(f),
            Self::Storage(error) => error.fmt(f),
            Self::NoMachine(why) => f.write_str(why),
        }
    }
}
