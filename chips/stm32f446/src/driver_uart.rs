//! The UART of the motor drivers: one wire a driver, one exchange at a time, bit by bit in the interrupt of TIM8.
//!
//! [`exchange`](corehbot_board_support::exchange) decides the wire's next action; this file carries it out. The wire
//! has a pull-up in the processor and is released. Only from one bit before a request to the request's end is it driven
//! both ways. The driver answers after eight bit times and releases the wire by itself.
//!
//! The interrupt has the priority of the serial line, so steps delay it, and it delays no step. The timer runs on by
//! itself, so ticks may be late but are never lost. Ticks are lost only if they are held off for 10 us while waiting
//! for a start bit, or otherwise for a bit. The current exchange then fails, as if by noise, and is repeated.
//!
//! A tick takes some 50 instructions, so waiting for a reply takes about 5 % of the processor, and bits, sent or
//! received, 1 %. While motors have power the wire has little rest: ticks come 25,000 times a second then.

use corehbot::port::{BusError, Frame};
use corehbot_cortex_m4::{Handover, finish_stores};
use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::pac::{Interrupt, RCC, TIM8};

use crate::clocks::APB2_TIMER_HZ;
use crate::console_waker::wake_console;
use crate::interrupt_storm::{CallRate, count_call};
use crate::ports::{self, Registers};
use crate::wiring::{Board, Pin};
use corehbot_board_support::exchange::{Action, BAUD, Exchange, OVERSAMPLING};

/// The interrupt of the ticks.
pub const IRQ: Interrupt = Interrupt::TIM8_UP_TIM13;

/// Timer clocks in a bit, and in a tick while listening: both divide without a remainder.
const BIT: u32 = APB2_TIMER_HZ / BAUD;
const SAMPLE: u32 = BIT / OVERSAMPLING as u32;
const _: () = assert!(SAMPLE * OVERSAMPLING as u32 * BAUD == APB2_TIMER_HZ && BIT <= 1 << 16);

static ENGINE: Handover<Engine> = Handover::new();

/// The exchange and the wire that it is on.
struct Engine {
    exchange: Exchange,
    wire: Option<Wire>,
}

/// A wire and its port.
#[derive(Clone, Copy)]
struct Wire {
    pin: Pin,
    port: Registers,
}

/// The Console's end.
pub struct DriverUart(());

impl DriverUart {
    /// Sets pull-ups on the wires of `board`, and prepares the timer. Interrupts are not enabled yet.
    pub fn start(board: &Board) -> Self {
        RCC.apb2enr().modify(|w| w.set_tim8en(true));
        let _ = RCC.apb2enr().read();
        TIM8.psc().write_value(0);
        // Only the counter's own end is an update that counts, not a restart by software.
        TIM8.cr1().write(|w| w.set_urs(Urs::COUNTER_ONLY));
        TIM8.dier().write(|w| w.set_uie(true));
        for pin in board.sockets.iter().filter_map(|slot| slot.uart) {
            ports::make_input(pin, true);
        }
        ENGINE.fill(Engine { exchange: Exchange::new(), wire: None });
        Self(())
    }

    /// Begins an exchange on `wire`, and gives up the current one.
    pub fn begin(&mut self, wire: Option<Pin>, request: &Frame, reply: usize) {
        critical_section::with(|_| {
            ENGINE.with(|engine| {
                engine.let_go();
                // A tick of the exchange before may be pending, and would be the first of this one.
                NVIC::unpend(IRQ);
                engine.wire = wire.map(|pin| Wire { pin, port: ports::registers(pin.port) });
                engine.exchange.begin(request, reply);
                match wire {
                    Some(_) => tick_every(BIT),
                    None => engine.exchange.fail(),
                }
            });
        });
    }

    /// How the exchange ended, said once.
    pub fn outcome(&mut self) -> Option<Result<Frame, BusError>> {
        critical_section::with(|_| ENGINE.with(|engine| engine.exchange.outcome()))
    }
}

impl Engine {
    #[inline]
    fn tick(&mut self) {
        let Some(Wire { pin, port }) = self.wire else { return stop() };
        let high = pin.mask();
        match self.exchange.tick(port.idr().read().0 & high != 0) {
            Action::Stay => {}
            Action::Drive { is_high } => ports::store(port, if is_high { high } else { high << 16 }),
            Action::Take => {
                // The level first, so that the line does not fall for a moment.
                ports::store(port, high);
                ports::make_output(pin);
            }
            Action::Listen => {
                ports::let_go(pin);
                tick_every(SAMPLE);
            }
            Action::Sample(samples) => next_tick_after(SAMPLE * u32::from(samples)),
            Action::End => {
                self.let_go();
                wake_console();
            }
        }
    }

    /// Ends ticks, and whatever is driven.
    fn let_go(&mut self) {
        stop();
        if let Some(wire) = self.wire.take() {
            ports::let_go(wire.pin);
        }
    }
}

/// Restarts the timer with an update every `clocks`.
fn tick_every(clocks: u32) {
    TIM8.arr().write(|w| w.set_arr((clocks - 1) as u16));
    TIM8.egr().write(|w| w.set_ug(true));
    TIM8.sr().write(|_| ());
    TIM8.cr1().modify(|w| w.set_cen(true));
}

/// The next tick comes `clocks` after the previous one, and so do the ticks after it. The timer is not restarted, so a
/// late call does not matter. If the tick is overdue already, it is raised at once, because a counter past its end
/// would run on to 2^16.
fn next_tick_after(clocks: u32) {
    TIM8.arr().write(|w| w.set_arr((clocks - 1) as u16));
    if u32::from(TIM8.cnt().read().cnt()) >= clocks {
        tick_every(clocks);
        NVIC::pend(IRQ);
    }
}

fn stop() {
    TIM8.cr1().modify(|w| w.set_cen(false));
    TIM8.sr().write(|_| ());
}

/// A bit or a sample is due.
#[interrupt]
fn TIM8_UP_TIM13() {
    static RATE: CallRate = CallRate::new();
    count_call(IRQ, &RATE);
    // Flags are cleared by writing 0, and only the update is in use.
    TIM8.sr().write(|_| ());
    ENGINE.with(Engine::tick);
    finish_stores();
}
