//! The latch: the first context that finds a fault sets it, and only a reset clears it.

use super::cause::{Cause, Fault};
use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU8, AtomicU32, Ordering};

/// The first fault since start.
pub struct Latch {
    /// A context has set it.
    is_taken: AtomicBool,
    /// The cause's number; 0 until all else is written.
    cause: AtomicU8,
    subject: AtomicU8,
    value: AtomicI32,
    limit: AtomicI32,
    /// Faults that came later.
    more: AtomicU32,
}

impl Default for Latch {
    fn default() -> Self {
        Self::new()
    }
}

impl Latch {
    /// No fault.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            is_taken: AtomicBool::new(false),
            cause: AtomicU8::new(0),
            subject: AtomicU8::new(0),
            value: AtomicI32::new(0),
            limit: AtomicI32::new(0),
            more: AtomicU32::new(0),
        }
    }

    /// Sets it; true if this is the first fault. It takes no lock and does not wait: an interrupt in between sets
    /// nothing.
    pub fn set(&self, fault: Fault) -> bool {
        if self.is_taken.swap(true, Ordering::AcqRel) {
            self.more.fetch_add(1, Ordering::Relaxed);
            return false;
        }
        self.subject.store(fault.subject, Ordering::Relaxed);
        self.value.store(fault.value, Ordering::Relaxed);
        self.limit.store(fault.limit, Ordering::Relaxed);
        // Last, and released: a reader that finds a cause finds all the rest.
        self.cause.store(fault.cause as u8, Ordering::Release);
        true
    }

    /// Whether there is a fault. True from the first instruction of [`set`](Self::set) on.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.is_taken.load(Ordering::Acquire)
    }

    /// The fault.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        if !self.is_set() {
            return None;
        }
        let cause = Cause::of(self.cause.load(Ordering::Acquire))?;
        let [value, limit] = [&self.value, &self.limit].map(|word| word.load(Ordering::Relaxed));
        Some(Fault { cause, subject: self.subject.load(Ordering::Relaxed), value, limit })
    }

    /// Faults after the first.
    #[must_use]
    pub fn more(&self) -> u32 {
        self.more.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_first_cause_wins() {
        let latch = Latch::new();
        assert_eq!((latch.is_set(), latch.fault()), (false, None));
        let first = Fault { cause: Cause::TooHot, subject: 0, value: 300 << 20, limit: 290 << 20 };
        assert!(latch.set(first));
        assert!(!latch.set(Fault { cause: Cause::SensorOpen, subject: 1, value: 0, limit: 0 }));
        assert_eq!((latch.is_set(), latch.fault(), latch.more()), (true, Some(first), 1));
        assert_eq!(
            std::format!("{first}"),
            "hotend: hotter than it may get (MAXTEMP) (300.0 C, at most 290.0 C) [E04]: unplug the heater if it stays hot; check its switch and the sensor's kind (thermistor)"
        );
    }
}
