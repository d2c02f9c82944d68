//! The record: the last fault and its distance from earlier ones, as words for RAM that no reset clears.
//!
//! Such RAM has random content after power-up, so the words end with a checksum.

use super::cause::{Cause, Fault};
use crate::checksum::crc32;

/// Words of a record.
pub const WORDS: usize = 7;

/// Faults within [`CLOSE_S`] that cause the communication-only mode (promise for reset loops: three in a minute).
const MOST: u32 = 3;

/// Faults that close together count as a series, in s.
const CLOSE_S: u32 = 60;

/// The faults that RAM keeps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Record {
    /// The last fault.
    pub fault: Fault,
    /// Seconds from the start to the fault.
    pub uptime_s: u32,
    /// Number of faults in the series.
    pub count: u32,
}

impl Record {
    /// A fault `uptime_s` after the start that found the record `before`.
    #[must_use]
    pub const fn next(before: Option<Self>, fault: Fault, uptime_s: u32) -> Self {
        match before {
            // Between the previous fault and this one lies one run of the firmware.
            Some(before) if uptime_s <= CLOSE_S => {
                let is_close = before.count < MOST - 1 || before.uptime_s.saturating_add(uptime_s) <= CLOSE_S;
                let count = if is_close { before.count.saturating_add(1) } else { MOST - 1 };
                Self { fault, uptime_s, count }
            }
            _ => Self { fault, uptime_s, count: 1 },
        }
    }

    /// Whether faults come so fast that only communication is still useful.
    #[must_use]
    pub const fn is_series(&self) -> bool {
        self.count >= MOST
    }

    /// As words.
    #[must_use]
    pub fn to_words(&self) -> [u32; WORDS] {
        let Fault { cause, subject, value, limit } = self.fault;
        let mut words = [
            MAGIC,
            cause as u32 | u32::from(subject) << 8,
            value.cast_unsigned(),
            limit.cast_unsigned(),
            self.uptime_s,
            self.count,
            0,
        ];
        words[WORDS - 1] = checksum(&words);
        words
    }

    /// From words, if they are a valid record.
    #[must_use]
    pub fn from_words(words: &[u32; WORDS]) -> Option<Self> {
        let [magic, what, value, limit, uptime_s, count, sum] = *words;
        if magic != MAGIC || sum != checksum(words) {
            return None;
        }
        let cause = Cause::of(what as u8)?;
        let fault = Fault { cause, subject: (what >> 8) as u8, value: value.cast_signed(), limit: limit.cast_signed() };
        Some(Self { fault, uptime_s, count })
    }
}

/// The first word: the format of the others.
const MAGIC: u32 = 0xC0FA_0001;

/// The checksum of all words but the last.
fn checksum(words: &[u32; WORDS]) -> u32 {
    let bytes = words.map(u32::to_le_bytes);
    crc32(&[bytes[..WORDS - 1].as_flattened()])
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAULT: Fault = Fault { cause: Cause::Panic, subject: 3, value: -7, limit: 12 };

    #[test]
    fn words_keep_the_record_and_betray_every_flipped_bit() {
        let record = Record::next(None, FAULT, 17);
        let words = record.to_words();
        assert_eq!(Record::from_words(&words), Some(record));
        for bit in 0..32 * WORDS {
            let mut damaged = words;
            damaged[bit / 32] ^= 1 << (bit % 32);
            assert_eq!(Record::from_words(&damaged), None, "bit {bit}");
        }
        assert_eq!(Record::from_words(&[0; WORDS]), None);
    }

    #[test]
    fn three_faults_in_a_minute_are_a_series() {
        let after = |times: &[u32]| {
            times.iter().fold(None, |before, time| Some(Record::next(before, FAULT, *time))).unwrap().is_series()
        };
        assert!(after(&[400, 2, 2]));
        assert!(after(&[1, 30, 30]));
        assert!(!after(&[1, 2]));
        assert!(!after(&[1, 30, 31]), "more than a minute from the first to the last");
        assert!(!after(&[1, 2, 61]), "the last run was long");
        assert!(after(&[1, 30, 31, 20]), "the last three count");
    }
}
