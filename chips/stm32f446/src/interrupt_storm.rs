//! Interrupt storms: a flag that cannot be cleared makes its handler run again and again. Then no less urgent context
//! runs: no heat control, no generator, no Console. Each handler above the generator counts its calls. An interrupt
//! that comes too often is masked at its source, and the machine stops with a fault that names it.
//!
//! Queued steps do not suffer, because their interrupt is above all of these. Two storms escape the count: an interrupt
//! without a count (the time), and a handler too slow to be called that often. Then heaters go off by their timer
//! and the watchdog resets the chip (`heater_timer`, `watchdog`).

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use corehbot::fault::{Cause, Fault};

/// How long calls are counted, in cycles at 180 MHz: 20 ms.
const WINDOW: u32 = 3_600_000;

/// This many calls in a window are no storm. A line at 1 Mbaud that sends all the time and rests after each received
/// byte makes 4,000. The bits of motor drivers make 1,200 (`exchange`), and USB three for each of some 19 packets in 20
/// frames of a millisecond. A storm makes more, provided that a call takes less than 600 cycles, including the steps in
/// between.
const MOST: u32 = 6000;

/// How often a handler was called recently. Only the handler uses it.
pub struct CallRate {
    /// When the count began, in cycles.
    since: AtomicU32,
    calls: AtomicU32,
}

impl CallRate {
    /// Never called.
    pub const fn new() -> Self {
        Self { since: AtomicU32::new(0), calls: AtomicU32::new(0) }
    }

    /// Counts a call at `now`, in cycles, which wrap; true if there were too many.
    fn is_storm(&self, now: u32) -> bool {
        if now.wrapping_sub(self.since.load(Ordering::Relaxed)) >= WINDOW {
            self.since.store(now, Ordering::Relaxed);
            self.calls.store(0, Ordering::Relaxed);
        }
        // A load and a store: the handler that counts here does not interrupt itself.
        let calls = self.calls.load(Ordering::Relaxed) + 1;
        self.calls.store(calls, Ordering::Relaxed);
        calls > MOST
    }
}

/// The first masked interrupt, plus one; 0 means that no interrupt was masked.
static MASKED: AtomicU8 = AtomicU8::new(0);

/// The handler of `irq` has been called: masks it if that is a storm. Nothing enables it again but a reset.
#[cfg(target_os = "none")]
pub fn count_call(irq: embassy_stm32::pac::Interrupt, rate: &CallRate) {
    use cortex_m::peripheral::{DWT, NVIC};
    if rate.is_storm(DWT::cycle_count()) {
        NVIC::mask(irq);
        note(irq as u8);
    }
}

/// An interrupt was masked. Handlers that count share a priority, except for the servo's: one that comes in between may
/// lose its name to the other.
fn note(irq: u8) {
    if MASKED.load(Ordering::Relaxed) == 0 {
        MASKED.store(irq + 1, Ordering::Relaxed);
    }
}

/// The recorded storm, if any.
pub fn fault() -> Option<Fault> {
    let subject = MASKED.load(Ordering::Relaxed).checked_sub(1)?;
    Some(Fault { subject, ..Fault::plain(Cause::InterruptStorm) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes a call every `cycles`, from shortly before the counter wraps; returns the number of calls until a storm.
    fn calls_until_storm(cycles: u32) -> Option<u32> {
        let rate = CallRate::new();
        let begin = u32::MAX - 2 * WINDOW;
        (0..40_000).find(|call| rate.is_storm(begin.wrapping_add(call * cycles)))
    }

    #[test]
    fn a_storm_is_more_than_the_busiest_line() {
        // As fast as a handler returns, 1 MHz, and a handler of 590 cycles: in 3, 6 and 20 ms.
        assert_eq!([100, 180, 590].map(calls_until_storm), [Some(MOST); 3]);
        // A byte each 10 us in both directions, and a driver's bits: for ever.
        assert_eq!([900, 3000].map(calls_until_storm), [None; 2]);
        // Exactly the limit in each window.
        assert_eq!(calls_until_storm(WINDOW / MOST), None);
    }

    #[test]
    fn the_first_storm_is_told() {
        assert_eq!(fault(), None);
        note(38);
        note(67);
        assert_eq!(
            fault().map(|fault| fault.to_string()),
            Some("interrupt 38: came without end (interrupt storm), masked [E25]: reset, and report it with what M122 says".into())
        );
    }
}
