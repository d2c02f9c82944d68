//! The step timer: TIM2 counts ticks of 10 MHz in 32 bits and compares.

use corehbot::port::{Clock, StepClock};
use corehbot::units::{Instant, TICKS_PER_SECOND, Tick};
use embassy_stm32::pac::{Interrupt, RCC, TIM2};

use crate::clocks::TIMER_HZ;

/// The interrupt of the steps.
pub const IRQ: Interrupt = Interrupt::TIM2;

/// Timer clocks a tick.
const DIVISOR: u32 = TIMER_HZ / TICKS_PER_SECOND;
const _: () = assert!(DIVISOR * TICKS_PER_SECOND == TIMER_HZ);

/// Lets the timer run, silent.
pub fn start() {
    RCC.apb1enr().modify(|w| w.set_tim2en(true));
    let _ = RCC.apb1enr().read();
    TIM2.psc().write_value((DIVISOR - 1) as u16);
    TIM2.arr().write_value(u32::MAX);
    // The prescaler is taken over by an update.
    TIM2.egr().write(|w| w.set_ug(true));
    TIM2.sr().write(|_| ());
    TIM2.cr1().modify(|w| w.set_cen(true));
}

/// Takes the timer's request back; harmless if software pended the interrupt.
#[inline(always)]
pub fn acknowledge() {
    // Flags are cleared by writing 0, and only compare 1 is in use.
    TIM2.sr().write(|_| ());
}

/// The step timer's port.
pub struct StepTimer;

impl StepClock for StepTimer {
    #[inline(always)]
    fn now(&self) -> Tick {
        Tick(TIM2.cnt().read())
    }

    #[inline(never)]
    fn alarm(&mut self, at: Tick) -> bool {
        TIM2.dier().write(|w| w.set_ccie(0, true));
        self.alarm_again(at)
    }

    #[inline(always)]
    fn alarm_again(&mut self, at: Tick) -> bool {
        TIM2.ccr(0).write_value(at.0);
        // The counter may have passed the tick before the comparison began, and then it would take 429 s.
        self.now().is_before(at)
    }

    #[inline]
    fn silence(&mut self) {
        TIM2.dier().write(|_| ());
    }
}

/// The Console's clock: embassy's time.
pub struct BoardClock;

impl Clock for BoardClock {
    fn now(&self) -> Instant {
        Instant(embassy_time::Instant::now().as_ticks() * TICKS_PER_EMBASSY_TICK)
    }
}

/// Ticks of 0.1 us in one of embassy's.
const TICKS_PER_EMBASSY_TICK: u64 = TICKS_PER_SECOND as u64 / embassy_time::TICK_HZ;
const _: () = assert!(TICKS_PER_EMBASSY_TICK * embassy_time::TICK_HZ == TICKS_PER_SECOND as u64);
