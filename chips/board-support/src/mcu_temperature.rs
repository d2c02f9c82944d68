//! The processor's own temperature, from two readings of its converter: of its temperature sensor and of its reference.
//!
//! Both are parts of the converter's supply, so their quotient does not depend on it. The factory has written both
//! readings at 3.3 V into each chip, the sensor's at two temperatures; without them a chip may be 45 K off. Between
//! them the sensor is straight to 2 K (STM32F446 datasheet, temperature sensor characteristics and calibration values).

use corehbot::units::Celsius;

/// The factory's readings of 12 bits, at a supply of 3.3 V.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Calibration {
    /// Of the reference.
    pub reference: u16,
    /// Of the sensor at 30 C.
    pub at_30: u16,
    /// Of the sensor at 110 C.
    pub at_110: u16,
}

/// Bits of a conversion.
const BITS: u32 = 12;

impl Calibration {
    /// The temperature for a reading of the sensor and one of the reference, each of 12 bits. `None` if the chip has no
    /// calibration, or if there is no such reading.
    #[must_use]
    pub fn celsius(&self, sensor: u16, reference: u16) -> Option<Celsius> {
        let words = [self.reference, self.at_30, self.at_110, sensor, reference].map(i32::from);
        if words.iter().any(|word| !(1..1 << BITS).contains(word)) {
            return None;
        }
        let [calibrated, at_30, at_110, sensor, reference] = words;
        // The reading at 3.3 V, in 16ths of a step. It has at most 20 bits if the reference is at least a sixteenth of
        // its calibrated value, below which the processor does not run.
        let reading = sensor * calibrated / reference * 16;
        let span = Some(at_110 - at_30).filter(|span| *span > 0 && reading < 1 << 20)?;
        // 80 K in hundredths, over 16.
        let centi = 3000 + (reading - 16 * at_30) * 500 / span;
        Some(Celsius::from_bits(((centi.clamp(-10_000, 20_000) << 8) / 100) << (Celsius::FRAC_NBITS - 8)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A usual chip: 1.21 V, and 0.76 V at 25 C with 2.5 mV/K (STM32F446 datasheet).
    const USUAL: Calibration = Calibration { reference: 1501, at_30: 958, at_110: 1207 };

    /// A reading of a voltage at a supply.
    fn reading(volts: f64, supply: f64) -> u16 {
        (volts / supply * 4095.0).round() as u16
    }

    #[test]
    fn degrees_do_not_depend_on_the_supply() {
        for supply in [2.4, 3.0, 3.3, 3.6] {
            for celsius in [-40.0, 0.0, 25.0, 30.0, 55.5, 85.0, 125.0] {
                let sensor = reading(0.76 + 0.0025 * (celsius - 25.0), supply);
                let read = USUAL.celsius(sensor, reading(1.21, supply)).unwrap().to_num::<f64>();
                // A step of the sensor is 0.3 K, and one of the reference as much at 110 C.
                assert!((read - celsius).abs() < 0.8, "{celsius} at {supply} V: {read}");
            }
        }
    }

    #[test]
    fn a_chip_is_read_by_its_own_words() {
        let other = Calibration { reference: 1450, at_30: 1010, at_110: 1260 };
        assert_eq!(other.celsius(1010, 1450), Some(Celsius::const_from_int(30)));
        assert_eq!(other.celsius(1260, 1450), Some(Celsius::const_from_int(110)));
    }

    #[test]
    fn without_words_or_readings_there_is_no_temperature() {
        let erased = Calibration { reference: 0xFFFF, at_30: 0xFFFF, at_110: 0xFFFF };
        let reversed = Calibration { at_30: USUAL.at_110, at_110: USUAL.at_30, ..USUAL };
        for chip in [erased, reversed, Calibration { at_110: 958, ..USUAL }, Calibration { at_30: 0, ..USUAL }] {
            assert_eq!(chip.celsius(958, 1501), None);
        }
        for (sensor, reference) in [(0, 1501), (958, 0), (4096, 1501), (4095, 1)] {
            assert_eq!(USUAL.celsius(sensor, reference), None, "{sensor} {reference}");
        }
        // Whatever is read, nothing overflows.
        assert!((1..4096).step_by(13).all(|sensor| USUAL.celsius(sensor, 1501).is_some()));
        assert_eq!(USUAL.celsius(1, 4095), Some(Celsius::const_from_int(-100)));
    }
}
