//! Fans: pulse-width modulation at 98 Hz, or at a frequency that the machine names.
//!
//! A fan with two wires is switched on and off with its supply, and its motor's electronics have to start each time:
//! Klipper's default is a cycle of 10 ms (Config reference, `cycle_time` of a fan). One duty is one step of the timer,
//! so 0 is off and 65,535 is on without a gap. Fans on one timer have one frequency, which the core checks.
//!
//! A fan on TIM2 gets 15 Hz, the rate at which the time's counter goes round. Marlin's software modulation has half of
//! that (`SOFT_PWM_SCALE` 0). A fan without a timer is on while its duty is not 0.

use corehbot::port::FANS;
use embassy_stm32::pac::timer::vals::Ocm;
use embassy_stm32::pac::{RCC, TIM1, TIM2, TIM4, TIM9};

use crate::fan_cycle::{Cycle, compare};
use crate::ports;
use crate::resources::fan_timer;
use crate::wiring::{FanPin, FanTimer};

/// The timers' rates in MHz on APB2 and APB1 (RM0390, 6.2: clocks of the timers).
const ON_APB2: u32 = 180;
const ON_APB1: u32 = 90;

/// Two channels in PWM mode 1 (OCxM 110), with compare values that take effect at the end of a cycle (OCxPE).
const MODULATED: u32 = 0x6868;

/// The channel of TIM2 that a fan may have, from 0 (`FanTimer::channels`).
const LAST_CHANNEL: usize = 3;

/// ARPE, CEN.
const RUN: u32 = 1 << 7 | 1;

/// The fans of a board.
pub struct Fans {
    wired: &'static [FanPin],
}

/// Sets the rest of a timer's registers: the types differ, the layout does not.
macro_rules! run {
    ($timer:ident, $cycle:expr, $pairs:expr, $outputs:expr) => {{
        let cycle = $cycle;
        $timer.psc().write_value(cycle.prescaler);
        $timer.arr().write(|w| w.set_arr(cycle.last));
        for pair in 0..$pairs {
            $timer.ccmr_output(pair).write(|w| w.0 = MODULATED as _);
        }
        $timer.ccer().modify(|w| $outputs.for_each(|output| w.0 |= 1 << output));
        $timer.egr().write(|w| w.set_ug(true));
        $timer.cr1().write(|w| w.0 = RUN as _);
    }};
}

impl Fans {
    /// Lets the timers run at these frequencies in Hz, and hands them the pins: all fans off.
    pub fn start(wired: &'static [FanPin], frequencies: [u16; FANS]) -> Self {
        let cycle = |mhz, number| {
            let mut fans = wired.iter().zip(frequencies).filter(|(fan, _)| fan.timer.number() == Some(number));
            Cycle::of(mhz, fans.next().map_or(0, |(_, hz)| hz))
        };
        // The bits of outputs in CCER: CC1E is bit 0, CC1NE bit 2, and so on (RM0390, TIM1 and TIM8, CCER).
        let of = |timer| wired.iter().filter(move |fan| fan.timer == timer).map(|fan| 4 * (fan.channel - 1));
        let has = |timer| of(timer).next().is_some();
        let has_tim1 = has(FanTimer::One) || has(FanTimer::OneComplementary);
        RCC.apb2enr().modify(|w| {
            w.set_tim1en(has_tim1);
            w.set_tim9en(has(FanTimer::Nine));
        });
        RCC.apb1enr().modify(|w| w.set_tim4en(has(FanTimer::Four)));
        let _ = RCC.apb1enr().read();
        if has_tim1 {
            run!(
                TIM1,
                cycle(ON_APB2, 1),
                2,
                of(FanTimer::One).chain(of(FanTimer::OneComplementary).map(|output| output + 2))
            );
            // Nothing of TIM1 comes out without (RM0390, TIM1 and TIM8, MOE).
            TIM1.bdtr().modify(|w| w.set_moe(true));
        }
        if has(FanTimer::Two) {
            // The counter is the time's (`time`): nothing here touches it. It counts to 65,535.
            TIM2.ccr(LAST_CHANNEL).write_value(0);
            TIM2.ccmr_output(1).modify(|w| {
                w.set_ocm(1, Ocm::PWM_MODE1);
                w.set_ocpe(1, true);
            });
            TIM2.ccer().modify(|w| w.set_cce(LAST_CHANNEL, true));
        }
        if has(FanTimer::Four) {
            run!(TIM4, cycle(ON_APB1, 4), 2, of(FanTimer::Four));
        }
        if has(FanTimer::Nine) {
            run!(TIM9, cycle(ON_APB2, 9), 1, of(FanTimer::Nine));
        }
        // After the timers run with duties of 0, so that no fan starts for a moment.
        for fan in wired {
            // A fan without a timer has an output of its own already (`safe_levels`).
            if let Some((_, function, _)) = fan_timer(fan.timer) {
                ports::drive_by(fan.pin, function);
            }
        }
        Self { wired }
    }

    /// How many there are.
    pub const fn len(&self) -> usize {
        self.wired.len()
    }

    /// Runs one fan at this duty.
    pub fn set_fan(&mut self, fan: usize, duty: u16) {
        let Some(fan) = self.wired.get(fan) else { return };
        let channel = usize::from(fan.channel).saturating_sub(1);
        match fan.timer {
            FanTimer::One | FanTimer::OneComplementary => {
                TIM1.ccr(channel).write(|w| w.set_ccr(compare(duty, TIM1.arr().read().arr())));
            }
            FanTimer::Four => TIM4.ccr(channel).write(|w| w.set_ccr(compare(duty, TIM4.arr().read().arr()))),
            FanTimer::Nine => TIM9.ccr(channel).write(|w| w.set_ccr(compare(duty, TIM9.arr().read().arr()))),
            // One more than the counter reaches is on without a gap.
            FanTimer::Two => TIM2.ccr(channel).write_value(u32::from(duty) + u32::from(duty == u16::MAX)),
            FanTimer::None => ports::put(fan.pin, duty != 0),
        }
    }
}
