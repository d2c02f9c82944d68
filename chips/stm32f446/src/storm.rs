//! Interrupt storms: a flag that cannot be cleared, or a line full of noise, has its handler run again and again, and nothing
//! that is less urgent runs any more: neither the control of heat nor the Console. Each handler of such an interrupt counts
//! its calls; one that is called too often is masked at its source, and the machine stops with a fault that names it.
//!
//! Steps do not suffer, for their interrupt is above all of these. Where the count takes too long, or an interrupt without
//! a count storms (embassy's time), heaters go off by their timer and the watchdog resets the chip (`heater_timer`, `watchdog`).

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use corehbot::fault::{Cause, Fault};

/// How long calls are counted, in cycles at 180 MHz: 20 ms.
const WINDOW: u32 = 3_600_000;

/// So many calls within that time are no storm. A line at 1 Mbaud that rests after each byte makes 2,000, the bits of motor
/// drivers 1,200 (`exchange`), USB some three in each of 20 frames; a handler that does nothing but return makes some 36,000.
const MOST: u32 = 8000;

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
static MASKED: AtomicU16 = AtomicU16::new(0);

/// The handler of `irq` has been called: masks it if that is a storm. Nothing enables it again but a reset.
#[cfg(target_os = "none")]
pub fn count_call(irq: embassy_stm32::pac::Interrupt, rate: &CallRate) {
    use cortex_m::peripheral::{DWT, NVIC};
    if rate.is_storm(DWT::cycle_count()) {
        NVIC::mask(irq);
        note(irq as u16);
    }
}

/// An interrupt was masked. Handlers that count share a priority, so none comes between.
fn note(irq: u16) {
    if MASKED.load(Ordering::Relaxed) == 0 {
        MASKED.store(irq + 1, Ordering::Relaxed);
    }
}

/// What there was of storms.
pub fn fault() -> Option<Fault> {
    let irq = MASKED.load(Ordering::Relaxed).checked_sub(1)?;
    Some(Fault { cause: Cause::InterruptStorm, subject: 0, value: i32::from(irq), limit: MOST.cast_signed() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls with so many cycles in between, from shortly before the counter wraps; how many there were until they were a storm.
    fn calls_until_storm(cycles: u32) -> Option<u32> {
        let rate = CallRate::new();
        let begin = u32::MAX - 2 * WINDOW;
        (0..40_000).find(|call| rate.is_storm(begin.wrapping_add(call * cycles)))
    }

    #[test]
    fn a_storm_is_more_than_the_busiest_line() {
        // As fast as a handler returns, and 1 MHz: in 4.4 and 8 ms.
        assert_eq!(calls_until_storm(100), Some(MOST));
        assert_eq!(calls_until_storm(180), Some(MOST));
        // A byte each 10 us, and a driver's bits: for ever.
        assert_eq!([1800, 3000].map(calls_until_storm), [None; 2]);
        // Just so many in each window.
        assert_eq!(calls_until_storm(WINDOW / MOST), None);
    }

    #[test]
    fn the_first_storm_is_told() {
        assert_eq!(fault(), None);
        note(38);
        note(67);
        assert_eq!(fault().map(|fault| (fault.cause, fault.value)), Some((Cause::InterruptStorm, 38)));
    }
}
