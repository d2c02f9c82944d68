//! Device registers: the one place that turns addresses into loads and stores.
//!
//! Sources: ARM DAI 0386C (addresses), ARM DDI 0479D (APB timer and UART). QEMU's version of these is in its
//! hw/timer/cmsdk-apb-timer.c, hw/char/cmsdk-apb-uart.c and hw/misc/mps2-fpgaio.c.

use core::ptr::{read_volatile, write_volatile};

/// A 32-bit device register.
pub struct Register(usize);

impl Register {
    /// Reads the register.
    #[inline(always)]
    pub fn read(&self) -> u32 {
        // SAFETY: only the constants below have this type; each is the aligned address of a device
        // register of this board, outside of any Rust object.
        unsafe { read_volatile(self.0 as *const u32) }
    }

    /// Writes the register.
    #[inline(always)]
    pub fn write(&self, value: u32) {
        // SAFETY: as for `read`; none of these devices touches memory.
        unsafe { write_volatile(self.0 as *mut u32, value) }
    }
}

/// The FPGA's free-running counter at 25 MHz.
pub const COUNTER: Register = Register(0x4002_8018);

/// APB timer 0: the alarm of the steps.
pub mod step_timer {
    use super::Register;

    /// Runs the timer and lets it interrupt.
    pub const CTRL: Register = Register(0x4000_0000);
    /// Counts down at 25 MHz and interrupts at 0; without a reload value it stays there.
    pub const VALUE: Register = Register(0x4000_0004);
    /// Write 1 to take the interrupt back.
    pub const INTCLEAR: Register = Register(0x4000_000C);

    /// CTRL: the timer runs and interrupts.
    pub const RUN: u32 = 0b1001;
}

/// UART 0: the host.
pub mod uart {
    use super::Register;

    /// The byte received, or the byte to be sent.
    pub const DATA: Register = Register(0x4000_4000);
    /// Full buffers, and overruns, which are cleared by writing 1.
    pub const STATE: Register = Register(0x4000_4004);
    /// Which parts are enabled.
    pub const CTRL: Register = Register(0x4000_4008);
    /// Write 1 to take an interrupt back.
    pub const INTCLEAR: Register = Register(0x4000_400C);
    /// [`CLOCK`] divided by the baud rate, which QEMU ignores.
    pub const BAUDDIV: Register = Register(0x4000_4010);

    /// Rate of the UART's clock in Hz.
    pub const CLOCK: u32 = 25_000_000;

    /// STATE: the transmitter is full.
    pub const TX_FULL: u32 = 1 << 0;
    /// STATE: a byte was lost.
    pub const RX_OVERRUN: u32 = 1 << 3;

    /// CTRL: transmitter.
    pub const TX_ENABLE: u32 = 1 << 0;
    /// CTRL: receiver.
    pub const RX_ENABLE: u32 = 1 << 1;
    /// CTRL: interrupt when the transmitter has room.
    pub const TX_INTERRUPT: u32 = 1 << 2;
    /// CTRL: interrupt when a byte has come.
    pub const RX_INTERRUPT: u32 = 1 << 3;
    /// CTRL: interrupt when a byte was lost.
    pub const OVERRUN_INTERRUPT: u32 = 1 << 5;

    /// INTCLEAR: the transmitter has room.
    pub const TRANSMITTED: u32 = 1 << 0;
    /// INTCLEAR: a byte has come.
    pub const RECEIVED: u32 = 1 << 1;
}
