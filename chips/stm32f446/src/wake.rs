//! The interrupts that software pends.

use corehbot::port::Wake;
use cortex_m::peripheral::{NVIC, SCB};
use embassy_stm32::pac::Interrupt;

/// An interrupt that runs the StepGenerator: its device, the second CAN controller, is never switched on.
pub const GENERATOR_IRQ: Interrupt = Interrupt::CAN2_SCE;

/// SimWake the interrupts of the contexts.
#[derive(Clone, Copy)]
pub struct IrqWake;

impl Wake for IrqWake {
    #[inline]
    fn wake_generator(&self) {
        NVIC::pend(GENERATOR_IRQ);
    }

    #[inline]
    fn wake_stepper(&self) {
        SCB::set_pendst();
    }
}
