//! The heaters' registers: their right values, compared in each control period, and written where they differ.
//!
//! A bit that flips by itself could force a heater's pin high, let the timer's count go on for ever, or give the pin to
//! somebody else. With this it acts for two control periods at most, 40 ms. `emulator/tests/heater_registers.rs` flips
//! each of these bits and measures it. Reload and compare values are no part of this, as each period writes new ones.
//!
//! Bits that stop the count or take its clock end the control periods. Then the time's interrupt asks for one
//! ([`heater_timer::ask_if_overdue`](crate::heater_timer::ask_if_overdue)), and this sets the registers right.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_stm32::pac::gpio::vals::{Moder, Ot, Pupdr};
use embassy_stm32::pac::rcc::regs::{Ahb1enr, Apb1enr};
use embassy_stm32::pac::{RCC, TIM3, TIM5, TIM12};

use crate::heater_pulses::{NARROW, PULSES};
use crate::wiring::{HeaterPin, HeaterTimer};
use crate::{ports, resources};

/// CR1 between two periods: ARPE, OPM and URS, so the interrupt is raised by the counter's end alone and not by
/// software's update (RM0390, TIM2 to TIM5, CR1).
const CONTROL: u32 = 1 << 7 | 1 << 3 | 1 << 2;

/// UIE (RM0390, TIM2 to TIM5, DIER).
const INTERRUPTS: u32 = 1;

/// Sets made since the start, wrapping: only the control period writes.
static SET_RIGHT: AtomicU32 = AtomicU32::new(0);

/// How often registers were set right since the start.
pub fn times_set_right() -> u32 {
    SET_RIGHT.load(Ordering::Relaxed)
}

/// Writes a register if it has another value; says whether it had.
macro_rules! set {
    ($register:expr, $right:expr) => {{
        let (register, right) = ($register, $right);
        let has_changed = u32::from(register.read().0) != right;
        if has_changed {
            register.write(|w| w.0 = right as _);
        }
        has_changed
    }};
}

/// The registers that any heater timer has. The control register first: it stops a count that does not end.
macro_rules! set_timer {
    ($timer:ident, $interrupts:expr, $factor:expr, $outputs:expr) => {{
        let mut has_changed = set!($timer.cr1(), CONTROL);
        // Nothing starts, stops or clocks the count but this timer's own clock.
        has_changed |= set!($timer.smcr(), 0);
        has_changed |= set!($timer.dier(), $interrupts);
        has_changed |= set!($timer.ccer(), $outputs);
        if $timer.psc().read() != $factor {
            $timer.psc().write_value($factor);
            has_changed = true;
        }
        has_changed
    }};
}

/// Sets the registers right while no count is under way; counts it if one of them had another value.
pub fn keep(heaters: &'static [HeaterPin]) {
    if set_all(heaters) {
        SET_RIGHT.store(times_set_right().wrapping_add(1), Ordering::Relaxed);
    }
}

/// Sets all of them; says whether one had another value.
pub fn set_all(heaters: &'static [HeaterPin]) -> bool {
    let outputs = |timer| {
        let channels = heaters.iter().filter(move |heater| heater.timer == timer).map(|heater| heater.channel);
        // CCxE (RM0390, TIM2 to TIM5, CCER).
        channels.fold(0, |bits, channel| bits | 1 << (4 * (u32::from(channel) - 1)))
    };
    let (on_3, on_5, on_12) = (outputs(HeaterTimer::Three), outputs(HeaterTimer::Five), outputs(HeaterTimer::Twelve));
    let mut has_changed = set_clocks(on_3 != 0, on_12 != 0);
    has_changed |= set_timer!(TIM5, INTERRUPTS, 0, on_5);
    for pair in 0..2 {
        has_changed |= set!(TIM5.ccmr_output(pair), PULSES);
    }
    if on_3 != 0 {
        has_changed |= set_timer!(TIM3, 0, NARROW as u16 - 1, on_3);
        for pair in 0..2 {
            has_changed |= set!(TIM3.ccmr_output(pair), PULSES);
        }
    }
    if on_12 != 0 {
        has_changed |= set_timer!(TIM12, 0, NARROW as u16 - 1, on_12);
        has_changed |= set!(TIM12.ccmr_output(0), PULSES);
    }
    heaters.iter().fold(has_changed, |has_changed, heater| set_pin(heater) | has_changed)
}

/// Clocks timers and ports, and lets no timer be reset: its reset bit has the place of its clock's (RM0390, 6.3.8 and
/// 6.3.13). A port that was reset has lost the pins of motors and lines too, and heats no more.
fn set_clocks(has_3: bool, has_12: bool) -> bool {
    let (mut timers, mut gpio) = (Apb1enr(0), Ahb1enr(0));
    timers.set_tim5en(true);
    timers.set_tim3en(has_3);
    timers.set_tim12en(has_12);
    gpio.set_gpioaen(true);
    gpio.set_gpioben(true);
    gpio.set_gpiocen(true);
    let (timers, gpio) = (timers.0, gpio.0);
    let are_clocked = RCC.apb1enr().read().0 & timers == timers && RCC.ahb1enr().read().0 & gpio == gpio;
    let is_reset = RCC.apb1rstr().read().0 & timers != 0;
    if are_clocked && !is_reset {
        return false;
    }
    critical_section::with(|_| {
        RCC.apb1enr().modify(|w| w.0 |= timers);
        RCC.ahb1enr().modify(|w| w.0 |= gpio);
        RCC.apb1rstr().modify(|w| w.0 &= !timers);
    });
    // They answer two cycles after their clock is on (ES0298, delay after an RCC peripheral clock enabling).
    let _ = RCC.apb1enr().read();
    true
}

/// Gives a pin to its timer.
fn set_pin(heater: &HeaterPin) -> bool {
    let (port, number) = (ports::registers(heater.pin.port), heater.pin.number());
    let function = resources::heater_timer(heater.timer).1;
    let is_right = port.moder().read().moder(number) == Moder::ALTERNATE
        && port.otyper().read().ot(number) == Ot::PUSH_PULL
        && port.pupdr().read().pupdr(number) == Pupdr::PULL_DOWN
        && port.afr(number / 8).read().afr(number % 8) == function;
    if is_right {
        return false;
    }
    // The drivers' UART changes modes of its own pins in the same registers. Steps go on: they change no mode.
    critical_section::with(|_| {
        ports::put(heater.pin, false);
        port.otyper().modify(|w| w.set_ot(number, Ot::PUSH_PULL));
        ports::drive_by(heater.pin, function);
    });
    true
}
