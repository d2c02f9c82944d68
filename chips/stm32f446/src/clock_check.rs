//! The clock check: the processor's clock against its slow oscillator (LSI), which has no part in it.
//!
//! The calendar (RTC) counts the slow oscillator's cycles, and each half second the control period compares them with
//! its own. The slow oscillator has 17 to 47 kHz (STM32F446 datasheet, LSI), so at the start only a gross error shows,
//! such as a clock of a third or of three times its rate. From then on its rate is known, and follows slowly as it gets
//! warm. A clock that is off by a tenth for a second and a half is a fault: steps, feeds and heat would be off too.
//!
//! A clock that stops altogether is found by others: the clock security system and the watchdog.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use cortex_m::peripheral::DWT;
use embassy_stm32::pac::rcc::vals::Rtcsel;
use embassy_stm32::pac::{PWR, RCC, RTC};

use crate::after_bootloader::comes;
use crate::clocks::CORE_HZ;

/// Control periods between two looks: half a second, in which the count goes round once at most.
const EVERY: u32 = 25;

/// The count goes from here down to 0, with each cycle of the slow oscillator (RM0390, RTC_PRER, PREDIV_S with
/// PREDIV_A of 0).
const LAST: u32 = 0x7FFF;

/// The slow oscillator, Hz: 17 to 47 kHz (STM32F446 datasheet, LSI), and a sixteenth more.
const SLOWEST: u32 = 16_000;
const FASTEST: u32 = 50_000;

/// A look later than this says nothing, in cycles: at [`FASTEST`] the count goes round in 0.65 s.
const LONGEST: u32 = CORE_HZ / 10 * 6;

/// A rate is off if it differs by more than a tenth of the known one.
const TENTH: u32 = 10;

/// Looks in a row that must be off: one may fall into a disturbance.
const IN_A_ROW: u32 = 3;

/// The known rate follows by so much of a difference with each look: in two minutes by two thirds.
const FOLLOWS: i32 = 256;

/// Parts of a Hz in which the known rate is kept, so that it follows small differences.
const PARTS: i32 = 256;

/// The keys of the calendar's registers (RM0390, RTC_WPR).
const KEYS: [u8; 2] = [0xCA, 0x53];

/// The message for M122.
const UNCHECKED: &str = "the processor's clock is not checked: its calendar does not count";

/// Whether the calendar counts. All of these are written at the start and by the control period.
static COUNTS: AtomicBool = AtomicBool::new(false);
/// Control periods until the next look.
static LEFT: AtomicU32 = AtomicU32::new(0);
/// Both counts at the last look.
static SLOW: AtomicU32 = AtomicU32::new(0);
static CYCLES: AtomicU32 = AtomicU32::new(0);
/// The slow oscillator's rate by the clock, in [`PARTS`] of a Hz; 0 before the first look.
static KNOWN: AtomicU32 = AtomicU32::new(0);
/// Looks in a row that were off.
static OFF: AtomicU32 = AtomicU32::new(0);

/// Lets the calendar count the slow oscillator, which the watchdog keeps running.
pub fn start() {
    // Access to the calendar and its clock (RM0390, 5.4.1, DBP).
    PWR.cr1().modify(|w| w.set_dbp(true));
    RCC.csr().modify(|w| w.set_lsion(true));
    if !comes(|| RCC.csr().read().lsirdy()) {
        return;
    }
    // Another source stays until the backup domain is reset (RM0390, 6.3.20, RTCSEL).
    if ![Rtcsel::DISABLE, Rtcsel::LSI].contains(&RCC.bdcr().read().rtcsel()) {
        RCC.bdcr().modify(|w| w.set_bdrst(true));
        RCC.bdcr().modify(|w| w.set_bdrst(false));
    }
    RCC.bdcr().modify(|w| w.set_rtcsel(Rtcsel::LSI));
    RCC.bdcr().modify(|w| w.set_rtcen(true));
    for key in KEYS {
        RTC.wpr().write(|w| w.set_key(key));
    }
    RTC.isr().modify(|w| w.set_init(true));
    if comes(|| RTC.isr().read().initf()) {
        // In two writes (RM0390, calendar initialization and configuration).
        RTC.prer().write(|w| w.set_prediv_s(LAST as u16));
        RTC.prer().modify(|w| w.set_prediv_a(0));
        // The counter itself, without the shadow of a second clock (RM0390, RTC_CR, BYPSHAD).
        RTC.cr().modify(|w| w.set_bypshad(true));
        COUNTS.store(true, Relaxed);
    }
    RTC.isr().modify(|w| w.set_init(false));
    RTC.wpr().write(|w| w.set_key(0));
}

/// The message for M122 about a clock that is not checked.
pub fn warning() -> Option<&'static str> {
    (!COUNTS.load(Relaxed)).then_some(UNCHECKED)
}

/// Whether the clock has its rate, as far as is known. Called once in each control period.
pub fn is_right() -> bool {
    let left = LEFT.load(Relaxed);
    LEFT.store(left.checked_sub(1).unwrap_or(EVERY - 1), Relaxed);
    if left != 0 || !COUNTS.load(Relaxed) {
        return true;
    }
    let (slow, cycles) = (count(), DWT::cycle_count());
    let (slow_before, before) = (SLOW.swap(slow, Relaxed), CYCLES.swap(cycles, Relaxed));
    let passed = cycles.wrapping_sub(before);
    // The first look; or flash was erased or a debugger halted in between, and the count may have gone round.
    if before == 0 || passed > LONGEST {
        return true;
    }
    // The count goes down.
    let ticks = slow_before.wrapping_sub(slow) & LAST;
    if ticks == 0 && KNOWN.load(Relaxed) == 0 {
        // It never counted, which says nothing about the clock.
        COUNTS.store(false, Relaxed);
        return true;
    }
    let rate = (u64::from(ticks) * u64::from(CORE_HZ) / u64::from(passed.max(1))) as u32;
    judge(rate)
}

/// The next rate in Hz.
fn judge(rate: u32) -> bool {
    let known = KNOWN.load(Relaxed) / PARTS as u32;
    let is_off = if known == 0 { !(SLOWEST..FASTEST).contains(&rate) } else { rate.abs_diff(known) > known / TENTH };
    if is_off {
        let off = OFF.load(Relaxed) + 1;
        OFF.store(off, Relaxed);
        return off < IN_A_ROW;
    }
    OFF.store(0, Relaxed);
    let difference = rate.cast_signed() - known.cast_signed();
    let step = if known == 0 { difference * PARTS } else { difference * PARTS / FOLLOWS };
    KNOWN.store(KNOWN.load(Relaxed).wrapping_add_signed(step), Relaxed);
    true
}

/// The count: read until it is the same twice, as it may change during a read.
fn count() -> u32 {
    let read = || u32::from(RTC.ssr().read().ss());
    let mut last = read();
    for _ in 0..4 {
        let next = read();
        if next == last {
            break;
        }
        last = next;
    }
    last
}
