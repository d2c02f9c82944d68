//! Clocks: 180 MHz from the crystal, and 48 MHz for USB.

use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::{FLASH, Interrupt, RCC, TIM3};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, interrupt::Priority};

use crate::wiring::Crystal;

/// Clock of APB1: a quarter of 180 MHz.
pub const APB1_HZ: u32 = 45_000_000;

/// Clock of the timers on APB1: twice the bus's 45 MHz (RM0390, 6.2, figure of the clock tree).
pub const TIMER_HZ: u32 = 90_000_000;

/// Clock of the timers on APB2: twice the bus's 90 MHz.
pub const APB2_TIMER_HZ: u32 = 180_000_000;

/// Looks at a status register, at four cycles of 180 MHz each or more, until the second PLL must run: 0.3 ms
/// (STM32F446 datasheet, PLLSAI characteristics), with a margin of ten.
const LOCKING: u32 = 135_000;

/// Takes the 48 MHz of USB from PLLSAI instead of the main PLL (RM0390, 6.3.27, CK48MSEL).
const CK48MSEL: u32 = 1 << 27;

/// Starts the clocks, embassy's time, and what keeps flash from being slow.
pub fn start(crystal: Crystal, dma_priority: Priority) {
    let (freq, mode) = match crystal {
        Crystal::Oscillator12MHz => (Hertz::mhz(12), HseMode::Oscillator),
        Crystal::Clock8MHz => (Hertz::mhz(8), HseMode::Bypass),
    };
    let prediv = to_2_mhz(crystal);
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
    // embassy's time counts half laps of TIM3 by its flags. Before the counter starts, the compare register of the half
    // lap is as 0 as the counter, which sets that flag in the emulated chip if not in the real one, and embassy-stm32
    // 0.6.0 does not take it back. With a half lap too many, a read just when a half lap ends goes back by 65 ms.
    critical_section::with(|_| {
        // The peripherals are used by their registers here.
        let _ = embassy_stm32::init(config);
        TIM3.sr().write(|_| ());
        NVIC::unpend(Interrupt::TIM3);
    });
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

/// Has embassy's time stand still during `work`, in which no interrupt is served for longer than a half lap of TIM3,
/// 33 ms. Of the half laps that end meanwhile embassy would count two at the most, and after an odd number of others a
/// read just when a half lap ends goes back by 65 ms, from then on for ever.
pub fn without_time<R>(work: impl FnOnce() -> R) -> R {
    TIM3.cr1().modify(|w| w.set_cen(false));
    let result = work();
    TIM3.cr1().modify(|w| w.set_cen(true));
    result
}

/// What makes 2 MHz of the crystal's clock, for either PLL.
const fn to_2_mhz(crystal: Crystal) -> PllPreDiv {
    match crystal {
        Crystal::Oscillator12MHz => PllPreDiv::DIV6,
        Crystal::Clock8MHz => PllPreDiv::DIV4,
    }
}

/// Starts the 48 MHz of USB: 2 MHz * 96 / 4 in PLLSAI. Says whether they run.
///
/// embassy-stm32 0.6.0 cannot: it leaves the predivider PLLSAIM, which the F446 has in a register of its own, at the
/// forbidden 0 (RM0390, 6.3.24), and writes CK48MSEL into DCKCFGR, where other chips have it.
pub fn start_usb(crystal: Crystal) -> bool {
    // A bootloader may have left it running, and then its settings are read only.
    RCC.cr().modify(|w| w.set_pllsaion(false));
    if !(0..LOCKING).any(|_| !RCC.cr().read().pllsairdy()) {
        return false;
    }
    RCC.pllsaicfgr().modify(|w| {
        w.set_pllm(to_2_mhz(crystal));
        w.set_plln(PllMul::MUL96);
        w.set_pllp(PllPDiv::DIV4);
    });
    RCC.dckcfgr2().modify(|w| w.0 |= CK48MSEL);
    RCC.cr().modify(|w| w.set_pllsaion(true));
    (0..LOCKING).any(|_| RCC.cr().read().pllsairdy())
}
