//! Serial ports: which USART on which pins, and how its bus clock is divided into bits.
//!
//! Nothing here needs the processor, so a board's table and the division are tested on the host.

use crate::{Pin, Port};

/// A serial port that a host may be on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SerialPort {
    /// Its USART.
    pub usart: Usart,
    /// Transmitter.
    pub tx: Pin,
    /// Receiver.
    pub rx: Pin,
    /// Bits a second, until the machine says another rate.
    pub baud: u32,
}

/// The USARTs wired for hosts. For a new one the compiler asks for its bus, its receiver's DMA and its registers
/// (`resources`, `usart`, `plain_serial`). `tests/chip.rs` asks for its interrupts (`SOURCES` in `resources`, with a
/// priority and a handler each). `LINES` in `src/port.rs` of the core limits the number that a board may have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Usart {
    /// USART1.
    One,
    /// USART2.
    Two,
}

/// The bit rate may be off by one part in this many. Receivers tolerate 3.3 % between both ends (RM0390, 25.4.5,
/// tolerance with ONEBIT = 0), and we use up a third of that.
const TOLERANCE: u32 = 100;

/// The smallest divisor with 16 samples a bit (RM0390, 25.4.4).
const LEAST: u32 = 16;

impl Usart {
    /// Every USART.
    pub fn all() -> impl Iterator<Item = Self> {
        core::iter::successors(Some(Self::One), |usart| usart.next())
    }

    /// The USART after this one. Without a wildcard: a new one is linked in here, and tests go through all of them.
    const fn next(self) -> Option<Self> {
        match self {
            Self::One => Some(Self::Two),
            Self::Two => None,
        }
    }

    /// Its name in the manual.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::One => "USART1",
            Self::Two => "USART2",
        }
    }

    /// Clock of its bus: APB2 with a half, APB1 with a quarter of 180 MHz (`clocks`).
    #[must_use]
    pub const fn bus_hz(self) -> u32 {
        match self {
            Self::One => 90_000_000,
            Self::Two => 45_000_000,
        }
    }

    /// Whether its transmitter and receiver can be on these pins, as alternate function 7 (STM32F446 datasheet, table
    /// of alternate functions).
    #[must_use]
    const fn reaches(self, tx: Pin, rx: Pin) -> bool {
        matches!(
            (self, tx.port, tx.number(), rx.port, rx.number()),
            (Self::One, Port::A, 9, Port::A, 10)
                | (Self::One, Port::B, 6, Port::B, 7)
                | (Self::Two, Port::A, 2, Port::A, 3)
                | (Self::Two, Port::D, 5, Port::D, 6)
        )
    }
}

impl SerialPort {
    /// Whether the processor's own bootloader tries it too, on any board (AN2606, STM32F446xx configuration in system
    /// memory boot mode: USART1 on these pins).
    #[must_use]
    pub const fn is_of_bootloader(&self) -> bool {
        matches!((self.tx.port, self.tx.number(), self.rx.port, self.rx.number()), (Port::A, 9, Port::A, 10))
    }

    /// The divisor of the bus clock: with 16 samples a bit and four bits of fraction it is the plain quotient (RM0390,
    /// 25.4.4).
    #[must_use]
    pub const fn divisor(&self) -> u32 {
        (self.usart.bus_hz() + self.baud / 2) / self.baud
    }

    /// The first problem of the port, if any.
    #[must_use]
    pub fn problem(&self) -> Option<&'static str> {
        if !self.usart.reaches(self.tx, self.rx) {
            return Some("a serial port is on pins that its USART does not reach");
        }
        let divisor = self.divisor();
        if !(LEAST..=u32::from(u16::MAX)).contains(&divisor) {
            return Some("a serial port is too fast or too slow for its USART");
        }
        let off = (self.usart.bus_hz() / divisor).abs_diff(self.baud);
        (off > self.baud / TOLERANCE).then_some("a serial port cannot have its rate")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::settings::ranges;

    fn port(usart: Usart, baud: u32) -> SerialPort {
        let (tx, rx) = match usart {
            Usart::One => (Pin::new(Port::A, 9), Pin::new(Port::A, 10)),
            Usart::Two => (Pin::new(Port::D, 5), Pin::new(Port::D, 6)),
        };
        SerialPort { usart, tx, rx, baud }
    }

    #[test]
    fn usual_rates_are_met_to_half_a_percent() {
        for usart in Usart::all() {
            let ends = [ranges::BAUD.least, ranges::BAUD.most];
            for baud in [115_200, 230_400, 250_000, 500_000].into_iter().chain(ends) {
                let port = port(usart, baud);
                let real = f64::from(usart.bus_hz()) / f64::from(port.divisor());
                assert!((real / f64::from(baud) - 1.0).abs() < 0.005, "{usart:?} {baud}: {real}");
                assert_eq!(port.problem(), None);
            }
        }
        assert_eq!(port(Usart::One, 1_000_000).divisor(), 90);
        assert_eq!(port(Usart::Two, 250_000).divisor(), 180);
    }

    #[test]
    fn a_rate_or_a_pin_out_of_reach_is_a_problem() {
        assert!(port(Usart::Two, 3_000_000).problem().is_some(), "less than 16 samples a bit");
        assert!(port(Usart::One, 1000).problem().is_some(), "more than 16 bits");
        assert!(port(Usart::Two, 2_550_000).problem().is_some(), "17 or 18: 3 % off");
        let crossed = SerialPort { usart: Usart::One, ..port(Usart::Two, 250_000) };
        assert!(crossed.problem().is_some());
    }
}
