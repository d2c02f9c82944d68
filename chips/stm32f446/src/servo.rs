//! The servo line of a BLTouch: pulses of some length every 20 ms, edge by edge in the interrupt of TIM3.
//!
//! The handler makes the edges, so the line needs no channel of a timer. On the Octopus it is PB6, a channel of TIM4,
//! which runs the fans at a rate of its own. The timer counts from each end of its count to the next one:
//!
//! | the count ends | the handler | the next end |
//! |---|---|---|
//! | at the begin of a pulse | sets the line high | the pulse's length after that store |
//! | at the end of a pulse | sets it low | the rest of the period later |
//!
//! So a late begin makes no pulse shorter. A late end makes one longer: by the steps that are due in that instant, or
//! by a critical section, because the handler is above all others but the Stepper. `emulator/tests/servo.rs` measures
//! pulses at rest and at 40,000 step events a second with fans on: none of 600 was off by more than 3.0 us.
//!
//! The line is driven only on a machine with a BLTouch, and stays low between orders.

use core::sync::atomic::{AtomicU16, Ordering::Relaxed};

use corehbot_cortex_m4::{Handover, finish_stores};
use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::pac::{Interrupt, RCC, TIM3};

use crate::interrupt_storm::{self, CallRate};
use crate::ports;
use crate::wiring::Pin;

/// The interrupt.
pub const IRQ: Interrupt = Interrupt::TIM3;

/// Clocks of 90 MHz (APB1; RM0390, 6.2) to a count of 0.5 us.
const PRESCALER: u16 = 45 - 1;
const COUNTS_PER_US: u16 = 2;

/// From pulse to pulse: 20 ms.
const PERIOD: u16 = 20_000 * COUNTS_PER_US;

/// Pulses of an order: five are obeyed (Klipper, `bltouch.py`, `MIN_CMD_TIME`).
const PULSES: u8 = 6;

/// The order to come: the length of its pulses in us, or one of these.
static ORDER: AtomicU16 = AtomicU16::new(NONE);
const NONE: u16 = 0;
const STOP: u16 = u16::MAX;

/// Longest pulse, in us: above any order, and far from the period.
const LONGEST: u16 = 3000;

static LINE: Handover<Line> = Handover::new();

/// The line, and the order that is on it.
struct Line {
    pin: Pin,
    /// Length of a pulse, in counts.
    length: u16,
    /// Pulses that are to come.
    left: u8,
    is_high: bool,
    is_running: bool,
}

/// Makes a low output of the line.
pub fn start(pin: Pin) {
    RCC.apb1enr().modify(|w| w.set_tim3en(true));
    // It answers two cycles after its clock is on (ES0298, delay after an RCC peripheral clock enabling).
    let _ = RCC.apb1enr().read();
    TIM3.psc().write_value(PRESCALER);
    TIM3.cr1().write(|w| w.set_urs(Urs::COUNTER_ONLY));
    TIM3.dier().write(|w| w.set_uie(true));
    ports::put(pin, false);
    ports::make_output(pin);
    LINE.fill(Line { pin, length: 0, left: 0, is_high: false, is_running: false });
}

/// The line to the servo.
pub struct ServoLine {
    /// Whether the board has one.
    pub is_there: bool,
}

impl corehbot::port::Servo for ServoLine {
    fn order(&mut self, micros: Option<u16>) {
        if self.is_there {
            order(micros);
        }
    }
}

/// Orders pulses of so many us, or none.
fn order(micros: Option<u16>) {
    ORDER.store(micros.map_or(STOP, |micros| micros.clamp(1, LONGEST)), Relaxed);
    NVIC::pend(IRQ);
}

impl Line {
    /// The count has ended, or an order has come.
    fn turn(&mut self) {
        let has_ended = TIM3.sr().read().uif();
        TIM3.sr().write(|w| w.0 = 0);
        if self.is_running && !has_ended {
            // An order counts from the next period on.
            return;
        }
        if self.is_high {
            ports::put(self.pin, false);
            self.is_high = false;
            set_end(PERIOD - self.length);
            return;
        }
        match ORDER.load(Relaxed) {
            NONE => {}
            STOP => self.left = 0,
            micros => (self.length, self.left) = (micros * COUNTS_PER_US, PULSES),
        }
        ORDER.store(NONE, Relaxed);
        let Some(left) = self.left.checked_sub(1) else {
            self.is_running = false;
            TIM3.cr1().modify(|w| w.set_cen(false));
            return;
        };
        self.left = left;
        if !self.is_running {
            self.is_running = true;
            // Far away, so that the count does not end before the pulse's own end is set. The update sets the count to
            // 0, and URS keeps it from being another call.
            set_end(u16::MAX);
            TIM3.egr().write(|w| w.set_ug(true));
            TIM3.cr1().modify(|w| w.set_cen(true));
        }
        // A step in between would shorten the pulse. It waits for some ten cycles.
        let begin = cortex_m::interrupt::free(|_| {
            ports::put(self.pin, true);
            TIM3.cnt().read().cnt()
        });
        self.is_high = true;
        // The register has no preload (ARPE is 0), so the new end counts at once; the shortest pulse is longer than
        // this store takes.
        set_end(begin + self.length);
    }
}

/// The count ends after so many counts from where it began.
fn set_end(counts: u16) {
    TIM3.arr().write(|w| w.set_arr(counts - 1));
}

/// The count has ended, or an order has come.
#[interrupt]
fn TIM3() {
    static RATE: CallRate = CallRate::new();
    LINE.with(Line::turn);
    interrupt_storm::count_call(Interrupt::TIM3, &RATE);
    finish_stores();
}
