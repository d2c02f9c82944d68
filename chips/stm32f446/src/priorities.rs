//! The interrupt priorities, and clean-up of state that a bootloader may have left.

use cortex_m::Peripherals;
use cortex_m::peripheral::SCB;
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::register::basepri;
use embassy_stm32::interrupt::{InterruptExt as _, Priority};
use embassy_stm32::pac::Interrupt;

use crate::resources::SOURCES;
use crate::{driver_uart, heater_timer, otg, servo, supply, tachometers, time, wake};

/// Priority shared by the host lines, the drivers' UART, tachometers, the accelerometer and the time: below the
/// Stepper and a servo's edges, above everything else.
pub const LINK: Priority = Priority::P4;

/// The step timer's exception, which is always enabled.
const STEPS: (SystemHandler, u8) = (SystemHandler::SysTick, 0);

/// How urgent the others are. Only 0 escapes the critical sections of `corehbot-cortex-m4`.
const PRIORITIES: [(Interrupt, Priority); SOURCES.len()] = [
    // It never returns, so it delays no step.
    (supply::IRQ, Priority::P0),
    // The edges of its pulses may wait for a step, and for nothing else.
    (servo::IRQ, Priority::P2),
    (time::IRQ, LINK),
    (Interrupt::USART1, LINK),
    (Interrupt::USART2, LINK),
    (Interrupt::DMA2_STREAM5, LINK),
    (Interrupt::DMA1_STREAM5, LINK),
    (otg::IRQ, LINK),
    (driver_uart::IRQ, LINK),
    (tachometers::IRQ, LINK),
    (Interrupt::TIM6_DAC, LINK),
    (Interrupt::DMA1_STREAM0, LINK),
    (wake::GENERATOR_IRQ, Priority::P8),
    (heater_timer::IRQ, Priority::P12),
];

/// AIRCR with its key and groups of priorities that take all bits, as after a reset (ARM DDI 0403E, B3.2.6).
const ALL_BITS_COUNT: u32 = 0x05FA_0000;

/// The first instructions, before any memory is initialised. They close the interrupt masks that a reset leaves open;
/// otherwise interrupts of a bootloader would meet handlers without data. CONTROL gets its reset value, too: the main
/// stack, which is empty here, and no numbers in the floating-point unit (ARM DDI 0403E, B1.4.4).
// SAFETY: cortex-m-rt wants the function under this name and calls it once before `main`. Only the return address is in
// registers or on the stack across the call.
#[unsafe(no_mangle)]
#[unsafe(naked)]
pub unsafe extern "C" fn __pre_init() {
    core::arch::naked_asm!("cpsid i", "movs r0, #0", "msr CONTROL, r0", "isb", "bx lr")
}

/// The priorities are the table's, in its order.
const _: () = {
    let mut place = 0;
    while place < SOURCES.len() {
        assert!(PRIORITIES[place].0 as u16 == SOURCES[place].number);
        place += 1;
    }
};

/// Starts with no interrupt enabled or pending, whatever ran before, and unmasks interrupts. Their sources are off.
pub fn reset(peripherals: &mut Peripherals) {
    peripherals.SYST.disable_interrupt();
    peripherals.SYST.disable_counter();
    SCB::clear_pendst();
    SCB::clear_pendsv();
    for bank in 0..peripherals.NVIC.icer.len() {
        // SAFETY: disabling interrupts and forgetting requests breaks no critical section.
        unsafe {
            peripherals.NVIC.icer[bank].write(u32::MAX);
            peripherals.NVIC.icpr[bank].write(u32::MAX);
        }
    }
    // SAFETY: no interrupt is enabled, so no active priority can change.
    unsafe { peripherals.SCB.aircr.write(ALL_BITS_COUNT) };
    peripherals.SCB.clear_sleepdeep();
    for (irq, priority) in PRIORITIES {
        irq.set_priority(priority);
    }
    // SAFETY: no interrupt is enabled and no critical section is open, so nothing relies on a mask or a priority.
    unsafe {
        peripherals.SCB.set_priority(STEPS.0, STEPS.1);
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
