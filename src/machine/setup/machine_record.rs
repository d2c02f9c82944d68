//! The machine over a serial line: MACHINE_GET sends the record in pieces. MACHINE_PUT takes the pieces of another
//! record. MACHINE_STORE stores that record after it has passed all record checks and the checks of the board's
//! connectors. `corehbot config` is the other end.
//!
//! Pieces follow one another, each on its own line. They are put together in the one place for a record, which saving
//! and loading settings use too. So after MACHINE_STORE, M500, M501 or M504 the pieces come again from the first one.
//! Lines have numbers and checksums as in a print, and a checksum covers the whole record.

use super::stored::save;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Nature, flaw_of_pairs};
use crate::machine::state::machine_pieces::{MachinePieces, PIECE, PieceError};
use crate::port::BoardFacts;
use crate::settings::{ConnectorError, Settings};
use crate::storage::{Receipt, Rejected, SaveError, machine_in, record_of};
use crate::text::read_digits;
use core::fmt;

pub(in crate::machine) const GET: Entry =
    Entry::name("Settings", &["MACHINE_GET"]).nature(Nature::Mode).does("", "the machine as a record in lines");

pub(in crate::machine) const PUT: Entry = Entry::name("Settings", &["MACHINE_PUT"])
    .nature(Nature::Mode)
    .judge(|_, text| piece(text).err().into())
    .does("AT= HEX=", "a piece of a record")
    .examples(&[
        ("MACHINE_PUT AT=5 HEX=00", &["echo:machine not stored: the next piece belongs at 0"]),
        ("MACHINE_PUT AT=0 HEX=0g", &["echo:machine not stored: HEX needs two hexadecimal digits a byte"]),
        ("MACHINE_PUT AT=x HEX=00", &["echo:line ignored: \"AT=x\" is not a name with = and a number"]),
        ("MACHINE_PUT HEX=00", &["echo:line ignored: \"HEX=00\" is not a name with = and a number"]),
        ("MACHINE_PUT AT=0 HEX=00", &[]),
    ]);

pub(in crate::machine) const STORE: Entry = Entry::name("Settings", &["MACHINE_STORE"])
    .nature(Nature::Mode)
    .does("", "checks and stores the record")
    .examples(&[("MACHINE_STORE", &["echo:machine not stored: empty"])]);

/// The place of a piece in the record, in bytes, and its bytes, two digits each.
#[inline(never)]
fn piece(text: &[u8]) -> Result<(u16, &[u8]), Flaw<'_>> {
    let (mut at, mut hex) = (None, None);
    let flaw = flaw_of_pairs(text, &["AT", "HEX"], &mut |pair| {
        match pair.place {
            0 => {
                let (number, after) = read_digits(pair.value);
                if pair.value.is_empty() || !after.is_empty() {
                    return Some(pair.flaw());
                }
                at = Some(number);
            }
            1 => hex = Some(pair.value),
            _ => return Some(pair.flaw()),
        }
        None
    });
    flaw.map_or(at.zip(hex).ok_or(Flaw::NoPair(text.trim_ascii())), Err)
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { pieces, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let done = if command.is_named("MACHINE_GET") {
        match main_loop.board.refusal() {
            Some(why) => Err(Refusal::NoMachine(why)),
            None => return report_pieces(main_loop, pieces).await,
        }
    } else if command.is_named("MACHINE_PUT") {
        let Ok((at, hex)) = piece(command.text()) else { return Ok(Answer::Nothing) };
        match pieces.put(at.into(), hex) {
            Ok(()) => return Ok(Answer::Nothing),
            Err(error) => Err(Refusal::Piece(error)),
        }
    } else {
        match machine_that_came(main_loop, pieces) {
            Ok(machine) => store_machine(main_loop, pieces, &machine).await?,
            Err(refusal) => Err(refusal),
        }
    };
    match done {
        Ok((receipt, counts)) => {
            let since = if counts { packed!("in effect now") } else { packed!("in effect after the next reset") };
            main_loop.say(text!("echo:machine stored {receipt}, {since}"));
        }
        Err(why) => main_loop.say(text!("echo:machine not stored: {why}")),
    }
    Ok(Answer::Said)
}

/// Why a machine is not taken. The stored machine stays as it is.
#[derive(Clone, Copy)]
enum Refusal {
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

impl fmt::Display for Refusal {
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

/// Says the pieces of the machine's record, and its end.
async fn report_pieces<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
) -> Result<Answer<'static>, Interrupt> {
    let length = record_of(&main_loop.settings, pieces.begin()).unwrap_or_default();
    pieces.end(length);
    let mut at = 0;
    while let Some(piece) = pieces.piece(at) {
        main_loop.reply(Answer::words(&|to, _| to.say(text!("machine AT={at} HEX={}", Hex(piece))))).await?;
        at += PIECE;
    }
    main_loop.say(text!("machine END={length}"));
    Ok(Answer::Said)
}

/// Bytes as two digits each.
struct Hex<'a>(&'a [u8]);

impl fmt::Display for Hex<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// The machine assembled from pieces, if it fits this board.
fn machine_that_came<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    pieces: &MachinePieces,
) -> Result<Settings, Refusal> {
    let machine = machine_in(pieces.record()).map_err(Refusal::Record)?;
    machine.check_connectors(main_loop.board.connectors()).map_err(Refusal::Connectors)?;
    Ok(machine)
}

/// Stores a machine, and takes it over if it is put together as this one. Otherwise the next start does.
async fn store_machine<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    pieces: &mut MachinePieces,
    machine: &Settings,
) -> Result<Result<(Receipt, bool), Refusal>, Interrupt> {
    let receipt = match save(main_loop, machine, pieces.begin()).await? {
        Ok(receipt) => receipt,
        Err(error) => return Ok(Err(Refusal::Storage(error))),
    };
    let counts = machine.is_built_as(&main_loop.settings) && main_loop.board.refusal().is_none();
    pieces.is_stored = !counts;
    if counts {
        main_loop.use_settings(machine).await?;
    }
    Ok(Ok((receipt, counts)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_of_a_machine_has_a_place_and_bytes() {
        let expected = Ok((32, b"0aFF".as_slice()));
        assert_eq!([piece(b"AT=32 HEX=0aFF"), piece(b"hex=0aFF at=32")], [expected, expected]);
        for (text, word) in [
            ("AT= HEX=00", "AT="),
            ("AT=1x HEX=00", "AT=1x"),
            ("AT=-1 HEX=00", "AT=-1"),
            ("AT=1 BYTES=00", "BYTES=00"),
            ("AT=1 HEX", "HEX"),
            ("AT=1", "AT=1"),
            ("HEX=00", "HEX=00"),
        ] {
            assert_eq!(piece(text.as_bytes()), Err(Flaw::NoPair(word.as_bytes())), "{text}");
        }
    }
}
