//! Serial lines without clocks: a last message to hosts when there is no crystal or PLL to run from.
//!
//! It needs only the internal oscillator: no interrupt, no DMA, no time. The oscillator is within 1 % at room
//! temperature and 4 % up to 85 C (STM32F446 datasheet, HSI oscillator). Receivers tolerate 3.3 % (RM0390, 25.4.5).

use cortex_m::asm::delay;
use embassy_stm32::pac::usart::Usart as Registers;
use embassy_stm32::pac::{RCC, USART1, USART2};

use crate::after_bootloader::HSI_HZ;
use crate::resources::USART_FUNCTION;
use crate::wiring::{SerialPort, Usart};
use crate::{ports, watchdog};

/// Between two messages: 40 times 50 ms, and longer where flash is waited for.
const PAUSES: u32 = 40;
const PAUSE: u32 = HSI_HZ / 20;

/// Polls of the transmitter until a byte must have gone, at four cycles of 16 MHz each or more: ten bits of 9600 baud.
const SENDING: u32 = 4200;

/// Sends the message to hosts for ever. Nothing else runs.
pub fn tell(ports: impl Iterator<Item = &'static SerialPort> + Clone, parts: &[&str]) -> ! {
    ports.clone().for_each(start);
    loop {
        for byte in parts.iter().flat_map(|part| part.bytes()) {
            ports.clone().for_each(|port| send(registers(port), byte));
        }
        for _ in 0..PAUSES {
            watchdog::feed();
            delay(PAUSE);
        }
    }
}

const fn registers(port: &SerialPort) -> Registers {
    match port.usart {
        Usart::One => USART1,
        Usart::Two => USART2,
    }
}

/// Makes a transmitter of the port.
fn start(port: &SerialPort) {
    match port.usart {
        Usart::One => RCC.apb2enr().modify(|w| w.set_usart1en(true)),
        Usart::Two => RCC.apb1enr().modify(|w| w.set_usart2en(true)),
    }
    // It answers two cycles after its clock is on (ES0298, delay after an RCC peripheral clock enabling).
    let _ = RCC.ahb1enr().read();
    let registers = registers(port);
    // Both buses run at the oscillator's rate, and the quotient is the divisor (RM0390, 25.4.4).
    registers.brr().write(|w| w.0 = (HSI_HZ + port.baud / 2) / port.baud);
    registers.cr1().write(|w| {
        w.set_ue(true);
        w.set_te(true);
    });
    ports::make_alternate(port.tx, USART_FUNCTION);
}

fn send(registers: Registers, byte: u8) {
    // A transmitter that does not come round is not waited for.
    let _ = (0..SENDING).any(|_| registers.sr().read().txe());
    registers.dr().write(|w| w.set_dr(byte.into()));
}
