//! USART2: the host. Bytes come by DMA (see [`receiver`](crate::receiver)) and go by interrupts.

use corehbot::port::{Received, Serial};
use corehbot_cortex_m4::Handover;
use embassy_stm32::interrupt;
use embassy_stm32::pac::{Interrupt, RCC, USART2};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

use crate::clocks::APB1_HZ;
use crate::contexts::wake_console;
use crate::ports;
use crate::receiver::{self, Receiver};
use crate::wiring::Board;

/// The interrupt of the line.
pub const IRQ: Interrupt = Interrupt::USART2;

/// USART1 to 3 are alternate function 7 (STM32F446 datasheet, table of alternate functions).
const FUNCTION: u8 = 7;

static SENDING: ConstStaticCell<Queue<u8, 1024>> = ConstStaticCell::new(Queue::new());
static OUTGOING: Handover<Consumer<'static, u8>> = Handover::new();

/// The Console's end of the line.
pub struct HostSerial {
    receiver: Receiver,
    sending: Producer<'static, u8>,
}

impl HostSerial {
    /// Starts the one line; interrupts are not enabled yet.
    pub fn start(board: &Board) -> Self {
        let (sending, outgoing) = SENDING.take().split();
        OUTGOING.fill(outgoing);
        RCC.apb1enr().modify(|w| w.set_usart2en(true));
        let _ = RCC.apb1enr().read();
        receiver::start();
        // Divided by 16 samples a bit, with four bits of fraction: the plain quotient (RM0390, 25.4.4).
        USART2.brr().write(|w| w.0 = (APB1_HZ + board.baud / 2) / board.baud);
        USART2.cr3().write(|w| {
            w.set_dmar(true);
            w.set_eie(true);
        });
        USART2.cr1().write(|w| {
            w.set_ue(true);
            w.set_te(true);
            w.set_re(true);
            w.set_idleie(true);
        });
        board.serial.iter().for_each(|pin| ports::make_alternate(*pin, FUNCTION));
        Self { receiver: Receiver::new(), sending }
    }
}

impl Serial for HostSerial {
    fn recv(&mut self) -> Option<Received> {
        self.receiver.recv()
    }

    fn send(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.iter().take_while(|byte| self.sending.enqueue(**byte).is_ok()).count();
        if taken > 0 {
            // The handler changes the same register.
            critical_section::with(|_| USART2.cr1().modify(|w| w.set_txeie(true)));
        }
        taken
    }
}

#[interrupt]
fn USART2() {
    let status = USART2.sr().read();
    if status.ore() || status.fe() || status.ne() || status.idle() {
        // Reading the data register after the status takes these back. The DMA has taken the byte long ago.
        let _ = USART2.dr().read();
        if status.ore() || status.fe() || status.ne() {
            receiver::mark_damage();
        }
        wake_console();
    }
    if status.txe() && USART2.cr1().read().txeie() {
        match OUTGOING.with(Consumer::dequeue) {
            Some(byte) => USART2.dr().write(|w| w.set_dr(u16::from(byte))),
            None => {
                USART2.cr1().modify(|w| w.set_txeie(false));
                // Room for whoever has more to say.
                wake_console();
            }
        }
    }
}
