//! UART 0 with a ring in each direction.
//!
//! QEMU holds the host back while a byte lies in the receiver, so an overrun never happened in our runs; it is
//! reported all the same. End of transmission (0x04) does not reach the core: the board ends the run
//! once all motion is done, which it has the Console find out by an `M400`.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use corehbot::port::{Received, Serial, StepClock as _};
use corehbot_cortex_m4::Handover;
use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::ConstStaticCell;

use super::console_waker::wake_console;
use super::irq::Irq;
use super::registers::uart;
use super::time::StepTimer;

/// ASCII end of transmission.
const END_OF_TRANSMISSION: u8 = 0x04;

/// Waits for all motion.
const LAST_COMMAND: &[u8] = b"\nM400\n";

static RECEIVED: ConstStaticCell<Queue<Received, 1024>> = ConstStaticCell::new(Queue::new());
static SENDING: ConstStaticCell<Queue<u8, 1024>> = ConstStaticCell::new(Queue::new());

static INCOMING: Handover<Producer<'static, Received>> = Handover::new();
static OUTGOING: Handover<Consumer<'static, u8>> = Handover::new();

/// Bytes did not fit into the ring; the Console learns that after all bytes that did fit.
static IS_DROPPED: AtomicBool = AtomicBool::new(false);

/// When the last byte of the host came, in ticks since start.
static LAST_BYTE: AtomicU32 = AtomicU32::new(0);

/// The host has said that nothing will follow.
static IS_ENDED: AtomicBool = AtomicBool::new(false);

/// Whether the host has said that nothing will follow.
pub fn is_ended() -> bool {
    IS_ENDED.load(Ordering::Acquire)
}

/// Time of the host's last byte before the end of transmission, in ticks since start.
pub fn last_byte() -> u32 {
    LAST_BYTE.load(Ordering::Relaxed)
}

/// The Console's end of the line.
pub struct UartSerial {
    received: Consumer<'static, Received>,
    sending: Producer<'static, u8>,
}

impl UartSerial {
    /// The one line; its interrupts begin with [`start`].
    pub fn new() -> Self {
        let (incoming, received) = RECEIVED.take().split();
        let (sending, outgoing) = SENDING.take().split();
        INCOMING.fill(incoming);
        OUTGOING.fill(outgoing);
        Self { received, sending }
    }
}

/// Switches the line on.
pub fn start() {
    uart::BAUDDIV.write(uart::CLOCK / 250_000);
    uart::CTRL
        .write(uart::TX_ENABLE | uart::RX_ENABLE | uart::TX_INTERRUPT | uart::RX_INTERRUPT | uart::OVERRUN_INTERRUPT);
}

impl Serial for UartSerial {
    fn recv(&mut self) -> Option<Received> {
        self.received.dequeue().or_else(|| IS_DROPPED.swap(false, Ordering::AcqRel).then_some(Received::Lost))
    }

    fn send(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.iter().take_while(|byte| self.sending.enqueue(**byte).is_ok()).count();
        if taken > 0 {
            NVIC::pend(Irq::Transmitted);
            // Output has made progress, and may make more.
            wake_console();
        }
        taken
    }
}

fn take_in(received: Received) {
    if INCOMING.with(|ring| ring.enqueue(received)).is_err() {
        IS_DROPPED.store(true, Ordering::Release);
    }
}

/// Interrupt: a byte has come.
pub extern "C" fn on_received() {
    uart::INTCLEAR.write(uart::RECEIVED);
    let byte = uart::DATA.read() as u8;
    if byte == END_OF_TRANSMISSION {
        IS_ENDED.store(true, Ordering::Release);
        LAST_COMMAND.iter().for_each(|byte| take_in(Received::Byte(*byte)));
    } else {
        LAST_BYTE.store(StepTimer.now().0, Ordering::Relaxed);
        take_in(Received::Byte(byte));
    }
    wake_console();
}

/// Interrupt: the UART lost a byte.
pub extern "C" fn on_overrun() {
    uart::STATE.write(uart::RX_OVERRUN);
    take_in(Received::Lost);
    wake_console();
}

/// Interrupt: the transmitter has room, or (pended by software) there is something to send.
pub extern "C" fn on_transmitted() {
    uart::INTCLEAR.write(uart::TRANSMITTED);
    if uart::STATE.read() & uart::TX_FULL == 0
        && let Some(byte) = OUTGOING.with(Consumer::dequeue)
    {
        uart::DATA.write(u32::from(byte));
    }
}
