//! Tachometers of fans: their pulses, counted by a look at their inputs every 0.5 ms.
//!
//! TIM7 has an interrupt for that, which comes only if a fan has a tachometer. It is below the step interrupt, and
//! above everything that runs longer than 0.1 ms. So a pulse counts if it is 0.6 ms high and 0.6 ms low: up to some 800
//! pulses a second, 24,000 turns a minute of two pulses. A look at six inputs takes some 150 cycles, 0.2 % of the time.
//!
//! An input of the Octopus has 10 kOhm and 100 nF (schematic). So it rises in 0.8 ms to the level that counts as high
//! (STM32F446 datasheet, I/O static characteristics: 0.45 V_DD + 0.3 V). This is fast enough for 19,000 turns a minute.
//!
//! Lines of EXTI would count faster pulses. But a wire without a fan, next to a heater's, would then interrupt at any
//! rate.

use core::sync::atomic::{AtomicU16, Ordering};

use corehbot::port::FANS;
use corehbot_cortex_m4::{Handover, finish_stores};
use embassy_stm32::interrupt;
use embassy_stm32::pac::{Interrupt, RCC, TIM7};

use crate::interrupt_storm::{CallRate, count_call};
use crate::ports;
use crate::wiring::Input;

/// The interrupt of the look.
pub const IRQ: Interrupt = Interrupt::TIM7;

/// 90 MHz (RM0390, 6.2: clocks of the timers) over 90, and over 500: 2 kHz.
const PRESCALER: u16 = 90 - 1;
const LAST: u16 = 500 - 1;

/// Pulses of each fan's tachometer, wrapping; the interrupt alone writes them.
static PULSES: [AtomicU16; FANS] = [const { AtomicU16::new(0) }; FANS];

static RATE: CallRate = CallRate::new();

static INPUTS: Handover<[Option<Tachometer>; FANS]> = Handover::new();

/// A tachometer, as the interrupt knows it.
struct Tachometer {
    input: Input,
    was_high: bool,
}

/// The tachometers of a machine.
pub struct Tachometers {
    inputs: [Option<Input>; FANS],
}

impl Tachometers {
    /// Lets the timer run if there is one. The inputs are inputs already.
    pub fn start(inputs: [Option<Input>; FANS]) -> Self {
        if inputs.iter().any(Option::is_some) {
            // High before the first look, so that a wire that is high at start is no pulse.
            INPUTS.fill(inputs.map(|input| input.map(|input| Tachometer { input, was_high: true })));
            RCC.apb1enr().modify(|w| w.set_tim7en(true));
            let _ = RCC.apb1enr().read();
            TIM7.psc().write_value(PRESCALER);
            TIM7.arr().write(|w| w.set_arr(LAST));
            TIM7.dier().write(|w| w.set_uie(true));
            TIM7.cr1().write(|w| w.set_cen(true));
        }
        Self { inputs }
    }

    /// The pulses of a fan, wrapping.
    pub fn pulses(&self, fan: usize) -> Option<u16> {
        (*self.inputs.get(fan)?)?;
        Some(PULSES.get(fan)?.load(Ordering::Relaxed))
    }
}

/// It is time for a look.
#[interrupt]
fn TIM7() {
    count_call(IRQ, &RATE);
    TIM7.sr().write(|w| w.0 = 0);
    INPUTS.with(|inputs| {
        for (tachometer, pulses) in inputs.iter_mut().zip(&PULSES) {
            let Some(Tachometer { input, was_high }) = tachometer else { continue };
            let is_high = ports::is_high(input.pin);
            if is_high && !*was_high {
                // A load and a store: no other context writes it.
                pulses.store(pulses.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed);
            }
            *was_high = is_high;
        }
    });
    finish_stores();
}
