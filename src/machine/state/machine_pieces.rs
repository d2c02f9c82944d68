//! A record of a machine in transfer over a serial line, in pieces.

use crate::storage::LONGEST;

/// Bytes of a piece: a line of 96 characters holds them, with its number and checksum.
pub(in crate::machine) const PIECE: usize = 24;

/// Pieces that were put together so far.
#[derive(Clone, Copy)]
pub(in crate::machine) struct MachinePieces {
    bytes: [u8; LONGEST],
    length: usize,
    /// A machine was stored that takes effect after the next reset.
    pub is_stored: bool,
}

/// Why a piece is not taken.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum PieceError {
    /// A gap: this many bytes are there.
    Gap(usize),
    /// It is no hexadecimal number of whole bytes, or it is empty.
    NoHex,
    /// No record is so long.
    TooLong,
}

impl MachinePieces {
    pub const fn new() -> Self {
        Self { bytes: [0; LONGEST], length: 0, is_stored: false }
    }

    /// Takes the piece that belongs at `at`; one at 0 begins another record.
    pub fn put(&mut self, at: usize, hex: &[u8]) -> Result<(), PieceError> {
        let (pairs, odd) = hex.as_chunks::<2>();
        if pairs.is_empty() || !odd.is_empty() || !hex.iter().all(u8::is_ascii_hexdigit) {
            return Err(PieceError::NoHex);
        }
        if at == 0 {
            self.length = 0;
        }
        if at != self.length {
            return Err(PieceError::Gap(self.length));
        }
        let place = self.bytes.get_mut(at..at + pairs.len()).ok_or(PieceError::TooLong)?;
        for (to, [high, low]) in place.iter_mut().zip(pairs) {
            *to = digit(*high) << 4 | digit(*low);
        }
        self.length = at + pairs.len();
        Ok(())
    }

    /// The assembled part of the record.
    pub fn record(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }

    /// The place for another record, to send, to save or to load; a record under assembly is dropped.
    pub const fn begin(&mut self) -> &mut [u8; LONGEST] {
        self.length = 0;
        &mut self.bytes
    }

    /// The record is so long.
    pub const fn end(&mut self, length: usize) {
        self.length = length;
    }

    /// The piece at `at`, or `None` behind the last one.
    pub fn piece(&self, at: usize) -> Option<&[u8]> {
        self.record().get(at..).filter(|rest| !rest.is_empty()).map(|rest| rest.get(..PIECE).unwrap_or(rest))
    }
}

/// The value of a hexadecimal digit.
const fn digit(digit: u8) -> u8 {
    match digit {
        b'0'..=b'9' => digit - b'0',
        _ => (digit | 0x20).wrapping_sub(b'a' - 10),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_follow_each_other() {
        let mut pieces = MachinePieces::new();
        assert_eq!(pieces.put(0, b"00fF1a"), Ok(()));
        assert_eq!(pieces.put(2, b"77"), Err(PieceError::Gap(3)));
        assert_eq!(pieces.put(3, b"7"), Err(PieceError::NoHex));
        assert_eq!(pieces.put(3, b""), Err(PieceError::NoHex));
        assert_eq!(pieces.put(3, b"0x"), Err(PieceError::NoHex));
        assert_eq!(pieces.put(3, b"77"), Ok(()));
        assert_eq!(pieces.record(), [0, 0xFF, 0x1A, 0x77]);
        assert_eq!(pieces.put(0, b"AB"), Ok(()), "another one");
        assert_eq!(pieces.record(), [0xAB]);
        for at in 1..LONGEST {
            pieces.put(at, b"55").unwrap();
        }
        assert_eq!(pieces.put(LONGEST, b"55"), Err(PieceError::TooLong));
        let all: usize = (0..LONGEST).step_by(PIECE).filter_map(|at| pieces.piece(at)).map(<[u8]>::len).sum();
        assert_eq!((all, pieces.piece(LONGEST)), (LONGEST, None));
    }
}
