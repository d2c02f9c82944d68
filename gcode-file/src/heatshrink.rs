//! Heatshrink: LZSS with small windows, as binary G-code uses it.
//!
//! A bit of 1 is followed by a byte. A bit of 0 is followed by how far back, and how many bytes to repeat from there,
//! each less one. Bits count from the highest of a byte; the last byte is filled with zeros
//! (github.com/atomicobject/heatshrink). Crates with a decoder have had one release each, and it is a page long.

/// Bits of a stream, the highest of a byte first.
struct Bits<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl Bits<'_> {
    fn take(&mut self, count: u32) -> Option<usize> {
        let mut value = 0;
        for _ in 0..count {
            let byte = self.bytes.get(self.at / 8)?;
            value = value << 1 | usize::from(byte >> (7 - self.at % 8) & 1);
            self.at += 1;
        }
        Some(value)
    }
}

/// Unpacks exactly `length` bytes; `window` and `lookahead` are bits of a distance and of a count.
pub(crate) fn unpack(packed: &[u8], window: u32, lookahead: u32, length: usize) -> Option<Vec<u8>> {
    let (mut bits, mut found) = (Bits { bytes: packed, at: 0 }, Vec::new());
    while found.len() < length {
        if bits.take(1)? == 1 {
            found.push(bits.take(8)? as u8);
            continue;
        }
        let (back, count) = (bits.take(window)? + 1, bits.take(lookahead)? + 1);
        for _ in 0..count {
            // What lies before the begin counts as zeros.
            let byte = found.len().checked_sub(back).map_or(0, |at| found[at]);
            found.push(byte);
        }
    }
    // The rest fills up the last byte.
    let is_filled = packed.len() - bits.at.div_ceil(8) <= 1;
    (found.len() == length && is_filled).then_some(found)
}
