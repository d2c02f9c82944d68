//! Reset reason: why the processor had to be reset, kept in RAM that start-up leaves alone.
//!
//! - A text: written by the handler that ends a run; reported after every reset.
//! - A record, the fault as numbers and how many came how fast: reported if there is no text. The same handler writes
//!   it; so does the thermal context for a fault that the core has latched, and start-up after a watchdog reset.
//! - Seconds since start: written by the thermal context; never reported.
//! - The power supply was switched off because a heater did not go off: written by the thermal context. Reported after
//!   every reset until it is forgotten.
//!
//! The first fault of a run is the one that is recorded. Switching on, and M999 without a fault before it, end a
//! series.

use core::fmt::{self, Write as _};
use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use corehbot::fault::{self, Cause, Fault};

use embassy_stm32::pac::RCC;
use heapless::String;

/// Longest text.
const LONGEST: usize = 96;

/// Marks a text as written by this firmware, and not by chance or a bootloader.
const MAGIC: u32 = 0x4C57_0446;

/// The record that survives the reset.
struct Kept {
    magic: AtomicU32,
    /// The text's length and checksum.
    check: AtomicU32,
    text: [AtomicU8; LONGEST],
    /// The record ([`fault::Record`], with its own checksum), and whether it is of the run that ended with the reset.
    record: [AtomicU32; fault::WORDS],
    is_fresh: AtomicU32,
    /// Seconds since start.
    uptime: AtomicU32,
    /// The power supply was switched off.
    supply_off: AtomicU32,
}

// SAFETY: the section is meant for variables that start-up does not initialise (cortex-m-rt). Any bytes are legal
// values of these atomics, and nothing counts before magic and checksum fit.
#[unsafe(link_section = ".uninit.reset_reason")]
static KEPT: Kept = Kept {
    magic: AtomicU32::new(0),
    check: AtomicU32::new(0),
    text: [const { AtomicU8::new(0) }; LONGEST],
    record: [const { AtomicU32::new(0) }; fault::WORDS],
    is_fresh: AtomicU32::new(0),
    uptime: AtomicU32::new(0),
    supply_off: AtomicU32::new(0),
};

/// Facts about the time before the reset.
pub struct Past {
    /// Why the reset happened, if it was not for a good reason.
    pub reason: Option<ResetReason>,
    /// The last fault, however long ago.
    pub record: Option<fault::Record>,
    /// The power supply was switched off because a heater did not go off. It stays off until power was cut, or until an
    /// M999 without a fault before it.
    pub is_supply_off: bool,
}

/// The reason as a text, which is cut where it gets too long.
pub struct ResetReason(String<LONGEST>);

impl ResetReason {
    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The report to a host.
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
    // Text that does not fit is lost; the beginning matters most.
    let _ = message.write_fmt(reason);
    let text = message.0.as_bytes();
    for (place, byte) in KEPT.text.iter().zip(text) {
        place.store(*byte, Ordering::Relaxed);
    }
    KEPT.check.store(check(text), Ordering::Relaxed);
    KEPT.magic.store(MAGIC, Ordering::Release);
}

/// The record that is kept.
fn record() -> Option<fault::Record> {
    fault::Record::from_words(&KEPT.record.each_ref().map(|word| word.load(Ordering::Relaxed)))
}

fn is_fresh() -> bool {
    KEPT.is_fresh.load(Ordering::Relaxed) == MAGIC
}

/// Records a fault, unless this run has recorded one. Works in any context: a context that interrupts this one ends the
/// run, or records the same fault.
pub fn note(fault: Fault) {
    if is_fresh() {
        return;
    }
    let uptime_s = KEPT.uptime.load(Ordering::Relaxed);
    for (place, word) in KEPT.record.iter().zip(fault::Record::next(record(), fault, uptime_s).to_words()) {
        place.store(word, Ordering::Relaxed);
    }
    KEPT.is_fresh.store(MAGIC, Ordering::Release);
}

/// Records how long this run has lasted.
pub fn set_uptime(seconds: u32) {
    KEPT.uptime.store(seconds, Ordering::Relaxed);
}

/// Notes that the power supply was switched off because a heater did not go off.
pub fn note_supply_off() {
    KEPT.supply_off.store(MAGIC, Ordering::Relaxed);
}

/// A run ends because the user wants it to: earlier faults do not count as a series any more, unless this run had a
/// fault.
pub fn end_series() {
    if !is_fresh() {
        forget();
    }
}

/// Forgets the record.
pub fn forget() {
    KEPT.record.iter().for_each(|word| word.store(0, Ordering::Relaxed));
    KEPT.supply_off.store(0, Ordering::Relaxed);
    KEPT.is_fresh.store(0, Ordering::Relaxed);
}

/// Facts about the time before the reset; read once, before any fault can be recorded.
pub fn take() -> Past {
    let flags = RCC.csr().read();
    // The flags add up over resets until they are cleared.
    RCC.csr().modify(|w| w.set_rmvf(true));
    let (has_bitten, was_off) = (flags.wdgrstf(), flags.porrstf());
    // RAM without power holds anything, and the sum of a record proves it only by chance.
    if was_off {
        forget();
    }
    let was_recorded = is_fresh();
    // A run that recorded a fault may end by the watchdog as well, and the fault tells more.
    if has_bitten && !was_recorded {
        note(Fault::plain(Cause::Watchdog));
    }
    KEPT.is_fresh.store(0, Ordering::Relaxed);
    KEPT.uptime.store(0, Ordering::Relaxed);
    let mut message = ResetReason(String::new());
    if let Some(text) = take_text() {
        message = text;
    } else if let Some(record) = record().filter(|_| was_recorded) {
        // Text that does not fit is lost.
        let _ = write!(message, "{}", record.fault);
    } else if has_bitten {
        let _ = message.write_str("the watchdog: a part of the firmware had stopped");
    }
    Past {
        reason: (!message.0.is_empty()).then_some(message),
        record: record(),
        is_supply_off: KEPT.supply_off.load(Ordering::Relaxed) == MAGIC,
    }
}

/// The text that was left.
fn take_text() -> Option<ResetReason> {
    let is_ours = KEPT.magic.load(Ordering::Acquire) == MAGIC;
    // Before it is used: should it lead to another reset, that one does not tell it again.
    KEPT.magic.store(0, Ordering::Relaxed);
    let sum = KEPT.check.load(Ordering::Relaxed);
    let length = (sum >> 24) as usize;
    if !is_ours || length > LONGEST {
        return None;
    }
    let mut bytes = [0; LONGEST];
    bytes.iter_mut().zip(&KEPT.text).for_each(|(byte, place)| *byte = place.load(Ordering::Relaxed));
    let text = core::str::from_utf8(bytes.get(..length)?).ok().filter(|text| check(text.as_bytes()) == sum)?;
    let mut message = ResetReason(String::new());
    let _ = message.write_str(text);
    Some(message)
}
