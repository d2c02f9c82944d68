//! Time: one 25 MHz counter, seen as ticks of 10 MHz and extended to 64 bits.

use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::port::{Clock, StepClock};
use corehbot::units::{Instant, Tick};
use cortex_m::peripheral::{NVIC, SYST};

use super::registers::{COUNTER, step_timer};
use super::vectors::Irq;

/// Counter and timers (measured in QEMU 7.2; ARM DAI 0386C gives the FPGA's 25 MHz).
const COUNTS_PER_SECOND: u32 = 25_000_000;

/// Counts are to ticks as 5 is to 2.
const COUNTS_PER_TICK: (u64, u64) = (5, 2);

/// How often the counter has passed a half of its range. The low bit says in which half it was last
/// seen, so a reader knows which number belongs to the counter it read, even if the counter passed the
/// next half in between. [`beat`] is the only writer and comes every millisecond; a half takes 86 s.
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
}

/// Ticks since start.
fn ticks() -> u64 {
    counts() * COUNTS_PER_TICK.1 / COUNTS_PER_TICK.0
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
    fn now(&self) -> Tick {
        Tick(ticks() as u32)
    }

    fn alarm(&mut self, at: Tick) {
        let counts = counts();
        let ticks = counts * COUNTS_PER_TICK.1 / COUNTS_PER_TICK.0;
        let now = Tick(ticks as u32);
        if !now.is_before(at) {
            NVIC::pend(Irq::StepTimer);
            return;
        }
        // The first count at which the tick has come.
        let due = ((ticks + u64::from(at.since(now))) * COUNTS_PER_TICK.0).div_ceil(COUNTS_PER_TICK.1);
        step_timer::VALUE.write(u32::try_from(due - counts).unwrap_or(u32::MAX));
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
