//! The watchdog: a reset for a board in which any context has stopped.
//!
//! The Console looks after the others: it asks Stepper and StepGenerator to run, and feeds the watchdog only if both
//! have done so. A Console that hangs does not feed it at all.

use core::sync::atomic::Ordering;

use corehbot::port::Pend as _;
use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_time::{Duration, Instant};

use crate::contexts::{BEATS, IrqPend};
use crate::step_timer;

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
}

/// Starts the watchdog, which nothing but a reset stops. What follows has a third of a second until the first
/// [`Watchdog::look`].
pub fn start() {
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
        Self { asked: Instant::now(), beats: 0 }
    }

    /// Call it often: feeds the watchdog if all contexts have run since they were asked to, and asks them again.
    pub fn look(&mut self) {
        if self.asked.elapsed() < INTERVAL {
            return;
        }
        let beats = BEATS.load(Ordering::Relaxed);
        // Nothing holds the Stepper off, so its request, once made, is waiting only if it never runs.
        if beats != self.beats && !NVIC::is_pending(step_timer::IRQ) {
            feed();
            self.beats = beats;
        }
        self.asked = Instant::now();
        IrqPend.pend_stepper();
        IrqPend.pend_generator();
    }
}
