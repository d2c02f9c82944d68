//! The converter's own reference, 1.21 V (STM32F446 datasheet, V_REFINT), which measures the supply behind the
//! thermistors, and the processor's temperature sensor.
//!
//! Only ADC1 has them, on channels 17 and 18 (RM0390, 13.3.3). So ADC1 converts both once in a control period:
//! [`begin`](ReferenceVoltage::begin) starts a conversion, and [`read`](ReferenceVoltage::read) reads it in the next
//! period. There is no wait. The sensor is an injected channel, which follows the regular one by itself and has a data
//! register of its own (13.3.9). All three converters share the registers with their clock and with the switch of both.
//! `thermistors` sets the clock, to the same value.

use corehbot::units::Celsius;
use corehbot_board_support::mcu_temperature::Calibration;
use embassy_stm32::pac::adc::vals::SampleTime;
use embassy_stm32::pac::adccommon::vals::Adcpre;
use embassy_stm32::pac::{ADC1, ADC123_COMMON, RCC};

/// The channels of ADC1: the reference and the temperature sensor.
const REFERENCE: u8 = 17;
const SENSOR: u8 = 18;

/// The factory's readings, VREFIN_CAL, TS_CAL1 and TS_CAL2 (STM32F446 datasheet, internal reference voltage calibration
/// values and temperature sensor calibration values).
const FACTORY: *const [u16; 3] = 0x1FFF_7A2A as *const _;

/// ADC1, converting the reference and the temperature sensor.
pub struct ReferenceVoltage {
    factory: Calibration,
    /// The last readings of reference and sensor, of 12 bits.
    readings: Option<[u16; 2]>,
}

impl ReferenceVoltage {
    /// Switches both on. They need 10 us after that (STM32F446 datasheet, t_START), and the converter 3 us; the first
    /// conversion is begun by the first control period at the earliest.
    pub fn start() -> Self {
        RCC.apb2enr().modify(|w| w.set_adc1en(true));
        let _ = RCC.apb2enr().read();
        ADC123_COMMON.ccr().modify(|w| {
            // 90 MHz over 4, where 36 MHz are allowed (STM32F446 datasheet, f_ADC).
            w.set_adcpre(Adcpre::DIV4);
            // The battery has the sensor's channel while it is switched on (RM0390, 13.10 and 13.11).
            w.set_vbate(false);
            w.set_tsvrefe(true);
        });
        // Sampling takes 21 us, and must take 10 (STM32F446 datasheet, T_S_vrefint and T_S_temp).
        ADC1.smpr1().modify(|w| {
            [REFERENCE, SENSOR].iter().for_each(|channel| w.set_smp(usize::from(*channel) - 10, SampleTime::CYCLES480));
        });
        ADC1.sqr1().modify(|w| w.set_l(0));
        ADC1.sqr3().modify(|w| w.set_sq(0, REFERENCE));
        // A single injected channel is the fourth of the sequence (RM0390, 13.13.12).
        ADC1.jsqr().write(|w| w.set_jsq(3, SENSOR));
        ADC1.cr1().modify(|w| w.set_jauto(true));
        ADC1.cr2().modify(|w| w.set_adon(true));
        // SAFETY: three aligned half-words of the system memory, which every F446 has (RM0390, 2.2.2), which nothing
        // changes, and which any bits are legal for.
        let [reference, at_30, at_110] = unsafe { FACTORY.read_volatile() };
        Self { factory: Calibration { reference, at_30, at_110 }, readings: None }
    }

    /// Begins a conversion of both.
    pub fn begin(&mut self) {
        ADC1.cr2().modify(|w| w.set_swstart(true));
    }

    /// Result of the last conversion of the reference, in 1/65,536 of the supply, if it is over. Reading clears it
    /// (RM0390, 13.13.1: EOC).
    pub fn read(&mut self) -> Option<u16> {
        let is_over = ADC1.sr().read().eoc();
        // The sensor's conversion was over 22 us later, in the same period.
        self.readings = is_over.then(|| [ADC1.dr().read().data(), ADC1.jdr(0).read().jdata()]);
        self.readings.map(|[reference, _]| reference << 4)
    }

    /// The processor's temperature at the last [`read`](Self::read).
    pub fn celsius(&self) -> Option<Celsius> {
        let [reference, sensor] = self.readings?;
        self.factory.celsius(sensor, reference)
    }
}
