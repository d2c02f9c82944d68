//! The interrupts' priorities, and what a bootloader may have left behind.

use cortex_m::Peripherals;
use cortex_m::register::basepri;
use embassy_stm32::interrupt::{InterruptExt as _, Priority};
use embassy_stm32::pac::Interrupt;

use crate::{contexts, driver_uart, otg, step_timer};

/// What the lines to hosts, the drivers' UART and embassy's time share: below the Stepper, above everything else.
pub const LINK: Priority = Priority::P4;

/// How urgent each is. Only 0 escapes the critical sections of `corehbot-cortex-m4`.
const PRIORITIES: [(Interrupt, Priority); 9] = [
    (step_timer::IRQ, Priority::P0),
    (Interrupt::TIM3, LINK),
    (Interrupt::USART1, LINK),
    (Interrupt::USART2, LINK),
    (Interrupt::DMA2_STREAM5, LINK),
    (Interrupt::DMA1_STREAM5, LINK),
    (otg::IRQ, LINK),
    (driver_uart::IRQ, LINK),
    (contexts::GENERATOR_IRQ, Priority::P8),
];

/// Begins with no interrupt enabled or pending, whoever ran before.
pub fn reset(peripherals: &mut Peripherals) {
    peripherals.SYST.disable_interrupt();
    peripherals.SYST.disable_counter();
    for bank in 0..peripherals.NVIC.icer.len() {
        // SAFETY: disabling interrupts and forgetting requests breaks no critical section.
        unsafe {
            peripherals.NVIC.icer[bank].write(u32::MAX);
            peripherals.NVIC.icpr[bank].write(u32::MAX);
        }
    }
    for (irq, priority) in PRIORITIES {
        irq.set_priority(priority);
    }
    // SAFETY: no interrupt is enabled and no critical section is open, so nothing relies on a mask.
    unsafe {
        basepri::write(0);
        cortex_m::interrupt::enable();
    }
}

/// Lets the interrupts in.
pub fn enable() {
    for (irq, _) in PRIORITIES {
        // SAFETY: called once from start-up, outside of any critical section, when every handler has its handle.
        unsafe { irq.enable() };
    }
}
