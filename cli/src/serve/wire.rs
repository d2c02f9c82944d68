//! The wire: bytes on their way, one after the other at the rate of a UART.

use corehbot::units::TICKS_PER_SECOND;
use std::collections::VecDeque;

/// Bits of a byte with start and stop.
const BITS: u64 = 10;

/// One direction of a serial line, in virtual time.
pub(crate) struct Delay {
    /// Time of a byte in ticks; 0 for a line as fast as USB.
    byte: u64,
    /// When the wire is free for the next byte.
    free: u64,
    /// Bytes, and when their last bit arrives.
    bytes: VecDeque<(u64, u8)>,
}

impl Delay {
    /// A wire at `baud` bit/s, or one that takes no time.
    pub fn new(baud: Option<u32>) -> Self {
        let byte = baud.map_or(0, |baud| (u64::from(TICKS_PER_SECOND) * BITS).div_ceil(u64::from(baud.max(1))));
        Self { byte, free: 0, bytes: VecDeque::new() }
    }

    /// Sends bytes as soon as the bytes before them have left.
    pub fn send(&mut self, now: u64, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            self.free = self.free.max(now) + self.byte;
            self.bytes.push_back((self.free, byte));
        }
    }

    /// The bytes that have arrived.
    pub fn receive(&mut self, now: u64) -> impl Iterator<Item = u8> + '_ {
        std::iter::from_fn(move || self.bytes.pop_front_if(|(due, _)| *due <= now).map(|(_, byte)| byte))
    }

    /// Whether no byte is on its way.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_34_bytes_takes_3_ms_at_115200_baud() {
        let mut wire = Delay::new(Some(115_200));
        wire.send(1000, [b'x'; 34]);
        assert_eq!(wire.receive(1000 + 868).count(), 0);
        assert_eq!(wire.receive(1000 + 869).count(), 1);
        assert_eq!(wire.receive(1000 + 33 * 869).count(), 32);
        wire.send(1000 + 33 * 869, *b"y");
        assert_eq!(wire.receive(1000 + 34 * 869).count(), 1);
        assert!(!wire.is_empty());
        assert_eq!(wire.receive(1000 + 35 * 869).collect::<Vec<_>>(), b"y");
        assert!(wire.is_empty());
    }

    #[test]
    fn a_wire_without_a_rate_takes_no_time() {
        let mut wire = Delay::new(None);
        wire.send(5, *b"ok\n");
        assert_eq!(wire.receive(5).collect::<Vec<_>>(), b"ok\n");
    }
}
