//! The interrupts in use, and their priorities.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::peripheral::{NVIC, SCB};

/// An interrupt. Lines 16 to 31 are single GPIO pins, which nothing drives here (ARM DAI 0386C,
/// interrupt map), so two of them serve software.
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Irq {
    /// A byte has come.
    Received = 0,
    /// The transmitter has room.
    Transmitted = 1,
    /// The alarm of the steps.
    StepTimer = 8,
    /// A byte was lost.
    Overrun = 12,
    /// A control period of the heaters.
    Thermal = 29,
    /// Runs the Console.
    Console = 30,
    /// Runs the StepGenerator.
    Generator = 31,
}

// SAFETY: the numbers are below 32, which is the number of external interrupts of the an386.
unsafe impl InterruptNumber for Irq {
    fn number(self) -> u16 {
        self as u16
    }
}

/// How urgent each is: less is more, and the STM32's four bits are enough. Only 0 escapes the critical
/// sections of `corehbot-cortex-m4`.
const PRIORITIES: [(Irq, u8); 7] = [
    (Irq::StepTimer, 0x00),
    (Irq::Received, LINK_PRIORITY),
    (Irq::Transmitted, LINK_PRIORITY),
    (Irq::Overrun, LINK_PRIORITY),
    (Irq::Generator, 0x80),
    (Irq::Thermal, 0xA0),
    (Irq::Console, 0xC0),
];

/// Handlers that share the rings of the serial line have one priority, so they never interrupt each other.
const LINK_PRIORITY: u8 = 0x40;

/// Sets all priorities.
pub fn prioritise(nvic: &mut NVIC, scb: &mut SCB) {
    for (irq, priority) in PRIORITIES {
        // SAFETY: no interrupt is enabled yet, so no critical section relies on another priority.
        unsafe { nvic.set_priority(irq, priority) };
    }
    // SAFETY: as above.
    unsafe { scb.set_priority(SystemHandler::SysTick, LINK_PRIORITY) };
}

/// Enables all interrupts except the Console's, which its executor enables.
pub fn enable() {
    for irq in [Irq::StepTimer, Irq::Received, Irq::Transmitted, Irq::Overrun, Irq::Generator, Irq::Thermal] {
        // SAFETY: called once from start-up, outside of any critical section.
        unsafe { NVIC::unmask(irq) };
    }
}
