//! The supply: the reaction when the processor's 3.3 V fail.
//!
//! - Below 2.93 V (2.85 to 2.99) the detector (PVD, level 6) raises an interrupt that nothing masks: heaters low,
//!   drivers off, a note, reset. Level 6 is the highest usable level: its upper threshold is 3.10 V at most, and a rail
//!   of 3.3 V less 3 % has certainly passed that. Level 7 has 3.21 V.
//! - Below 2.83 V (2.75 to 2.88) the chip resets itself (BOR level 3), if its option bytes say so. Flash at 180 MHz
//!   needs 2.7 V (RM0390, table of wait states).
//! - Below 1.7 V the chip resets itself in any case.
//!
//! Thresholds are falling edges (STM32F446 datasheet, embedded reset and power control block characteristics). Without
//! BOR the processor may do anything between 2.7 and 1.7 V. That happens when the rail falls faster than the detector's
//! interrupt, or comes back slowly. Chips are delivered without BOR. The person who sets up the board writes the option
//! bytes once (the board's README says how); the firmware never does. If power fails while they are written, the chip
//! may lock, and power is likely to fail in a test of power.

use corehbot::fault::Cause;
use embassy_stm32::interrupt;
use embassy_stm32::pac::{EXTI, FLASH, Interrupt, PWR, RCC};

use crate::{fault, watchdog};

/// The interrupt of the detector.
pub const IRQ: Interrupt = Interrupt::PVD;

/// PLS: 2.93 V falling, 3.03 V rising.
const LEVEL: u8 = 0b110;

/// The detector's line of EXTI (RM0390, 10.2.5).
const LINE: usize = 16;

/// BOR_LEV: level 3 (RM0390, 3.9.10, FLASH_OPTCR).
const LEVEL_3: u8 = 0b00;

/// Message to hosts if the chip does not reset itself in time.
const UNGUARDED: &str = "brown-out reset is not at level 3: while its supply fails the processor may do anything; the \
                         README of the board says how to set it";

/// Waits for a supply that is high enough for full speed. The outputs are safe and the processor is slow here, so a
/// board with too low a supply does nothing.
pub fn wait() {
    detect();
    while is_low() {
        watchdog::feed();
    }
}

/// Watches the supply from now on; the interrupt is not enabled yet.
pub fn watch() {
    // The code that set the clocks may have reset the detector.
    detect();
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.ftsr(0).modify(|w| w.set_line(LINE, false));
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    // It may have fallen before there was an edge to see.
    if is_low() {
        fall();
    }
}

/// The message about missing brown-out protection, if it is missing.
pub fn warning() -> Option<&'static str> {
    (FLASH.optcr().read().bor_lev() != LEVEL_3).then_some(UNGUARDED)
}

/// The same as a line for a host; nothing if nothing lacks.
pub fn warning_parts() -> impl Iterator<Item = &'static str> {
    warning().map(|warning| ["echo:", warning, "\n"]).into_iter().flatten()
}

fn detect() {
    RCC.apb1enr().modify(|w| w.set_pwren(true));
    let _ = RCC.apb1enr().read();
    PWR.cr1().modify(|w| {
        w.set_pls(LEVEL);
        w.set_pvde(true);
    });
}

fn is_low() -> bool {
    PWR.csr1().read().pvdo()
}

fn fall() -> ! {
    fault::give_up(Cause::Supply, "the supply fell below 2.9 V")
}

/// The supply falls.
#[interrupt]
fn PVD() {
    fall();
}
