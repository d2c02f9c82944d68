//! The watchdog: a reset for a board in which any context has stopped.
//!
//! The thermal context feeds it, once in a control period, while it hears of all others (`corehbot::thermal`: hearts)
//! and while every sensor that is wired delivers. It cannot be held off by the Console, which it interrupts; a context
//! above it that hangs holds it off, and then nobody feeds.

use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::pac::{DBGMCU, IWDG};

/// Counts until the reset at 1 kHz. The oscillator has 17 to 47 kHz instead of 32 (STM32F446 datasheet, LSI),
/// so it comes after 0.34 to 0.94 s.
const COUNTS: u16 = 500;

/// The reload value has 12 bits (RM0390 rev 6, section 19.4.3).
const MOST_COUNTS: u16 = 4096;

/// Looks at the status while prescaler and reload value cross over, which takes five cycles of the slow oscillator
/// (RM0390 rev 6, section 19.3), 0.3 ms at 17 kHz: ten times that at four cycles a look and 180 MHz.
const CROSSING: u32 = 135_000;

/// Starts the watchdog, which nothing but a reset stops. What follows has a third of a second until the first
/// [`feed`] of the thermal context.
///
/// While a debugger halts the processor it stands still, or a breakpoint would end in a reset. So does embassy's time,
/// as the step timer does by itself, which is the core's own: the steps go on where they were, and both clocks agree.
/// What the outputs drive, they drive during a halt, but for heaters: their timer goes on and ends their pulses
/// (`heater_timer`).
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
    // Every feed locks the reload value again (RM0390 rev 6, section 19.3.2), also one by the thermal context in
    // between.
    critical_section::with(|_| {
        IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        IWDG.rlr().write(|w| w.set_rl(counts - 1));
    });
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

/// Begins the time until the reset anew. For the thermal context, for start-up, which has no other contexts yet, and
/// for a board that only talks.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
