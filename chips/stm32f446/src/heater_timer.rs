//! The heater timer: TIM5 in one-pulse mode puts out the heaters' pulses, and the interrupt at its end is the control
//! period. A board may have heaters on two more timers, which count along with it ([`NarrowHeaters`]).
//!
//! A dead man's switch in hardware. The counter is started for one control period and stops by itself. While it stands
//! at 0, all outputs are low (see [`heater_pulses`]), even if the processor hangs, waits in an endless interrupt,
//! erases flash or is halted. So a heater goes off at most 20 ms after it was switched on, unless it is requested
//! again; that needs no instruction. The watchdog's reset comes 0.34 to 0.94 s later.
//!
//! The interrupt has only one source, the counter's end. TIM5 has it on every board, also without a heater of its own.
//! Only [`heat`] starts the counter, once a period, at the end of the interrupt. If one control period fails to call
//! it, that period is the last, and nothing feeds the watchdog any more. The Console plays no part in this.
//!
//! While a debugger halts the processor the timer runs on (DBG_TIM5_STOP stays 0), so a halt acts like any other hang.
//! TIM5 stopped in the middle of a pulse would hold its output high: only TIM1 and TIM8 release their outputs in a halt
//! (RM0390, TIM1 and TIM8, debug mode).

use core::sync::atomic::{AtomicU32, Ordering};

use corehbot::port::OUTPUTS;
use cortex_m::peripheral::{DWT, NVIC};
use embassy_stm32::pac::{DBGMCU, Interrupt, RCC, TIM5};

use crate::heater_pulses::{Grid, LATEST, NEVER, PERIOD, compare};
use crate::heater_registers;
use crate::narrow_heaters::NarrowHeaters;
use crate::wiring::{HeaterPin, HeaterTimer as Timer};

/// The interrupt of the control period.
pub const IRQ: Interrupt = Interrupt::TIM5;

/// Channels of the timer.
const CHANNELS: usize = 4;

/// The timer, running.
pub struct HeaterTimer {
    heaters: &'static [HeaterPin],
    narrow: NarrowHeaters,
    grid: Grid,
}

impl HeaterTimer {
    /// Takes the timer and connects the pins to it; their level does not change by that. The first period begins with
    /// [`heat`](Self::heat).
    pub fn start(heaters: &'static [HeaterPin]) -> Self {
        RCC.apb1enr().modify(|w| w.set_tim5en(true));
        // It answers two cycles after its clock is on (ES0298, delay after an RCC peripheral clock enabling).
        let _ = RCC.apb1enr().read();
        DBGMCU.apb1fzr().modify(|w| w.set_tim5(false));
        TIM5.arr().write_value(PERIOD - 1);
        // Before the mode: a compare value of 0 is high while the counter stands.
        for channel in 0..CHANNELS {
            TIM5.ccr(channel).write_value(NEVER);
        }
        let narrow = NarrowHeaters::start(heaters);
        // Mode, outputs and interrupt, and the pins after all of these.
        heater_registers::set_all(heaters);
        TIM5.egr().write(|w| w.set_ug(true));
        TIM5.sr().write(|w| w.0 = 0);
        narrow.reload();
        Self { heaters, narrow, grid: Grid::new(DWT::cycle_count()) }
    }

    /// Begins a control period with these duties.
    pub fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        heater_registers::keep(self.heaters);
        let now = DWT::cycle_count();
        // Never 0, which says that no period has begun.
        BEGUN.store(now | 1, Ordering::Relaxed);
        let counts = self.grid.next(now);
        TIM5.arr().write_value(counts - 1);
        self.narrow.begin(duties, counts);
        for heater in on_tim5(self.heaters) {
            let duty = duties[heater.output as usize];
            TIM5.ccr(usize::from(heater.channel) - 1).write_value(compare(duty, counts));
        }
        // Sets the counter to 0, where all outputs are low, and lets the values above take effect.
        TIM5.egr().write(|w| w.set_ug(true));
        TIM5.cr1().modify(|w| w.set_cen(true));
    }
}

/// The heaters on TIM5 itself.
fn on_tim5(heaters: &'static [HeaterPin]) -> impl Iterator<Item = &'static HeaterPin> {
    heaters.iter().filter(|heater| heater.timer == Timer::Five)
}

/// When the present control period began, in cycles of the core; 0 before the first.
static BEGUN: AtomicU32 = AtomicU32::new(0);

/// Asks for a control period if the present one should have ended by now, and neither waits for its turn nor is at
/// work: then its counter stands, or runs on without end. Called every ms.
pub fn ask_if_overdue() {
    let begun = BEGUN.load(Ordering::Relaxed);
    if begun != 0 && DWT::cycle_count().wrapping_sub(begun) > LATEST && !NVIC::is_pending(IRQ) && !NVIC::is_active(IRQ)
    {
        NVIC::pend(IRQ);
    }
}

/// The interrupt has come: takes it back.
pub fn acknowledge() {
    TIM5.sr().write(|w| w.0 = 0);
    // The write has to arrive before the handler returns (ARM DAI 0321A, 4.9); reading waits for it.
    let _ = TIM5.sr().read();
}

/// Control periods since start, wrapping.
static PERIODS: AtomicU32 = AtomicU32::new(0);

/// Counts a period; says which second since start begins, if one does.
pub fn count_period() -> Option<u32> {
    /// Periods in a second.
    const RATE: u32 = 50;
    let periods = PERIODS.load(Ordering::Relaxed).wrapping_add(1);
    PERIODS.store(periods, Ordering::Relaxed);
    periods.is_multiple_of(RATE).then_some(periods / RATE)
}
