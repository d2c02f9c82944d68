//! Clocks: 180 MHz from the crystal, and 48 MHz for USB.

use cortex_m::peripheral::NVIC;
use embassy_stm32::pac::{FLASH, Interrupt, PWR, RCC, TIM2};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, LsConfig, Pll, PllMul, PllPDiv, PllPreDiv, PllQDiv, PllRDiv, PllSource,
    Sysclk,
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, interrupt::Priority};

use crate::after_bootloader::comes;
use crate::wiring::Crystal;

/// Clock of the core.
pub const CORE_HZ: u32 = 180_000_000;

/// Clock of APB1: a quarter of 180 MHz.
pub const APB1_HZ: u32 = 45_000_000;

/// Clock of the timers on APB2: twice the bus's 90 MHz (RM0390, 6.2, figure of the clock tree).
pub const APB2_TIMER_HZ: u32 = 180_000_000;

/// The system clock is 2 MHz * 180 / 2.
const MUL: PllMul = PllMul::MUL180;
const DIVP: PllPDiv = PllPDiv::DIV2;

/// The two other outputs of the PLL are not used, but their divisors must be 2 or more (RM0390, 6.3.2): 45 and 180 MHz.
const DIVQ: PllQDiv = PllQDiv::DIV8;
const DIVR: PllRDiv = PllRDiv::DIV2;

/// Takes the 48 MHz of USB from PLLSAI instead of the main PLL (RM0390, 6.3.27, CK48MSEL).
const CK48MSEL: u32 = 1 << 27;

/// Starts crystal, over-drive and PLL once, one after the other, and returns the one that does not start. embassy-stm32
/// 0.6.0 waits for each of them without an end. The internal oscillator is the system clock, before and after.
pub fn try_out(crystal: Crystal) -> Result<(), &'static str> {
    // Before the oscillator is on: afterwards the bit cannot be written (RM0390, 6.3.1, HSEBYP).
    RCC.cr().modify(|w| w.set_hsebyp(crystal == Crystal::Clock8MHz));
    RCC.cr().modify(|w| w.set_hseon(true));
    if !comes(|| RCC.cr().read().hserdy()) {
        return Err(match crystal {
            Crystal::Oscillator12MHz => "the crystal of 12 MHz does not start",
            Crystal::Clock8MHz => "the ST-LINK gives no clock of 8 MHz",
        });
    }
    RCC.apb1enr().modify(|w| w.set_pwren(true));
    // It answers two cycles after its clock is on (ES0298, delay after an RCC peripheral clock enabling).
    let _ = RCC.apb1enr().read();
    // As embassy-stm32 does it later: in this order, on an oscillator and with the PLL off (RM0390, 5.1.4).
    PWR.cr1().modify(|w| w.set_oden(true));
    if !comes(|| PWR.csr1().read().odrdy()) {
        return Err("the supply of the processor has no over-drive");
    }
    PWR.cr1().modify(|w| w.set_odswen(true));
    if !comes(|| PWR.csr1().read().odswrdy()) {
        return Err("the processor does not switch to over-drive");
    }
    PWR.cr1().modify(|w| {
        w.set_oden(false);
        w.set_odswen(false);
    });
    if !comes(|| !PWR.csr1().read().odswrdy()) {
        return Err("the processor does not leave over-drive");
    }
    // It takes values only with the PLL off (RM0390, 6.3.2), also those of embassy-stm32 later.
    RCC.pllcfgr().write(|w| {
        w.set_pllsrc(PllSource::HSE);
        w.set_pllm(to_2_mhz(crystal));
        w.set_plln(MUL);
        w.set_pllp(DIVP);
        w.set_pllq(DIVQ);
        w.set_pllr(DIVR);
    });
    RCC.cr().modify(|w| w.set_pllon(true));
    if !comes(|| RCC.cr().read().pllrdy()) {
        return Err("the PLL does not lock");
    }
    RCC.cr().modify(|w| w.set_pllon(false));
    let is_off = comes(|| !RCC.cr().read().pllrdy());
    is_off.then_some(()).ok_or("the PLL does not stop")
}

/// Starts the clocks, embassy's time, and the flash accelerator.
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
    // embassy-stm32 switches the over-drive on, which 180 MHz need.
    config.rcc.pll = Some(Pll { prediv, mul: MUL, divp: Some(DIVP), divq: Some(DIVQ), divr: Some(DIVR) });
    // Nothing uses the slow oscillators by way of embassy-stm32, which would wait for them without an end.
    config.rcc.ls = LsConfig::off();
    config.rcc.sys = Sysclk::PLL1_P;
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    // embassy's time counts half laps of TIM2 by its flags. Before the counter starts, the counter and the compare
    // register of the half lap are both 0. That sets the half-lap flag in the emulated chip, and perhaps in the real
    // one; embassy-stm32 0.6.0 does not clear it. With one half lap too many, a read just when a half lap ends goes
    // back by 65 ms.
    critical_section::with(|_| {
        // The peripherals are used by their registers here.
        let _ = embassy_stm32::init(config);
        TIM2.sr().write(|_| ());
        NVIC::unpend(Interrupt::TIM2);
    });
    // embassy-stm32 0.6.0 writes the wait states into ACR and with that switches prefetch and both caches off, which
    // every start of a branch would pay with five cycles and more.
    // Both caches are off now, so they may be emptied of a bootloader's lines first (RM0390, 3.8.1, ICRST and DCRST).
    FLASH.acr().modify(|w| {
        w.set_icrst(true);
        w.set_dcrst(true);
    });
    FLASH.acr().modify(|w| {
        w.set_icrst(false);
        w.set_dcrst(false);
    });
    FLASH.acr().modify(|w| {
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    // If the crystal stops, the processor falls back to 16 MHz and raises NMI (RM0390, 6.2.7).
    RCC.cr().modify(|w| w.set_csson(true));
}

/// Stops embassy's time during `work`, which may hold off interrupts for longer than a half lap of TIM2, 33 ms. Without
/// this embassy would count at most two of the half laps that end in that time. After an odd number of uncounted half
/// laps, every later read just when a half lap ends would go back by 65 ms.
pub fn without_time<R>(work: impl FnOnce() -> R) -> R {
    TIM2.cr1().modify(|w| w.set_cen(false));
    let result = work();
    TIM2.cr1().modify(|w| w.set_cen(true));
    result
}

/// Divides the crystal's clock to 2 MHz, for either PLL.
const fn to_2_mhz(crystal: Crystal) -> PllPreDiv {
    match crystal {
        Crystal::Oscillator12MHz => PllPreDiv::DIV6,
        Crystal::Clock8MHz => PllPreDiv::DIV4,
    }
}

/// Starts the 48 MHz of USB: 2 MHz * 96 / 4 in PLLSAI, which is off before. Returns whether they run.
///
/// embassy-stm32 0.6.0 cannot do this: it leaves the predivider PLLSAIM at the forbidden 0 (RM0390, 6.3.24). The F446
/// has PLLSAIM in a register of its own. It also writes CK48MSEL into DCKCFGR, where other chips have it.
pub fn start_usb(crystal: Crystal) -> bool {
    RCC.pllsaicfgr().modify(|w| {
        w.set_pllm(to_2_mhz(crystal));
        w.set_plln(PllMul::MUL96);
        w.set_pllp(PllPDiv::DIV4);
        // Not used, and 2 or more.
        w.set_pllq(PllQDiv::DIV4);
    });
    RCC.dckcfgr2().modify(|w| w.0 |= CK48MSEL);
    RCC.cr().modify(|w| w.set_pllsaion(true));
    comes(|| RCC.cr().read().pllsairdy())
}
