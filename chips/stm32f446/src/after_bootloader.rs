//! After a bootloader: resets clocks and peripherals, so that the firmware finds the chip as after a reset.
//!
//! BTT's bootloader starts the firmware at 180 MHz from a PLL, with over-drive and a second PLL on. SDIO, DMA2 and
//! USART3 are clocked and their interrupts enabled (emulator/src/bootloader.rs). Over-drive and voltage scale may
//! change only while HSI or HSE is the system clock and the PLL is off (RM0390, 5.4.1). So this code leaves the PLLs
//! first.
//!
//! Interrupts are masked since the reset vector (see `priorities`). No wait here is without an end.

use corehbot::fault::Cause;
use cortex_m::peripheral::DWT;
use embassy_stm32::pac::RCC;
use embassy_stm32::pac::rcc::vals::{Hpre, Ppre, Sw};

use crate::fault;

/// Clock of the internal oscillator (RM0390, 6.2.2).
pub const HSI_HZ: u32 = 16_000_000;

/// The longest wait in cycles: 0.1 s of the internal oscillator, 9 ms at 180 MHz. A crystal starts in 2 ms, a PLL locks
/// in 0.3 ms, over-drive takes 0.1 ms. Source: STM32F446 datasheet, HSE oscillator, PLL and over-drive switching
/// characteristics. ST's own library gives a crystal 0.1 s. The watchdog gives all these waits 0.34 s together.
const LONGEST: u32 = HSI_HZ / 10;

/// Peripherals to reset: all except the ports, because their outputs are safe and stay so (RM0390, 6.3.5 to 6.3.9).
/// AHB1: OTG_HS, DMA2, DMA1, CRC.
const AHB1: u32 = 0x2060_1000;
/// OTG_FS, DCMI.
const AHB2: u32 = 0x0000_0081;
/// QUADSPI, FMC.
const AHB3: u32 = 0x0000_0003;
/// DAC, PWR, CEC, CAN2, CAN1, FMPI2C1, I2C3 to 1, UART5 and 4, USART3 and 2, SPDIFRX, SPI3 and 2, WWDG, TIM14 to 12,
/// TIM7 to 2.
const APB1: u32 = 0x3FFF_C9FF;
/// SAI2 and 1, TIM11 to 9, SYSCFG, SPI4, SPI1, SDIO, ADC, USART6 and 1, TIM8 and 1.
const APB2: u32 = 0x00C7_7933;

/// Clocks on AHB1 that stay: the ports, and a reserved bit that is set after a reset (RM0390, 6.3.10).
const PORTS: u32 = 0x0010_00FF;

/// Waits until `is_done`, with a limit, and returns whether it came. The cycle counter has to run.
pub fn comes(is_done: impl Fn() -> bool) -> bool {
    let begin = DWT::cycle_count();
    loop {
        if is_done() {
            return true;
        }
        if DWT::cycle_count().wrapping_sub(begin) > LONGEST {
            return false;
        }
    }
}

/// Runs on from the internal oscillator, with everything else off. The flash keeps its wait states, which are enough.
#[inline(never)]
pub fn leave_plls() {
    RCC.cr().modify(|w| w.set_hsion(true));
    let is_ready = comes(|| RCC.cr().read().hsirdy());
    // Also if it is not ready: the switch waits for it, and the check below for both.
    RCC.cfgr().modify(|w| w.set_sw(Sw::HSI));
    if !is_ready || !comes(|| RCC.cfgr().read().sws() == Sw::HSI) {
        fault::give_up(Cause::ClockFailed, "an internal oscillator that does not run");
    }
    RCC.cr().modify(|w| {
        w.set_csson(false);
        w.set_pllon(false);
        w.set_plli2son(false);
        w.set_pllsaion(false);
        w.set_hseon(false);
    });
    let is_off = comes(|| {
        let cr = RCC.cr().read();
        !(cr.pllrdy() || cr.plli2srdy() || cr.pllsairdy() || cr.hserdy())
    });
    if !is_off {
        fault::give_up(Cause::ClockFailed, "a clock that cannot be switched off");
    }
    // Only now, at 16 MHz: undivided, the buses would have been too fast before.
    RCC.cfgr().modify(|w| {
        w.set_hpre(Hpre::DIV1);
        w.set_ppre1(Ppre::DIV1);
        w.set_ppre2(Ppre::DIV1);
    });
}

/// Resets all peripherals except the ports and switches their clocks off. That ends DMA streams and USB, and
/// over-drive.
pub fn reset_peripherals() {
    for on in [true, false] {
        let bits = |mask: u32| if on { mask } else { 0 };
        RCC.ahb1rstr().write(|w| w.0 = bits(AHB1));
        RCC.ahb2rstr().write(|w| w.0 = bits(AHB2));
        RCC.ahb3rstr().write(|w| w.0 = bits(AHB3));
        RCC.apb1rstr().write(|w| w.0 = bits(APB1));
        RCC.apb2rstr().write(|w| w.0 = bits(APB2));
    }
    RCC.ahb1enr().modify(|w| w.0 &= PORTS);
    RCC.ahb2enr().write(|w| w.0 = 0);
    RCC.ahb3enr().write(|w| w.0 = 0);
    RCC.apb1enr().write(|w| w.0 = 0);
    RCC.apb2enr().write(|w| w.0 = 0);
}
