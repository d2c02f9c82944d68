//! The step timer: the core's cycle counter is the clock, and the core's own timer (SysTick) fires the interrupt.
//!
//! Neither needs a bus access. A timer on APB1, which runs at a quarter of the core's clock, stalls the core for 9 to
//! 13 cycles at every access. Its interrupt also has to be cleared: four accesses an event.
//!
//! A tick is 18 cycles. The cycle of a tick is its number times 18, and both wrap at 2^32, so they stay in step. The
//! cycle counter wraps first, after 23.8 s. So cycles measure near times; [`StepTimer::now`] measures far ones by
//! counting on from its last call. While there is motion, the Stepper calls it every few seconds at the latest; at
//! rest, lost ticks do not matter.
//!
//! A debugger that halts the core halts both. Whether the cycle counter counts while the processor sleeps is up to the
//! chip, so that is [measured](StepTimer::start) at start-up.

use core::arch::asm;
use core::cell::Cell;

use corehbot::port::{Clock, StepClock};
use corehbot::units::{Instant, TICKS_PER_SECOND, Tick};
use cortex_m::interrupt;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{DWT, SCB, SYST};

use crate::clocks::CORE_HZ;
use crate::time;

/// Cycles a tick.
const CYCLES: u32 = CORE_HZ / TICKS_PER_SECOND;
const _: () = assert!(CYCLES * TICKS_PER_SECOND == CORE_HZ);

/// For a later tick the timer fires early, after 23 ms, and is set again. One in 256 events is checked closely, so
/// plain ones take at most 6 s, and no lap of the cycle counter is mistaken for another. The timer itself has 24 bits
/// (ARM DDI 0403E, B3.3.4).
const LONGEST: u32 = NEAR * CYCLES + (1 << 22) - 1;
const _: () = assert!(256 * (LONGEST as u64) < 1 << 31 && LONGEST < 1 << 24);

/// The timer rings no sooner than this after it was set: 0.4 us, the way out of the interrupt and into it again.
const NEAR: u32 = 4;

/// The timer fires this many cycles early. The core takes 12 from there to the handler's first instruction (ARM 100166,
/// 3.9). Setting the alarm after reading the counter takes 6. The handler reads the counter again, so no step comes
/// before its tick.
const EARLY: u32 = 12 + 6;
const _: () = assert!(EARLY < (NEAR - 1) * CYCLES);

/// How long the processor sleeps to check that the counter runs during sleep: 0.1 ms.
const SLEEP: u32 = CORE_HZ / 10_000;

/// The step timer's port.
pub struct StepTimer {
    timer: SYST,
    /// The time when it was asked for last.
    last: Cell<Tick>,
}

impl StepTimer {
    /// Takes the timer, silent, and returns whether the cycle counter, which runs already, also runs while the
    /// processor sleeps. If not, the processor must not sleep.
    pub fn start(mut timer: SYST) -> (Self, bool) {
        timer.disable_counter();
        timer.set_clock_source(SystClkSource::Core);
        timer.enable_interrupt();
        // Nothing else may end the sleep: other interrupts are not enabled yet, and the Console's clock stands still.
        let slept = time::without_time(|| {
            interrupt::free(|_| {
                ring_in(&mut timer, SLEEP);
                timer.enable_counter();
                let begin = DWT::cycle_count();
                while !SCB::is_pendst_pending() {
                    cortex_m::asm::wfi();
                }
                timer.disable_counter();
                SCB::clear_pendst();
                DWT::cycle_count().wrapping_sub(begin)
            })
        });
        (Self { timer, last: Cell::new(Tick(0)) }, slept > SLEEP / 2)
    }
}

/// Cycles until a tick begins, below zero (wrapping) if it has begun. In the fewest registers: one more in the step
/// interrupt would have to be saved, with another for the stack's alignment.
#[inline(always)]
fn until(tick: Tick) -> u32 {
    const { assert!(CYCLES == 16 + 2) };
    let mut left = DWT::cycle_count();
    // SAFETY: two additions in registers, which touch nothing else.
    unsafe {
        asm!(
            "rsb {left}, {left}, {tick}, lsl #4",
            "add {left}, {left}, {tick}, lsl #1",
            left = inout(reg) left,
            tick = in(reg) tick.0,
            options(pure, nomem, nostack, preserves_flags),
        );
    }
    left
}

/// Whole ticks in a number of cycles: a product and a shift instead of a division. It is exact for all 32 bits: half of
/// the cycles is below 2^31, and the factor is 2^33 / 9, rounded up by less than 2 / 9.
#[inline(always)]
const fn ticks_in(cycles: u32) -> u32 {
    const { assert!(CYCLES == 18) };
    (((cycles as u64 >> 1) * 0x38E3_8E39) >> 33) as u32
}
const _: () = assert!(ticks_in(u32::MAX) == u32::MAX / 18 && ticks_in(17) == 0 && ticks_in(18) == 1);

/// Makes the timer fire once this many cycles have passed since the counter was read, and repeatedly until it is set
/// again.
#[inline(always)]
fn ring_in(timer: &mut SYST, cycles: u32) {
    timer.set_reload(cycles.wrapping_sub(EARLY));
    timer.clear_current();
}

impl StepClock for StepTimer {
    fn now(&self) -> Tick {
        let last = self.last.get();
        let now = last.after(ticks_in(until(last).wrapping_neg()));
        self.last.set(now);
        now
    }

    #[inline(always)]
    fn is_due(&self, at: Tick, ticks: u32) -> bool {
        // The difference is below zero, but by no more than `ticks`. True from the second cycle of the tick on, because
        // this is a single comparison.
        until(at) >= (ticks * CYCLES).wrapping_neg()
    }

    #[cold]
    #[inline(never)]
    fn alarm(&mut self, at: Tick) -> bool {
        let left = at.0.wrapping_sub(self.now().0).cast_signed();
        if left <= 0 {
            return false;
        }
        // The tick may have begun by now, so this may be below zero.
        let cycles = until(at).cast_signed().max(NEAR.cast_signed() * CYCLES.cast_signed());
        // Far away the cycles may have wrapped, so the timer rings early and is set again.
        let is_far = left.cast_unsigned() > LONGEST / CYCLES;
        ring_in(&mut self.timer, if is_far { LONGEST } else { cycles.cast_unsigned() });
        self.timer.enable_counter();
        true
    }

    #[inline(always)]
    fn alarm_again(&mut self, at: Tick) -> bool {
        let left = until(at);
        // Sets the alarm even if the value is invalid, because that is faster than checking first. The alarm is then
        // set again, or silenced, before any code waits for it.
        ring_in(&mut self.timer, left);
        left.wrapping_sub(NEAR * CYCLES) <= LONGEST - NEAR * CYCLES
    }

    fn silence(&mut self) {
        self.timer.disable_counter();
    }
}

/// The Console's clock.
pub struct BoardClock;

impl Clock for BoardClock {
    fn now(&self) -> Instant {
        time::now()
    }
}
