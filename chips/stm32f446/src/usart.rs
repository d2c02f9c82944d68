//! USARTs: bytes come by DMA (see [`receiver`](crate::receiver)) and go by interrupts.
//! [`receiver_flags`](corehbot_board_support::receiver_flags) handles an idle line and damaged bytes.
//!
//! USART1 and USART2 run the same code. Each may have a host, at the same time.

use core::ops::Range;
use corehbot::port::{Received, Serial};
use corehbot_cortex_m4::{Handover, finish_stores};
use embassy_stm32::interrupt;
use embassy_stm32::pac::dma::Dma;
use embassy_stm32::pac::usart::Usart as Registers;
use embassy_stm32::pac::usart::regs::Sr;
use embassy_stm32::pac::{DMA1, DMA2, Interrupt, RCC, USART1, USART2};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

use crate::console_waker::wake_console;
use crate::interrupt_storm::{CallRate, count_call};
use crate::ports;
use crate::receiver::Receiver;
use crate::resources::{self, USART_FUNCTION};
use crate::wiring::{SerialPort, Usart};
use corehbot_board_support::receiver_flags::{self, Flags, News, Receiving};
use corehbot_board_support::ring::Ring;

/// Bytes that wait for the transmitter, behind those of the Console: 20 ms at 250,000 baud. The Console is polled in
/// each millisecond.
const WAITING: usize = 512;

static ONE: Station = Station { registers: USART1, usart: Usart::One, dma: DMA2, queues: &QUEUES[0] };
static TWO: Station = Station { registers: USART2, usart: Usart::Two, dma: DMA1, queues: &QUEUES[1] };
const _: () =
    assert!(resources::receiver(Usart::One).controller == 2 && resources::receiver(Usart::Two).controller == 1);

static QUEUES: [Queues; 2] = [Queues::new(), Queues::new()];

/// A USART and its data.
struct Station {
    registers: Registers,
    usart: Usart,
    dma: Dma,
    queues: &'static Queues,
}

/// The bytes that pass through a USART. Empty they are all zeros, so they cost no flash.
struct Queues {
    ring: Ring,
    sending: ConstStaticCell<Queue<u8, WAITING>>,
    outgoing: Handover<Consumer<'static, u8>>,
}

impl Queues {
    const fn new() -> Self {
        Self { ring: Ring::new(), sending: ConstStaticCell::new(Queue::new()), outgoing: Handover::new() }
    }
}

/// Where the DMA writes.
pub fn buffers() -> [Range<u32>; 2] {
    QUEUES.each_ref().map(|queues| {
        let begin = queues.ring.bytes.as_ptr() as u32;
        begin..begin + size_of_val(&queues.ring.bytes) as u32
    })
}

/// The Console's end of the line.
pub struct UsartLine {
    receiver: Receiver,
    sending: Producer<'static, u8>,
    registers: Registers,
}

impl UsartLine {
    /// Starts the line; interrupts are not enabled yet.
    ///
    /// # Panics
    /// If its USART was started before.
    pub fn start(port: &SerialPort) -> Self {
        let station = switch_on(port.usart);
        let (sending, outgoing) = station.queues.sending.take().split();
        station.queues.outgoing.fill(outgoing);
        let registers = station.registers;
        let receiver = station.receiver();
        receiver.start(registers);
        registers.brr().write(|w| w.0 = port.divisor());
        registers.cr3().write(|w| {
            w.set_dmar(true);
            w.set_eie(true);
        });
        registers.cr1().write(|w| {
            w.set_ue(true);
            w.set_te(true);
            w.set_re(true);
            w.set_idleie(true);
        });
        ports::make_alternate(port.tx, USART_FUNCTION);
        ports::make_alternate(port.rx, USART_FUNCTION);
        Self { receiver, sending, registers }
    }
}

