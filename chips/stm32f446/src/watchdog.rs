//! The watchdog: a reset for a board in which any context has stopped.
//!
//! The thermal context feeds it once in a control period, while all other contexts send heartbeats
//! (`corehbot::thermal`: hearts) and every wired sensor delivers. The Console cannot hold it off, because it interrupts
//! the Console. A context above it that hangs does hold it off, and then nothing feeds the watchdog.

use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::pac::{DBGMCU, IWDG};

/// Counts until the reset at 1 kHz. The oscillator has 17 to 47 kHz instead of 32 (STM32F446 datasheet, LSI),
/// so it comes after 0.34 to 0.94 s.
const COUNTS: u16 = 500;

/// The reload value has 12 bits (RM0390 rev 6, section 19.4.3).
const MOST_COUNTS: u16 = 4096;

/// Polls of the status while prescaler and reload value cross over. That takes five cycles of the slow oscillator
/// (RM0390 rev 6, section 19.3), 0.3 ms at 17 kHz. The limit is ten times that, at four cycles a poll and 180 MHz.
const CROSSING: u32 = 135_000;

/// Starts the watchdog; only a reset stops it. The first [`feed`] by the thermal context must come within a third of a
/// second.
///
/// The watchdog stands still while a debugger halts the processor; otherwise a breakpoint would end in a reset. So does
/// the Console's clock, and the step timer does by itself, being part of the core. So steps go on where they were, and
/// both clocks agree. Outputs keep their levels during a halt, except for heaters: their timer runs on and ends their
/// pulses (`heater_timer`).
pub fn start() {
    DBGMCU.apb1fzr().modify(|w| {
        w.set_iwdg(true);
        w.set_tim2(true);
    });
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY32));
    set_period(COUNTS);
}

/// Sets the longest period, 2.8 to 7.7 s, for an operation that stops the processor.
pub fn stretch() {
    set_period(MOST_COUNTS);
}

/// Takes that back.
pub fn restore() {
    set_period(COUNTS);
}

/// Starts a period of `counts` counts.
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

/// Restarts the period until the reset. Called by the thermal context, by start-up, which has no other contexts yet,
/// and by a board that only talks.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
