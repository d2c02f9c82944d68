//! Time: TIM2 counts microseconds, and calls each millisecond.
//!
//! Its counter has 16 bits here, as a fan may share the timer, and the handler counts its half laps: the ends of laps
//! and their middles. So the count of half laps is even while the counter is in its lower half. A read that finds them
//! apart has met the end of a half lap, and needs no lock to know the time.
//!
//! | word | written by | read by |
//! |---|---|---|
//! | `HALF_LAPS`, `MILLIS` | the handler of TIM2 | any context below the Stepper |
//! | `DUE` | the task that waits | the handler of TIM2 |

use core::future::poll_fn;
use core::sync::atomic::{AtomicU32, Ordering::Acquire, Ordering::Relaxed, Ordering::Release};
use core::task::Poll;

use corehbot::units::{Instant, TICKS_PER_SECOND};
use corehbot_cortex_m4::finish_stores;
use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::pac::{Interrupt, RCC, TIM2};
use embassy_sync::waitqueue::AtomicWaker;

use crate::clocks::APB1_TIMER_HZ;
use crate::console_waker::wake_console;
use crate::heater_timer;

/// The interrupt of half laps and milliseconds.
pub const IRQ: Interrupt = Interrupt::TIM2;

/// Counts a second.
const HZ: u32 = 1_000_000;

/// Counts of a millisecond.
const MILLI: u16 = (HZ / 1000) as u16;

/// The next millisecond is at least so many counts away when it is set, so the counter cannot pass it meanwhile.
const NEAR: u16 = 20;

/// The channels that mark the middle of a lap and the next millisecond. Fans have the others (`FanTimer::channels`).
const MIDDLE: usize = 0;
const NEXT: usize = 1;

/// Half laps of the counter, of 33 ms: they wrap after 4.4 years.
static HALF_LAPS: AtomicU32 = AtomicU32::new(0);

/// Milliseconds, wrapping.
static MILLIS: AtomicU32 = AtomicU32::new(0);

/// The task that waits, and the millisecond that it waits for.
static WAITING: AtomicWaker = AtomicWaker::new();
static DUE: AtomicU32 = AtomicU32::new(0);

/// Starts the time, at 0. Its interrupt is enabled at once, because the time is its count.
pub fn start() {
    RCC.apb1enr().modify(|w| w.set_tim2en(true));
    // It answers two cycles after its clock is on (ES0298, delay after an RCC peripheral clock enabling).
    let _ = RCC.apb1enr().read();
    TIM2.psc().write_value((APB1_TIMER_HZ / HZ - 1) as u16);
    TIM2.arr().write_value(u16::MAX.into());
    TIM2.ccr(MIDDLE).write_value(1 << 15);
    TIM2.ccr(NEXT).write_value(MILLI.into());
    // The prescaler counts from an update on. An update by software is none that counts.
    TIM2.cr1().write(|w| w.set_urs(Urs::COUNTER_ONLY));
    TIM2.egr().write(|w| w.set_ug(true));
    TIM2.dier().write(|w| {
        w.set_uie(true);
        w.set_ccie(MIDDLE, true);
        w.set_ccie(NEXT, true);
    });
    // The counter and all compare registers were 0 before, which may count as a comparison.
    TIM2.sr().write(|_| ());
    NVIC::unpend(IRQ);
    // SAFETY: called once from start-up, outside of any critical section; the handler uses statics of this file.
    unsafe { NVIC::unmask(IRQ) };
    go_on();
}

fn go_on() {
    TIM2.cr1().modify(|w| w.set_cen(true));
}

/// Stops the time during `work`, which may hold off interrupts for longer than a half lap, 33 ms. Without this at most
/// two of the half laps that end in that time would be counted. After an odd number of uncounted half laps, every later
/// read just when a half lap ends would go back by 65 ms.
pub fn without_time<R>(work: impl FnOnce() -> R) -> R {
    TIM2.cr1().modify(|w| w.set_cen(false));
    let result = work();
    go_on();
    result
}

/// The time since the start.
#[inline(never)]
pub fn now() -> Instant {
    const { assert!(TICKS_PER_SECOND.is_multiple_of(HZ)) };
    // The count first: it is never ahead of the counter then.
    let half_laps = HALF_LAPS.load(Acquire);
    let count = TIM2.cnt().read() ^ (half_laps & 1) << 15;
    Instant((u64::from(half_laps) * (1 << 15) + u64::from(count)) * u64::from(TICKS_PER_SECOND / HZ))
}

/// Waits so many milliseconds. One task may wait at a time: each mode of the firmware has one that does.
pub async fn pass(millis: u32) {
    let due = MILLIS.load(Relaxed).wrapping_add(millis);
    DUE.store(due, Relaxed);
    poll_fn(|context| {
        WAITING.register(context.waker());
        let left = due.wrapping_sub(MILLIS.load(Acquire)).cast_signed();
        if left <= 0 { Poll::Ready(()) } else { Poll::Pending }
    })
    .await;
}

/// A half lap ends, or a millisecond.
#[interrupt]
fn TIM2() {
    let flags = TIM2.sr().read();
    // Flags are cleared by writing 0, and writing 1 leaves those that come meanwhile.
    TIM2.sr().write(|w| w.0 = !flags.0);
    let half_laps = u32::from(flags.uif()) + u32::from(flags.ccif(MIDDLE));
    // A load and a store: only this handler writes.
    HALF_LAPS.store(HALF_LAPS.load(Relaxed).wrapping_add(half_laps), Release);
    if flags.ccif(NEXT) {
        count_millisecond();
    }
    finish_stores();
}

fn count_millisecond() {
    let count = TIM2.cnt().read() as u16;
    let next = (TIM2.ccr(NEXT).read() as u16).wrapping_add(MILLI);
    // After a handler that was held off for long, milliseconds are lost.
    let is_ahead = (NEAR..=MILLI).contains(&next.wrapping_sub(count));
    TIM2.ccr(NEXT).write_value(if is_ahead { next } else { count.wrapping_add(MILLI) }.into());
    let millis = MILLIS.load(Relaxed).wrapping_add(1);
    MILLIS.store(millis, Release);
    heater_timer::ask_if_overdue();
    wake_console();
    if millis == DUE.load(Relaxed) {
        WAITING.wake();
    }
}