/// Clocks a USART and the DMA controller of its receiver.
fn switch_on(usart: Usart) -> &'static Station {
    let station = match usart {
        Usart::One => {
            RCC.apb2enr().modify(|w| w.set_usart1en(true));
            RCC.ahb1enr().modify(|w| w.set_dma2en(true));
            &ONE
        }
        Usart::Two => {
            RCC.apb1enr().modify(|w| w.set_usart2en(true));
            RCC.ahb1enr().modify(|w| w.set_dma1en(true));
            &TWO
        }
    };
    // They answer two cycles after their clock is on (ES0298, delay after an RCC peripheral clock enabling).
    let _ = RCC.ahb1enr().read();
    station
}

impl Serial for UsartLine {
    fn recv(&mut self) -> Option<Received> {
        let received = self.receiver.recv();
        if received.is_none() {
            // The handler changes the same registers.
            critical_section::with(|_| {
                let look = |receiving: &mut ReceivingUsart| flags(receiving.0.sr().read());
                if receiver_flags::watch_again(&mut ReceivingUsart(self.registers), look) == News::Damage {
                    self.receiver.mark_damage();
                }
            });
        }
        received
    }

    fn overhear(&mut self) -> Option<Received> {
        self.receiver.overhear()
    }

    fn was_overheard(&self) -> bool {
        self.receiver.was_overheard()
    }

    fn send(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.iter().take_while(|byte| self.sending.enqueue(**byte).is_ok()).count();
        if taken > 0 {
            // The handler changes the same register.
            critical_section::with(|_| self.registers.cr1().modify(|w| w.set_txeie(true)));
        }
        taken
    }
}

/// The receiver's flags in a USART's status.
fn flags(status: Sr) -> Flags {
    Flags { is_at_rest: status.idle(), is_damaged: status.ore() || status.fe() || status.ne() }
}

/// The registers, as `receiver_flags` uses them.
struct ReceivingUsart(Registers);

impl Receiving for ReceivingUsart {
    fn discard(&mut self) {
        let _ = self.0.dr().read();
    }

    fn is_watching(&mut self) -> bool {
        self.0.cr1().read().idleie()
    }

    fn watch(&mut self, rest: bool) {
        self.0.cr1().modify(|w| w.set_idleie(rest));
    }
}

impl Station {
    const fn receiver(&self) -> Receiver {
        Receiver::new(self.dma, resources::receiver(self.usart), &self.queues.ring)
    }

    /// The line rests, a byte was damaged, or the transmitter has room.
    fn on_interrupt(&self) {
        let status = self.registers.sr().read();
        match receiver_flags::answer(flags(status), &mut ReceivingUsart(self.registers)) {
            News::None => {}
            News::Rest => wake_console(),
            News::Damage => {
                self.receiver().mark_damage();
                wake_console();
            }
        }
        if status.txe() && self.registers.cr1().read().txeie() {
            match self.queues.outgoing.with(Consumer::dequeue) {
                Some(byte) => self.registers.dr().write(|w| w.set_dr(u16::from(byte))),
                None => {
                    self.registers.cr1().modify(|w| w.set_txeie(false));
                    // Room for more output.
                    wake_console();
                }
            }
        }
    }
}

#[interrupt]
fn USART1() {
    static RATE: CallRate = CallRate::new();
    count_call(Interrupt::USART1, &RATE);
    ONE.on_interrupt();
    finish_stores();
}

#[interrupt]
fn USART2() {
    static RATE: CallRate = CallRate::new();
    count_call(Interrupt::USART2, &RATE);
    TWO.on_interrupt();
    finish_stores();
}

#[interrupt]
fn DMA2_STREAM5() {
    static RATE: CallRate = CallRate::new();
    count_call(Interrupt::DMA2_STREAM5, &RATE);
    ONE.receiver().on_interrupt();
    finish_stores();
}

#[interrupt]
fn DMA1_STREAM5() {
    static RATE: CallRate = CallRate::new();
    count_call(Interrupt::DMA1_STREAM5, &RATE);
    TWO.receiver().on_interrupt();
    finish_stores();
}
