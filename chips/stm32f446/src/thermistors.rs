//! The thermistors: ADC3 converts them all in turn, for ever, and DMA keeps the last sixteen of each.
//!
//! Sampling takes 480 of the converter's cycles and a conversion 12 more, 22 us at 22.5 MHz. That is far more than the
//! 10 kOhm of thermistor and filter need (STM32F446 datasheet, ADC accuracy and R_AIN). Five channels take 109 us a
//! round, so sixteen readings of each are 1.7 ms old at the most.
//!
//! The sum of sixteen readings of 12 bits is one of 16 bits. At 250 C a degree is 3.7 steps of 12 bits. Averaging needs
//! noise of about a step, and reduces it to a quarter: 0.07 degrees. The conversion to degrees filters slower noise.
//!
//! A new input is a row in the wiring of its board ([`ThermistorPin`]); there may be [`MOST_THERMISTORS`]. The kind of
//! thermistor that is plugged in there is a setting (`settings::Thermistor` of the core), and its curve is in
//! `thermal::sensor`.
//!
//! No interrupt: a read adds up the stored readings, and checks that the DMA still counts. An overrun or a stopped
//! clock ends that for good, and then there are no values any more.
//!
//! DMA2 of the STM32F405 spoils data when it serves AHB and APB2 peripherals at a time (ES0182). Whether the F446
//! shares this could not be read up; so long as DMA2 serves nothing on AHB1, such as GPIO ports, it does not matter.

use core::ops::Range;
use core::sync::atomic::{AtomicU16, Ordering};

use corehbot::port::Sensor;
use embassy_stm32::pac::adc::vals::{Dds, SampleTime};
use embassy_stm32::pac::adccommon::vals::Adcpre;
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::{ADC3, ADC123_COMMON, DMA2, RCC};

use crate::ports;
use crate::resources::CONVERTER;
use crate::wiring::{MOST_THERMISTORS, ThermistorPin};

/// Its stream of DMA2.
const STREAM: usize = CONVERTER.stream;
const _: () = assert!(CONVERTER.controller == 2);

/// Readings of each sensor that are kept; their sum fills 16 bits.
const KEPT: usize = 16;

/// Cycles of 180 MHz until the converter has woken: 3 us (STM32F446 datasheet, t_STAB), with a margin of two.
const WAKING: u32 = 1080;

/// Polls of the DMA's counter within which a conversion ends: it takes 3936 cycles of 180 MHz, a poll at least four.
const LOOKS: u32 = 2000;

static KEPT_READINGS: [AtomicU16; MOST_THERMISTORS * KEPT] = [const { AtomicU16::new(0) }; MOST_THERMISTORS * KEPT];

/// Where the DMA writes.
pub fn buffer() -> Range<u32> {
    let begin = KEPT_READINGS.as_ptr() as u32;
    begin..begin + size_of_val(&KEPT_READINGS) as u32
}

/// The thermistors of a board.
pub struct Thermistors {
    wired: &'static [ThermistorPin],
    /// Whether they are alive, if it was checked in this control period.
    are_alive: Option<bool>,
}

impl Thermistors {
    /// Lets the converter run; the pins are its own from now on.
    pub fn start(wired: &'static [ThermistorPin]) -> Self {
        let wired = wired.get(..MOST_THERMISTORS).unwrap_or(wired);
        if wired.is_empty() {
            return Self { wired, are_alive: None };
        }
        wired.iter().for_each(|thermistor| ports::make_analog(thermistor.pin));
        RCC.apb2enr().modify(|w| {
            w.set_adc3en(true);
            // The common registers may hang on the clock of the first converter: Linux's device tree and the emulator
            // have it so, the manual does not say.
            w.set_adc1en(true);
        });
        RCC.ahb1enr().modify(|w| w.set_dma2en(true));
        let _ = RCC.ahb1enr().read();
        // 90 MHz over 4, where 36 MHz are allowed (STM32F446 datasheet, f_ADC).
        ADC123_COMMON.ccr().modify(|w| w.set_adcpre(Adcpre::DIV4));
        // Before the converter: a reading that is not fetched is an overrun, which stops it.
        start_dma(wired.len());
        for (place, thermistor) in wired.iter().enumerate() {
            let channel = thermistor.channel;
            match usize::from(channel) {
                high @ 10.. => ADC3.smpr1().modify(|w| w.set_smp(high - 10, SampleTime::CYCLES480)),
                low => ADC3.smpr2().modify(|w| w.set_smp(low, SampleTime::CYCLES480)),
            }
            ADC3.sqr3().modify(|w| w.set_sq(place, channel));
        }
        ADC3.sqr1().modify(|w| w.set_l(wired.len() as u8 - 1));
        ADC3.cr1().modify(|w| w.set_scan(true));
        ADC3.cr2().modify(|w| {
            w.set_cont(true);
            w.set_dma(true);
            // Without it the converter asks for nothing any more after the DMA's first round (RM0390, ADC_CR2, DDS).
            w.set_dds(Dds::CONTINUOUS);
            w.set_adon(true);
        });
        cortex_m::asm::delay(WAKING);
        ADC3.cr2().modify(|w| w.set_swstart(true));
        Self { wired, are_alive: None }
    }

    /// Whether the board has this sensor.
    pub fn has(&self, sensor: Sensor) -> bool {
        self.wired.iter().any(|thermistor| thermistor.sensor == sensor)
    }

    /// The reading, in 1/65,536 of the supply. The first call after [`forget`](Self::forget) takes 22 us at the most,
    /// and 0.2 ms if the converter has stopped.
    pub fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        let place = self.wired.iter().position(|thermistor| thermistor.sensor == sensor)?;
        if !*self.are_alive.get_or_insert_with(Self::is_alive) {
            return None;
        }
        let readings = KEPT_READINGS.iter().skip(place).step_by(self.wired.len()).take(KEPT);
        Some(readings.map(|reading| reading.load(Ordering::Relaxed)).fold(0, u16::saturating_add))
    }

    /// Another control period: the converter has to be checked again.
    pub fn forget(&mut self) {
        self.are_alive = None;
    }

    /// Whether all readings have come in at least once, and still come in.
    fn is_alive() -> bool {
        let before = waiting();
        DMA2.isr(STREAM / 4).read().tcif(STREAM % 4) && (0..LOOKS).any(|_| waiting() != before)
    }
}

/// Starts circular DMA for the readings of `channels` channels.
fn start_dma(channels: usize) {
    let stream = DMA2.st(STREAM);
    stream.par().write_value(ADC3.dr().as_ptr() as u32);
    stream.m0ar().write_value(KEPT_READINGS.as_ptr() as u32);
    stream.ndtr().write(|w| w.set_ndt((channels * KEPT) as u16));
    stream.cr().write(|w| {
        w.set_chsel(CONVERTER.request);
        w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
        w.set_psize(Size::BITS16);
        w.set_msize(Size::BITS16);
        w.set_minc(true);
        w.set_circ(true);
        w.set_pl(Pl::MEDIUM);
    });
    stream.cr().modify(|w| w.set_en(true));
}

/// Readings until the DMA starts its next round.
fn waiting() -> u16 {
    DMA2.st(STREAM).ndtr().read().ndt()
}
