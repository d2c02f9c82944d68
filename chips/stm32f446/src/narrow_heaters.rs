//! Heaters on timers of 16 bits, TIM3 and TIM12, which put out pulses beside the heater timer.
//!
//! Each timer in use starts with the control period and stops by itself, as TIM5 does ([`heater_timer`]), with all of
//! its outputs low. Heaters on one timer share its count, and each has a compare value of its own. The timer starts
//! just before TIM5, and its count is rounded down. So it has ended when the period ends.
//!
//! No interrupt and no other instruction has a part in that: a heater goes off at most 20 ms after it went on.
//!
//! [`heater_timer`]: crate::heater_timer

use corehbot::port::OUTPUTS;
use embassy_stm32::pac::{DBGMCU, RCC, TIM3, TIM12};

use crate::heater_pulses::{NEVER_NARROW, PERIOD, narrow_compare, narrow_counts};
use crate::wiring::{HeaterPin, HeaterTimer};

/// The timers of a board's heaters.
pub struct NarrowHeaters {
    heaters: &'static [HeaterPin],
}

/// Makes a timer ready for its modes, which [`heater_registers`](crate::heater_registers) sets: the types of the timers
/// differ, their registers do not.
macro_rules! prepare {
    ($timer:ident, $channels:expr) => {{
        $timer.arr().write(|w| w.set_arr(narrow_counts(PERIOD) - 1));
        for channel in 0..$channels {
            // Before the mode: a compare value of 0 is high while the counter stands.
            $timer.ccr(channel).write(|w| w.set_ccr(NEVER_NARROW));
        }
    }};
}

/// Starts a timer's count, with these duties.
macro_rules! begin {
    ($timer:ident, $counts:expr, $duties:expr, $heaters:expr) => {{
        $timer.arr().write(|w| w.set_arr($counts - 1));
        for heater in $heaters {
            let compare = narrow_compare($duties[heater.output as usize], $counts);
            $timer.ccr(usize::from(heater.channel) - 1).write(|w| w.set_ccr(compare));
        }
        // Sets the counter to 0, where all outputs are low, and lets the values above take effect.
        $timer.egr().write(|w| w.set_ug(true));
        $timer.cr1().modify(|w| w.set_cen(true));
    }};
}

impl NarrowHeaters {
    /// Takes the timers that heaters are on. Nothing counts before [`begin`](Self::begin).
    pub fn start(heaters: &'static [HeaterPin]) -> Self {
        let timers = Self { heaters };
        let of = |timer| timers.of(timer);
        RCC.apb1enr().modify(|w| {
            w.set_tim3en(of(HeaterTimer::Three).next().is_some());
            w.set_tim12en(of(HeaterTimer::Twelve).next().is_some());
        });
        // They answer two cycles after their clock is on (ES0298, delay after an RCC peripheral clock enabling).
        let _ = RCC.apb1enr().read();
        // No reset but power-on clears these bits. A count that a debugger stops would hold its outputs.
        DBGMCU.apb1fzr().modify(|w| {
            w.set_tim3(false);
            w.set_tim12(false);
        });
        if of(HeaterTimer::Three).next().is_some() {
            prepare!(TIM3, 4);
        }
        if of(HeaterTimer::Twelve).next().is_some() {
            prepare!(TIM12, 2);
        }
        timers
    }

    /// Takes the prescalers over, which an update does.
    pub fn reload(&self) {
        if self.of(HeaterTimer::Three).next().is_some() {
            TIM3.egr().write(|w| w.set_ug(true));
        }
        if self.of(HeaterTimer::Twelve).next().is_some() {
            TIM12.egr().write(|w| w.set_ug(true));
        }
    }

    /// Begins a control period of `counts` of the heater timer.
    pub fn begin(&self, duties: &[u16; OUTPUTS], counts: u32) {
        let counts = narrow_counts(counts);
        if self.of(HeaterTimer::Three).next().is_some() {
            begin!(TIM3, counts, duties, self.of(HeaterTimer::Three));
        }
        if self.of(HeaterTimer::Twelve).next().is_some() {
            begin!(TIM12, counts, duties, self.of(HeaterTimer::Twelve));
        }
    }

    /// The heaters on a timer.
    fn of(&self, timer: HeaterTimer) -> impl Iterator<Item = &'static HeaterPin> + use<> {
        self.heaters.iter().filter(move |heater| heater.timer == timer)
    }
}
