//! Clocks: 180 MHz from the crystal, and 48 MHz for USB.

use embassy_stm32::pac::flash::regs::Acr;
use embassy_stm32::pac::flash::vals::Latency;
use embassy_stm32::pac::pwr::vals::Vos;
use embassy_stm32::pac::rcc::vals::{Hpre, Pllm, Plln, Pllp, Pllq, Pllr, Pllsrc, Ppre, Sw};
use embassy_stm32::pac::{DBGMCU, FLASH, PWR, RCC};

use crate::after_bootloader::comes;
use crate::wiring::Crystal;

/// Clock of the core.
pub const CORE_HZ: u32 = 180_000_000;

/// Clock of APB1: a quarter of 180 MHz.
pub const APB1_HZ: u32 = 45_000_000;

/// Clock of the timers on APB1: twice the bus's (RM0390, 6.2, figure of the clock tree).
pub const APB1_TIMER_HZ: u32 = 2 * APB1_HZ;

/// Clock of the timers on APB2: twice the bus's 90 MHz (RM0390, 6.2, figure of the clock tree).
pub const APB2_TIMER_HZ: u32 = 180_000_000;

/// The system clock is 2 MHz * 180 / 2.
const MUL: Plln = Plln::MUL180;
const DIVP: Pllp = Pllp::DIV2;

/// The two other outputs of the PLL are not used, but their divisors must be 2 or more (RM0390, 6.3.2): 45 and 180 MHz.
const DIVQ: Pllq = Pllq::DIV8;
const DIVR: Pllr = Pllr::DIV2;

/// Takes the 48 MHz of USB from PLLSAI instead of the main PLL (RM0390, 6.3.27, CK48MSEL).
const CK48MSEL: u32 = 1 << 27;

/// Wait states at 180 MHz and 2.7 V or more (RM0390, 3.4.1, table of wait states).
const WAIT_STATES: Latency = Latency::WS5;

/// Starts crystal, over-drive and PLL, one after the other, and runs on from the PLL. Returns what does not start; the
/// internal oscillator is then the system clock, as before. No wait is without an end.
pub fn start(crystal: Crystal) -> Result<(), &'static str> {
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
    // Over-drive, which 180 MHz need: in this order, on an oscillator and with the PLL off (RM0390, 5.1.4). The voltage
    // scale takes effect when the PLL is on (RM0390, 5.4.1, VOS).
    PWR.cr1().modify(|w| {
        w.set_vos(Vos::SCALE1);
        w.set_oden(true);
    });
    if !comes(|| PWR.csr1().read().odrdy()) {
        return Err("the supply of the processor has no over-drive");
    }
    PWR.cr1().modify(|w| w.set_odswen(true));
    if !comes(|| PWR.csr1().read().odswrdy()) {
        return Err("the processor does not switch to over-drive");
    }
    // It takes values only with the PLL off (RM0390, 6.3.2).
    RCC.pllcfgr().write(|w| {
        w.set_pllsrc(Pllsrc::HSE);
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
    // Both caches go off with this, so they may be emptied of a bootloader's lines (RM0390, 3.8.1, ICRST and DCRST).
    let mut access = Acr(0);
    access.set_latency(WAIT_STATES);
    FLASH.acr().write_value(access);
    // The wait states are in use when they are read back (RM0390, 3.4.1).
    if !comes(|| FLASH.acr().read().latency() == WAIT_STATES) {
        return Err("the flash does not take wait states");
    }
    FLASH.acr().modify(|w| {
        w.set_icrst(true);
        w.set_dcrst(true);
    });
    FLASH.acr().write_value(access);
    FLASH.acr().modify(|w| {
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    RCC.cfgr().modify(|w| {
        w.set_sw(Sw::PLL1_P);
        w.set_hpre(Hpre::DIV1);
        w.set_ppre1(Ppre::DIV4);
        w.set_ppre2(Ppre::DIV2);
    });
    if !comes(|| RCC.cfgr().read().sws() == Sw::PLL1_P) {
        return Err("the processor does not switch to the PLL");
    }
    // A probe that looks on keeps its clock while the processor sleeps (RM0390, 33.16.3).
    DBGMCU.cr().modify(|w| {
        w.set_dbg_sleep(true);
        w.set_dbg_stop(true);
        w.set_dbg_standby(true);
    });
    // If the crystal stops, the processor falls back to 16 MHz and raises NMI (RM0390, 6.2.7).
    RCC.cr().modify(|w| w.set_csson(true));
    Ok(())
}

/// Divides the crystal's clock to 2 MHz, for either PLL.
const fn to_2_mhz(crystal: Crystal) -> Pllm {
    match crystal {
        Crystal::Oscillator12MHz => Pllm::DIV6,
        Crystal::Clock8MHz => Pllm::DIV4,
    }
}

/// Starts the 48 MHz of USB: 2 MHz * 96 / 4 in PLLSAI, which is off before. Returns whether they run.
///
/// embassy-stm32 0.6.0 cannot do this: it leaves the predivider PLLSAIM at the forbidden 0 (RM0390, 6.3.24). The F446
/// has PLLSAIM in a register of its own. It also writes CK48MSEL into DCKCFGR, where other chips have it.
pub fn start_usb(crystal: Crystal) -> bool {
    RCC.pllsaicfgr().modify(|w| {
        w.set_pllm(to_2_mhz(crystal));
        w.set_plln(Plln::MUL96);
        w.set_pllp(Pllp::DIV4);
        // Not used, and 2 or more.
        w.set_pllq(Pllq::DIV4);
    });
    RCC.dckcfgr2().modify(|w| w.0 |= CK48MSEL);
    RCC.cr().modify(|w| w.set_pllsaion(true));
    comes(|| RCC.cr().read().pllsairdy())
}
