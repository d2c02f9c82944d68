//! USARTs: bytes come by DMA (see [`receiver`](crate::receiver)) and go by interrupts.
//!
//! One code serves both. A host may be on each, at the same time.

use corehbot::port::{Received, Serial};
use corehbot_cortex_m4::Handover;
use embassy_stm32::interrupt;
use embassy_stm32::pac::usart::Usart as Registers;
use embassy_stm32::pac::{DMA1, DMA2, RCC, USART1, USART2};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

use crate::contexts::wake_console;
use crate::ports;
use crate::receiver::{Receiver, Ring, Stream};
use crate::serial_port::{SerialPort, Usart};

/// USART1 to 3 are alternate function 7 (STM32F446 datasheet, table of alternate functions).
const FUNCTION: u8 = 7;

/// Bytes that wait for the transmitter: a report of the settings (M503).
const WAITING: usize = 1024;

/// DMA2 stream 5 and not 2, which TIM8 and the second ADC may want; nothing here uses TIM1 or SPI1, the others on
/// stream 5 (RM0390, table of DMA2 requests).
static ONE: Station = Station { registers: USART1, stream: Stream::new(DMA2, 5), queues: &QUEUES[0] };

/// The only stream of USART2's receiver (RM0390, table of DMA1 requests).
static TWO: Station = Station { registers: USART2, stream: Stream::new(DMA1, 5), queues: &QUEUES[1] };

static QUEUES: [Queues; 2] = [Queues::new(), Queues::new()];

/// A USART and what passes through it.
struct Station {
    registers: Registers,
    stream: Stream,
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
        ports::make_alternate(port.tx, FUNCTION);
        ports::make_alternate(port.rx, FUNCTION);
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
        self.receiver.recv()
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

impl Station {
    const fn receiver(&self) -> Receiver {
        Receiver::new(self.stream, &self.queues.ring)
    }

    /// The line rests, a byte was damaged, or the transmitter has room.
    fn on_interrupt(&self) {
        let status = self.registers.sr().read();
        let is_damaged = status.ore() || status.fe() || status.ne();
        if is_damaged || status.idle() {
            // Reading the data register after the status takes these back. The DMA has taken the byte long ago.
            let _ = self.registers.dr().read();
            if is_damaged {
                self.receiver().mark_damage();
            }
            wake_console();
        }
        if status.txe() && self.registers.cr1().read().txeie() {
            match self.queues.outgoing.with(Consumer::dequeue) {
                Some(byte) => self.registers.dr().write(|w| w.set_dr(u16::from(byte))),
                None => {
                    self.registers.cr1().modify(|w| w.set_txeie(false));
                    // Room for whoever has more to say.
                    wake_console();
                }
            }
        }
    }
}

#[interrupt]
fn USART1() {
    ONE.on_interrupt();
}

#[interrupt]
fn USART2() {
    TWO.on_interrupt();
}

#[interrupt]
fn DMA2_STREAM5() {
    ONE.receiver().on_interrupt();
}

#[interrupt]
fn DMA1_STREAM5() {
    TWO.receiver().on_interrupt();
}
