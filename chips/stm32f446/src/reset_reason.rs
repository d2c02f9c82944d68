//! Reset reason: why the processor had to be reset, kept in RAM that start-up leaves alone.

use core::fmt::{self, Write as _};
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use embassy_stm32::pac::RCC;
use heapless::String;

/// Longest text.
const LONGEST: usize = 96;

/// Says that the text was written by us, and not by chance or a bootloader.
const MAGIC: u32 = 0x4C57_0446;

/// What survives the reset.
struct Record {
    magic: AtomicU32,
    /// The text's length and checksum.
    check: AtomicU32,
    text: [AtomicU8; LONGEST],
}

// SAFETY: the section is meant for variables that start-up does not initialise (cortex-m-rt). Any bytes are
// legal values of these atomics, and nothing is believed before magic and checksum fit.
#[unsafe(link_section = ".uninit.reset_reason")]
static RECORD: Record =
    Record { magic: AtomicU32::new(0), check: AtomicU32::new(0), text: [const { AtomicU8::new(0) }; LONGEST] };

/// The reason as a text, which is cut where it gets too long.
pub struct ResetReason(String<LONGEST>);

impl ResetReason {
    /// What was said.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// What a host is told.
    pub fn parts(&self) -> [&str; 3] {
        ["echo:the last reset came after ", &self.0, "\n"]
    }
}

impl fmt::Write for ResetReason {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for character in text.chars() {
            // A line break would end the message early.
            let character = if character.is_control() { ' ' } else { character };
            self.0.push(character).map_err(|_| fmt::Error)?;
        }
        Ok(())
    }
}

/// Length and a sum that depends on the order (Fletcher).
fn check(text: &[u8]) -> u32 {
    let (a, b) = text.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) & 0xFFF;
        (a, (b + a) & 0xFFF)
    });
    (text.len() as u32) << 24 | a << 12 | b
}

/// Leaves a text for the time after the reset.
pub fn leave(reason: fmt::Arguments<'_>) {
    let mut message = ResetReason(String::new());
    // What does not fit is lost, the beginning says most.
    let _ = message.write_fmt(reason);
    let text = message.0.as_bytes();
    for (place, byte) in RECORD.text.iter().zip(text) {
        place.store(*byte, Ordering::Relaxed);
    }
    RECORD.check.store(check(text), Ordering::Relaxed);
    RECORD.magic.store(MAGIC, Ordering::Release);
}

/// Why the last reset happened, if it was not for a good reason; asked once.
pub fn take() -> Option<ResetReason> {
    let is_ours = RECORD.magic.load(Ordering::Acquire) == MAGIC;
    RECORD.magic.store(0, Ordering::Relaxed);
    let has_bitten = RCC.csr().read().wdgrstf();
    RCC.csr().modify(|w| w.set_rmvf(true));
    let sum = RECORD.check.load(Ordering::Relaxed);
    let length = (sum >> 24) as usize;
    let mut message = ResetReason(String::new());
    if is_ours && length <= LONGEST {
        let mut bytes = [0; LONGEST];
        bytes.iter_mut().zip(&RECORD.text).for_each(|(byte, place)| *byte = place.load(Ordering::Relaxed));
        let text = &bytes[..length];
        if check(text) == sum
            && let Ok(text) = core::str::from_utf8(text)
        {
            let _ = message.write_str(text);
            return Some(message);
        }
    }
    if has_bitten {
        let _ = message.write_str("the watchdog: a part of the firmware had stopped");
        return Some(message);
    }
    None
}
