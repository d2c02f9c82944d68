//! Time: one 25 MHz counter, seen as ticks of 10 MHz and extended to 64 bits.

use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::port::{Clock, StepClock};
use corehbot::units::{Instant, Tick};
use cortex_m::peripheral::SYST;

use super::registers::{COUNTER, step_timer};

/// Counter and timers (measured in QEMU 7.2; ARM DAI 0386C gives the FPGA's 25 MHz).
const COUNTS_PER_SECOND: u32 = 25_000_000;

/// Most counts until an alarm; a greater difference means that the alarm has passed.
const LONGEST: u32 = 3 << 30;

/// Counts are to ticks as 5 is to 2.
const COUNTS_PER_TICK: (u64, u64) = (5, 2);

/// Number of half ranges that the counter has passed. The low bit names the half in which it was last seen. So a reader
/// knows the number for the counter that it read, even if the counter passed the next half in between. [`beat`] is the
/// only writer and comes every millisecond; a half takes 86 s.
static HALVES: AtomicU32 = AtomicU32::new(0);

/// Counts since start.
fn counts() -> u64 {
    let halves = HALVES.load(Ordering::Acquire);
    let count = COUNTER.read();
    (u64::from(halves) << 31) + u64::from(count ^ (halves << 31))
}

/// Keeps the upper half of the time; called every millisecond.
pub fn beat() {
    let halves = HALVES.load(Ordering::Relaxed);
    if COUNTER.read() >> 31 != halves & 1 {
        HALVES.store(halves.wrapping_add(1), Ordering::Release);
    }
    let counts = counts();
    // Five counts are two ticks, so only there a whole tick begins with a whole count.
    let counts = counts - counts % COUNTS_PER_TICK.0;
    // The step interrupt must find two that belong together.
    cortex_m::interrupt::free(|_| {
        BASE_COUNT.store(counts as u32, Ordering::Relaxed);
        BASE_TICK.store((counts / COUNTS_PER_TICK.0 * COUNTS_PER_TICK.1) as u32, Ordering::Relaxed);
    });
}

/// A recent count at which a tick began, and that tick: from there on 32 bits are enough. Renewed by [`beat`].
static BASE_COUNT: AtomicU32 = AtomicU32::new(0);
static BASE_TICK: AtomicU32 = AtomicU32::new(0);

/// Counts since the base.
#[inline(always)]
fn since_base() -> u32 {
    COUNTER.read().wrapping_sub(BASE_COUNT.load(Ordering::Relaxed))
}

/// Ticks since start.
pub fn ticks() -> u64 {
    fifth(counts() * COUNTS_PER_TICK.1)
}

/// A fifth of it, cut off, in two halves: the processor has no division of 64 bits, and the clock is read at every
/// turn.
fn fifth(n: u64) -> u64 {
    const { assert!(COUNTS_PER_TICK.0 == 5, "a tick has two and a half counts") };
    let (high, low) = ((n >> 32) as u32, n as u32);
    // The remainder of 2^32 is 1.
    u64::from(high) * (u64::from(u32::MAX) / 5) + u64::from(low / 5) + u64::from((high + low % 5) / 5)
}

/// The counter, for [`tick_of`].
#[inline(always)]
pub fn raw() -> u32 {
    COUNTER.read()
}

/// The tick at which the counter was `raw`, less than 171 s ago.
pub fn tick_of(raw: u32) -> u32 {
    let counts = counts();
    fifth((counts - u64::from((counts as u32).wrapping_sub(raw))) * COUNTS_PER_TICK.1) as u32
}

/// Microseconds since start.
pub fn micros() -> u64 {
    counts() / (COUNTS_PER_SECOND as u64 / 1_000_000)
}

/// Starts the step timer, still silent, and the millisecond.
pub fn start(mut systick: SYST) {
    // QEMU complains about a timer that starts at 0.
    step_timer::VALUE.write(u32::MAX);
    step_timer::CTRL.write(step_timer::RUN);
    step_timer::VALUE.write(0);
    systick.set_clock_source(cortex_m::peripheral::syst::SystClkSource::Core);
    systick.set_reload(COUNTS_PER_SECOND / 1000 - 1);
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
}

/// The step timer's port.
pub struct StepTimer;

impl StepTimer {
    /// Takes the timer's request back; harmless if software pended the interrupt.
    pub fn acknowledge() {
        step_timer::INTCLEAR.write(1);
    }
}

impl StepClock for StepTimer {
    #[inline(always)]
    fn now(&self) -> Tick {
        // Two fifths, exact up to a thousand million counts.
        let ticks = (u64::from(since_base()) * u64::from(u32::MAX / 5 * 2 + 1)) >> 32;
        Tick(BASE_TICK.load(Ordering::Relaxed).wrapping_add(ticks as u32))
    }

    #[inline(always)]
    fn alarm(&mut self, at: Tick) -> bool {
        // Below zero if the tick passed some time ago.
        let ticks = at.since(Tick(BASE_TICK.load(Ordering::Relaxed))) as i32;
        // The first count at which the tick has come, of up to 2.5 * 2^30.
        let counts = ticks.wrapping_mul(2).wrapping_add((ticks + 1) >> 1);
        let left = counts.cast_unsigned().wrapping_sub(since_base());
        // Less one, so that 0, which would stop the timer, counts as passed.
        let is_ahead = left.wrapping_sub(1) < LONGEST;
        if is_ahead {
            step_timer::VALUE.write(left);
        }
        is_ahead
    }

    fn silence(&mut self) {
        step_timer::VALUE.write(0);
    }
}

/// The Console's clock.
pub struct BoardClock;

impl Clock for BoardClock {
    fn now(&self) -> Instant {
        Instant(ticks())
    }
}
