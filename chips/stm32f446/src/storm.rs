//! Interrupt storms: a flag that cannot be cleared has its handler run again and again, and nothing that is less urgent
//! runs any more: neither the control of heat nor the generator nor the Console. Each handler of a host line, of USB
//! and of the drivers' UART counts its calls; one that is called too often is masked at its source, and the machine
//! stops with a fault that names it.
//!
//! Steps that are queued do not suffer, for their interrupt is above all of these. Where an interrupt without a count
//! storms (embassy's time), or a handler that takes too long to be called that often, heaters go off by their timer and
//! the watchdog resets the chip (`heater_timer`, `watchdog`).

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use corehbot::fault::{Cause, Fault};

/// How long calls are counted, in cycles at 180 MHz: 20 ms.
const WINDOW: u32 = 3_600_000;

/// So many calls within that time are no storm. A line at 1 Mbaud that sends all the time and rests after each byte
/// that it receives makes 4,000; the bits of motor drivers make 1,200 (`exchange`), and USB three for each of some 19
/// packets in 20 frames of a millisecond. A storm makes more as long as a call takes less than 600 cycles, that of
/// steps in between included.
const MOST: u32 = 6000;

/// How often a handler was called of late. Only the handler uses it.
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
        let calls = self.calls.load(Ordering::Relaxed) + 1;
        self.calls.store(calls, Ordering::Relaxed);
        calls > MOST
    }
}

/// The first interrupt that was masked, plus one; 0 is none.
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

/// An interrupt was masked. Handlers that count share a priority, so none comes between.
fn note(irq: u8) {
    if MASKED.load(Ordering::Relaxed) == 0 {
        MASKED.store(irq + 1, Ordering::Relaxed);
    }
}

/// What there was of storms.
pub fn fault() -> Option<Fault> {
    let subject = MASKED.load(Ordering::Relaxed).checked_sub(1)?;
    Some(Fault { subject, ..Fault::plain(Cause::InterruptStorm) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls with so many cycles in between, from shortly before the counter wraps; how many there were until they were
    /// a storm.
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
        // Just so many in each window.
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
