//! The watchdog: a reset for a board in which any context has stopped.
//!
//! The Console looks after the others: it asks Stepper and StepGenerator to run, and feeds the watchdog only if both
//! have done so. A Console that hangs does not feed it at all.

use core::sync::atomic::Ordering;

use corehbot::port::Pend as _;
use cortex_m::peripheral::{DWT, SCB};
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::pac::{DBGMCU, IWDG};
use embassy_time::{Duration, Instant};

use crate::contexts::{BEATS, IrqPend};

/// Counts until the reset at 1 kHz. The oscillator has 17 to 47 kHz instead of 32 (STM32F446 datasheet, LSI),
/// so it comes after 0.34 to 0.94 s.
const COUNTS: u16 = 500;

/// The reload value has 12 bits (RM0390 rev 6, section 19.4.3).
const MOST_COUNTS: u16 = 4096;

/// Looks at the status while prescaler and reload value cross over, which takes five cycles of the slow oscillator
/// (RM0390 rev 6, section 19.3), 0.3 ms at 17 kHz: ten times that at four cycles a look and 180 MHz.
const CROSSING: u32 = 135_000;

/// How often the others are asked.
const INTERVAL: Duration = Duration::from_millis(50);

/// The independent watchdog, running.
pub struct Watchdog {
    asked: Instant,
    beats: u32,
    /// The step timer's counter then.
    cycles: u32,
}

/// Starts the watchdog, which nothing but a reset stops. What follows has a third of a second until the first
/// [`Watchdog::look`].
///
/// While a debugger halts the processor it stands still, or a breakpoint would end in a reset. So does embassy's time, as the
/// step timer does by itself, which is the core's own: the steps go on where they were, and both clocks agree. What the outputs
/// drive, they drive during a halt. Whoever adds heaters has to have them off by then: their timers can be made to
/// (RM0390, 33.16.3, counter stopped with its outputs off), a pin alone cannot.
pub fn start() {
    DBGMCU.apb1fzr().modify(|w| {
        w.set_iwdg(true);
        w.set_tim3(true);
    });
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY32));
    set_period(COUNTS);
}

/// Gives what follows the longest time that there is, 2.8 to 7.7 s: an operation for which the processor stands still.
pub fn stretch() {
    set_period(MOST_COUNTS);
}

/// Takes that back.
pub fn restore() {
    set_period(COUNTS);
}

/// Begins a time of so many counts.
fn set_period(counts: u16) {
    // Every feed locks the reload value again (RM0390 rev 6, section 19.3.2).
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.rlr().write(|w| w.set_rl(counts - 1));
    // A feed before the new values have reached the slow oscillator's side reloads the reset value, and the
    // first period is 4 s.
    for _ in 0..CROSSING {
        let status = IWDG.sr().read();
        if !status.pvu() && !status.rvu() {
            break;
        }
    }
    feed();
}

/// Begins the time until the reset anew. Only for start-up, which has no other contexts yet, and for a board
/// that does nothing.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}

impl Watchdog {
    /// Looks after the contexts from now on.
    pub fn new() -> Self {
        Self { asked: Instant::now(), beats: 0, cycles: 0 }
    }

    /// Call it often: feeds the watchdog if all contexts have run since they were asked to, and asks them again.
    pub fn look(&mut self) {
        if self.asked.elapsed() < INTERVAL {
            return;
        }
        let beats = BEATS.load(Ordering::Relaxed);
        // Steps have no time if somebody, a debugger that goes, has switched its counter off.
        let cycles = DWT::cycle_count();
        // Nothing holds the Stepper off, so its request, once made, is waiting only if it never runs.
        if beats != self.beats && cycles != self.cycles && !SCB::is_pendst_pending() {
            feed();
            (self.beats, self.cycles) = (beats, cycles);
        }
        self.asked = Instant::now();
        IrqPend.pend_stepper();
        IrqPend.pend_generator();
    }
}
