//! GPIO ports: from the names in a wiring table to registers.

use embassy_stm32::pac;
use embassy_stm32::pac::gpio::regs::{Bsrr, Ospeedr};
use embassy_stm32::pac::gpio::vals::{Moder, Pupdr};

use crate::wiring::{DEBUG, Pin, Port};

/// The registers of a port.
pub type Registers = pac::gpio::Gpio;

/// How steep edges are (STM32F446 datasheet, table of I/O AC characteristics).
#[derive(Clone, Copy)]
#[repr(u32)]
pub enum Speed {
    /// 10 ns at 50 pF.
    Medium = 0b01,
    /// 4 ns at 30 pF.
    VeryHigh = 0b11,
}

/// The registers of `port`.
pub const fn registers(port: Port) -> Registers {
    match port {
        Port::A => pac::GPIOA,
        Port::B => pac::GPIOB,
        Port::C => pac::GPIOC,
        Port::D => pac::GPIOD,
        Port::E => pac::GPIOE,
        Port::F => pac::GPIOF,
        Port::G => pac::GPIOG,
    }
}

/// Clocks all ports.
pub fn switch_on() {
    pac::RCC.ahb1enr().modify(|w| {
        w.set_gpioaen(true);
        w.set_gpioben(true);
        w.set_gpiocen(true);
        w.set_gpioden(true);
        w.set_gpioeen(true);
        w.set_gpiofen(true);
        w.set_gpiogen(true);
    });
    // A port answers two cycles after its clock is on (ES0298, delay after an RCC peripheral clock enabling).
    let _ = pac::RCC.ahb1enr().read();
}

/// Gives the debug port its pins back, as they are after a reset: SWDIO with a pull-up, SWCLK with a pull-down (RM0390,
/// 7.4.1). BTT's bootloader makes an output of SWDIO while it runs; another might leave it one.
pub fn release_debug_port() {
    for (pin, pull) in [(DEBUG[0], Pupdr::PULL_UP), (DEBUG[1], Pupdr::PULL_DOWN)] {
        make_alternate(pin, 0);
        registers(pin.port).pupdr().modify(|w| w.set_pupdr(pin.number(), pull));
    }
}

/// Sets the pins in the lower half of `word` high and those in the upper half low, in one store.
#[inline(always)]
pub fn store(port: Registers, word: u32) {
    port.bsrr().write_value(Bsrr(word));
}

/// Makes an output of `pin`; its level was chosen before.
pub fn make_output(pin: Pin) {
    registers(pin.port).moder().modify(|w| w.set_moder(pin.number(), Moder::OUTPUT));
}

/// Gives an output edges that a short pulse survives.
pub fn speed_up(pin: Pin, speed: Speed) {
    let shift = 2 * pin.number();
    registers(pin.port).ospeedr().modify(|w| *w = Ospeedr(w.0 & !(0b11 << shift) | (speed as u32) << shift));
}

/// Makes an input of `pin`, pulled to the level `is_high`.
pub fn make_input(pin: Pin, is_high: bool) {
    let port = registers(pin.port);
    port.pupdr().modify(|w| w.set_pupdr(pin.number(), if is_high { Pupdr::PULL_UP } else { Pupdr::PULL_DOWN }));
    port.moder().modify(|w| w.set_moder(pin.number(), Moder::INPUT));
}

/// Lets go of a pin, which becomes an input with the pull that was chosen before. Anything that interrupts this may
/// store to outputs, but not change modes.
#[inline]
pub fn let_go(pin: Pin) {
    registers(pin.port).moder().modify(|w| w.set_moder(pin.number(), Moder::INPUT));
}

/// Hands `pin` to a converter.
pub fn make_analog(pin: Pin) {
    float(pin);
    registers(pin.port).moder().modify(|w| w.set_moder(pin.number(), Moder::ANALOG));
}

/// Makes an input without a pull resistor.
pub fn float(pin: Pin) {
    registers(pin.port).pupdr().modify(|w| w.set_pupdr(pin.number(), Pupdr::FLOATING));
}

/// Connects `pin` to a peripheral, with a pull-up.
pub fn make_alternate(pin: Pin, function: u8) {
    let port = registers(pin.port);
    port.afr(pin.number() / 8).modify(|w| w.set_afr(pin.number() % 8, function));
    port.pupdr().modify(|w| w.set_pupdr(pin.number(), Pupdr::PULL_UP));
    port.moder().modify(|w| w.set_moder(pin.number(), Moder::ALTERNATE));
}

/// Lets a peripheral drive `pin`; until it does, the resistors of board and chip pull the pin low.
pub fn drive_by(pin: Pin, function: u8) {
    let port = registers(pin.port);
    port.afr(pin.number() / 8).modify(|w| w.set_afr(pin.number() % 8, function));
    port.pupdr().modify(|w| w.set_pupdr(pin.number(), Pupdr::PULL_DOWN));
    port.moder().modify(|w| w.set_moder(pin.number(), Moder::ALTERNATE));
}

/// Chooses the level of an output.
pub fn put(pin: Pin, is_high: bool) {
    store(registers(pin.port), if is_high { pin.mask() } else { pin.mask() << 16 });
}

/// Whether `pin` is high.
pub fn is_high(pin: Pin) -> bool {
    registers(pin.port).idr().read().0 & pin.mask() != 0
}
