//! Clocks: 180 MHz from the crystal.

use embassy_stm32::pac::{FLASH, RCC};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, interrupt::Priority};

use crate::wiring::Crystal;

/// Clock of the timers on APB1: twice the bus's 45 MHz (RM0390, 6.2, figure of the clock tree).
pub const TIMER_HZ: u32 = 90_000_000;

/// Clock of the timers on APB2: twice the bus's 90 MHz.
pub const APB2_TIMER_HZ: u32 = 180_000_000;

/// Clock of APB1, on which USART2 is.
pub const APB1_HZ: u32 = 45_000_000;

/// Starts the clocks, embassy's time, and what keeps flash from being slow.
pub fn start(crystal: Crystal, dma_priority: Priority) {
    let (freq, mode, prediv) = match crystal {
        Crystal::Oscillator12MHz => (Hertz::mhz(12), HseMode::Oscillator, PllPreDiv::DIV6),
        Crystal::Clock8MHz => (Hertz::mhz(8), HseMode::Bypass, PllPreDiv::DIV4),
    };
    let mut config = Config::default();
    config.dma_interrupt_priority = dma_priority;
    config.rcc.hse = Some(Hse { freq, mode });
    config.rcc.pll_src = PllSource::HSE;
    // 2 MHz * 180 / 2. embassy-stm32 switches the over-drive on, which 180 MHz need.
    config.rcc.pll = Some(Pll { prediv, mul: PllMul::MUL180, divp: Some(PllPDiv::DIV2), divq: None, divr: None });
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    // The peripherals are used by their registers here.
    let _ = embassy_stm32::init(config);
    // embassy-stm32 0.6.0 writes the wait states into ACR and with that switches prefetch and both caches off, which
    // every start of a branch would pay with five cycles and more.
    FLASH.acr().modify(|w| {
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    // If the crystal stops, the processor falls back to 16 MHz and raises NMI (RM0390, 6.2.7).
    RCC.cr().modify(|w| w.set_csson(true));
}
