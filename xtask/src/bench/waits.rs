//! Waits: cycles that the STM32F446 adds to the core's own.
//!
//! Everything here is on the safe side: the bridges have no write buffer, although they may have one, and the prefetch
//! buffer's gain is left out.

/// A flash line that is in no cache: 5 wait states at 180 MHz (RM0390 rev 6, table 5).
pub const FLASH: u64 = 5;

/// Bytes of a flash line (RM0390 rev 6, 3.4.2).
pub const LINE: u64 = 16;

/// The bus of an address.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Bus {
    /// RAM, which the core reaches at once, or flash.
    Memory,
    /// Peripherals at a quarter of the core's clock.
    Apb1,
    /// Peripherals at half of it.
    Apb2,
    /// The ports, at the core's clock.
    Ahb,
    /// The core's own registers.
    Core,
}

/// The bus of an address (RM0390 rev 6, 2.2.2).
pub const fn bus(address: u32) -> Bus {
    match address {
        0x4000_0000..0x4001_0000 => Bus::Apb1,
        0x4001_0000..0x4002_0000 => Bus::Apb2,
        0x4002_0000..0x6000_0000 => Bus::Ahb,
        0xE000_0000..=0xE00F_FFFF => Bus::Core,
        _ => Bus::Memory,
    }
}

/// Cycles that an access there takes beyond the instruction's own.
///
/// A transfer on APB takes two of the bus's clocks (ARM IHI 0024C, 3.1 and 3.3) and begins with one of them; the bridge
/// takes one of the core's. That is 4 + 8 + 1 at the worst with four of the core's clocks to one of the bus's, and
/// 2 + 4 + 1 with two. A port can change every two cycles (RM0390 rev 6, 8.2), and the core's own registers are not
/// bufferable: both take one more.
pub const fn wait(bus: Bus) -> u64 {
    match bus {
        Bus::Memory => 0,
        Bus::Apb1 => 4 + 8 + 1,
        Bus::Apb2 => 2 + 4 + 1,
        Bus::Ahb | Bus::Core => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_belong_to_buses() {
        let places = [0x2000_0000, 0x4000_0024, 0x4001_0400, 0x4002_1818, 0xE000_1004, 0x0800_8000];
        let buses = [Bus::Memory, Bus::Apb1, Bus::Apb2, Bus::Ahb, Bus::Core, Bus::Memory];
        assert_eq!(places.map(bus), buses);
        assert_eq!(buses.map(wait), [0, 13, 7, 1, 1, 0]);
    }
}
