//! Hearing: how a TMC2209 decodes the edges on its wire (datasheet rev 1.09, section 4.1.1).
//!
//! The first byte of each datagram begins with the sync nibble 0101. From its start bit's edge to the falling edge
//! before bit 3 are four bit times. With this measure, this byte and the others are sampled. After an error the wire
//! must rest for 12 bit times. A datagram is dropped if its next byte does not begin within 63 bit times.

/// A result of hearing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Heard {
    /// A byte of a datagram.
    Byte(u8),
    /// An error: the bytes of the current datagram so far do not count.
    Nothing,
}

/// A datagram's first byte: the sync nibble in the lower half.
const SYNC: u8 = 0x5;

/// Longest time of four bits in ns. The lowest rate is 9,000 bits a second with a clock of 20 MHz (datasheet rev 1.09,
/// section 4.1.1), so 5,400 with 12 MHz.
const SLOWEST: u64 = 800_000;

/// Bits of a byte on the wire.
const FRAME: u64 = 10;

/// The ear of a chip.
#[derive(Clone, Default, Debug)]
pub struct Hearing {
    is_low: bool,
    /// Edges since the present byte's start bit, in ns: the first one falls.
    edges: Vec<u64>,
    /// Four bit times of the datagram, in ns.
    four_bits: Option<u64>,
    /// Bytes of the datagram that were heard, and how many it has.
    bytes: (usize, usize),
    /// When the last byte began.
    began: u64,
    /// The wire has to be at rest from here on, for 12 bit times.
    resting: Option<u64>,
}

impl Hearing {
    /// The wire changes its level.
    pub fn edge(&mut self, at: u64, is_high: bool) {
        if self.is_low != is_high {
            return;
        }
        self.is_low = !is_high;
        if let Some(since) = self.resting {
            if at < since + 3 * self.four_bits.unwrap_or(0) {
                self.resting = Some(at);
                return;
            }
            self.resting = None;
            self.four_bits = None;
        }
        if self.measure().is_none() && self.edges.first().is_some_and(|first| at - first > SLOWEST) {
            self.edges.clear();
        }
        if self.edges.is_empty() && is_high {
            return;
        }
        self.edges.push(at);
        // Fall, rise, fall, rise, fall: the start bit and 1, 0, 1, 0.
        if self.bytes.0 == 0 && self.edges.len() == 5 {
            self.four_bits = Some(at - self.edges[0]);
        }
    }

    /// How many ns after the present byte's edge `eighths` of four bit times are, if the measure is known.
    fn instant(&self, eighths: u64) -> Option<u64> {
        Some(self.edges.first()? + self.measure()? * eighths / 8)
    }

    fn measure(&self) -> Option<u64> {
        if self.bytes.0 == 0 && self.edges.len() < 5 { None } else { self.four_bits }
    }

    /// When the present byte will have been heard: in the middle of its stop bit.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        self.instant(2 * FRAME - 1)
    }

    /// The result up to `now`, if a byte has ended.
    pub fn take(&mut self, now: u64) -> Option<Heard> {
        if self.next().is_none_or(|end| end > now) {
            return None;
        }
        let mut samples = [false; FRAME as usize];
        for (n, sample) in samples.iter_mut().enumerate() {
            let at = self.instant(2 * n as u64 + 1)?;
            *sample = self.edges.iter().filter(|edge| **edge <= at).count() % 2 == 0;
        }
        self.began = self.edges[0];
        self.edges.clear();
        let byte = samples[1..9].iter().rev().fold(0, |byte, bit| byte << 1 | u8::from(*bit));
        let is_sound = !samples[0] && samples[9] && (self.bytes.0 > 0 || byte & 0xF == SYNC);
        if !is_sound {
            self.bytes = (0, 0);
            self.resting = Some(now);
            return Some(Heard::Nothing);
        }
        self.bytes.0 += 1;
        if self.bytes.0 == 3 {
            self.bytes.1 = if byte & 0x80 == 0 { 4 } else { 8 };
        }
        if self.bytes.0 == self.bytes.1 {
            self.bytes = (0, 0);
        }
        Some(Heard::Byte(byte))
    }

    /// Whether the byte that was heard last was a datagram's last.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        self.bytes.0 == 0
    }

    /// Whether to drop a datagram that has begun, because its next byte would begin too late at `now`.
    pub fn is_late(&mut self, now: u64) -> bool {
        let bit = self.four_bits.unwrap_or(u64::MAX / 63) / 4;
        let is_late = self.bytes.0 > 0 && self.edges.is_empty() && now > self.began + 63 * bit;
        if is_late {
            self.bytes = (0, 0);
        }
        is_late
    }

    /// The bit time of the last datagram and the end of the last byte's stop bit, in ns.
    #[must_use]
    pub fn clock(&self) -> (u64, u64) {
        let four_bits = self.four_bits.unwrap_or(0);
        (four_bits / 4, self.began + four_bits * FRAME / 4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Edges of bytes at `bit` ns a bit from `at` on, back to back.
    fn speak(hearing: &mut Hearing, bytes: &[u8], at: u64, bit: u64) -> Vec<Heard> {
        let mut heard = Vec::new();
        for (n, byte) in bytes.iter().enumerate() {
            let bits = u16::from(*byte) << 1 | 1 << 9;
            for i in 0..10 {
                let now = at + (n as u64 * 10 + i) * bit;
                heard.extend(hearing.take(now));
                if hearing.is_late(now) {
                    heard.push(Heard::Nothing);
                }
                hearing.edge(now, bits >> i & 1 != 0);
            }
        }
        heard.extend(hearing.take(at + bytes.len() as u64 * 10 * bit));
        heard
    }

    #[test]
    fn any_rate_is_understood() {
        for bit in [2_000, 52_083, 104_166] {
            let mut hearing = Hearing::default();
            let heard = speak(&mut hearing, &[0x05, 0x00, 0x6C, 0xFF], 1000, bit);
            assert_eq!(heard, [5, 0, 0x6C, 0xFF].map(Heard::Byte));
            let (measured, end) = hearing.clock();
            assert_eq!((measured, end), (bit, 1000 + 40 * bit));
            // The next datagram may have another one.
            let heard = speak(&mut hearing, &[0x05, 0x00], end + 12 * bit, 50_000);
            assert_eq!(heard, [5, 0].map(Heard::Byte));
        }
    }

    #[test]
    fn a_datagram_that_is_cut_is_forgotten_after_63_bits() {
        let mut hearing = Hearing::default();
        speak(&mut hearing, &[0x05, 0x00], 0, 1000);
        let heard = speak(&mut hearing, &[0x05], 80_000, 1000);
        assert_eq!(heard, [Heard::Nothing, Heard::Byte(5)]);
    }

    #[test]
    fn after_an_error_the_wire_has_to_rest() {
        let mut hearing = Hearing::default();
        speak(&mut hearing, &[0x05], 0, 1000);
        // Low for fifteen bits.
        hearing.edge(10_000, false);
        assert_eq!(hearing.take(19_500), Some(Heard::Nothing));
        hearing.edge(25_000, true);
        assert_eq!(speak(&mut hearing, &[0x05, 0x00], 30_000, 1000), []);
        assert_eq!(speak(&mut hearing, &[0x05, 0x00], 70_000, 1000), [5, 0].map(Heard::Byte));
    }
}
