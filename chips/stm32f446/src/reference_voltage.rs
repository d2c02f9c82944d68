//! The converter's own reference, 1.21 V (STM32F446 datasheet, V_REFINT), which measures the supply behind the
//! thermistors.
//!
//! Only ADC1 has it, on channel 17 (RM0390, 13.3.3), and thermistors are on ADC3. So ADC1 converts it once in a control
//! period: [`begin`](ReferenceVoltage::begin) starts a conversion, and [`read`](ReferenceVoltage::read) reads it in the
//! next period. There is no wait. All three converters share the registers with their clock and with the switch of the
//! reference. `thermistors` sets the clock, to the same value.

use embassy_stm32::pac::adc::vals::SampleTime;
use embassy_stm32::pac::adccommon::vals::Adcpre;
use embassy_stm32::pac::{ADC1, ADC123_COMMON, RCC};

/// The reference's channel of ADC1.
const CHANNEL: u8 = 17;

/// ADC1, converting the reference.
pub struct ReferenceVoltage(());

impl ReferenceVoltage {
    /// Switches it on. The reference needs 10 us after that (STM32F446 datasheet, t_START), and the converter 3 us; the
    /// first conversion is begun by the first control period at the earliest.
    pub fn start() -> Self {
        RCC.apb2enr().modify(|w| w.set_adc1en(true));
        let _ = RCC.apb2enr().read();
        ADC123_COMMON.ccr().modify(|w| {
            // 90 MHz over 4, where 36 MHz are allowed (STM32F446 datasheet, f_ADC).
            w.set_adcpre(Adcpre::DIV4);
            w.set_tsvrefe(true);
        });
        // Sampling takes 21 us, and must take 10 (STM32F446 datasheet, T_S_vrefint).
        ADC1.smpr1().modify(|w| w.set_smp(usize::from(CHANNEL) - 10, SampleTime::CYCLES480));
        ADC1.sqr1().modify(|w| w.set_l(0));
        ADC1.sqr3().modify(|w| w.set_sq(0, CHANNEL));
        ADC1.cr2().modify(|w| w.set_adon(true));
        Self(())
    }

    /// Begins a conversion.
    pub fn begin(&mut self) {
        ADC1.cr2().modify(|w| w.set_swstart(true));
    }

    /// Result of the last conversion, in 1/65,536 of the supply, if it is over. Reading clears it (RM0390, 13.13.1:
    /// EOC).
    pub fn read(&mut self) -> Option<u16> {
        ADC1.sr().read().eoc().then(|| ADC1.dr().read().data() << 4)
    }
}
