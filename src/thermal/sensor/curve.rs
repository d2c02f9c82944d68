//! Curves: from the converter's sample to degrees.
//!
//! The sensor is between ground and the converter, with a resistor of 4.7 kOhm to the converter's own reference. So the
//! reading is R / (R + 4700), whatever the voltage.

use super::logarithm::{FRACTION, log2, natural};
use crate::settings::{Law, SHEETS, Sheet, Thermistor};
use crate::thermal::fixed_point::{quotient, saturated};
use crate::units::{Celsius, whole_root};

/// The resistor to the reference, in Ohm, on the Octopus and most boards (BTT's schematic, R at TH0).
const PULL_UP: u32 = 4700;

/// A reading of a sensor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reading {
    /// A temperature.
    Celsius(Celsius),
    /// Nothing is connected, or a wire is broken.
    Open,
    /// The wires touch.
    Short,
    /// The converter gives no sample.
    Silent,
}

/// Conversion from samples to degrees for one kind of sensor.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum Curve {
    /// An NTC, by the Steinhart-Hart equation: 1/T = a + b ln R + c (ln R)^3, T in K and R in Ohm.
    SteinhartHart {
        /// With 40 fractional bits.
        a: i64,
        /// With 40 fractional bits.
        b: i32,
        /// With 48 fractional bits.
        c: i32,
    },
    /// A platinum resistor of 1 kOhm (IEC 60751).
    Platinum,
}

/// 0 C in K, as [`Celsius`].
const ZERO_C: i64 = (273.15 * (1u64 << Celsius::FRAC_NBITS) as f64) as i64;

/// 1/298.15 K, 25 C, with 40 fractional bits.
const AT_25: i64 = (((1u64 << 40) as f64) / 298.15) as i64;

/// Below every NTC (Vishay's catalogue begins at 2800 K); 1/B then has no more than 31 bits.
const LEAST_BETA: u16 = 1000;

/// 1e-9 with 48 fractional bits, within 0.001 %.
const CUBIC: i32 = ((1u64 << 48) as f64 * 1e-9) as i32;

/// Coefficients of IEC 60751: R / R0 = 1 + A t + B t^2, above 0 C; below, it is off by 0.02 K at -20 C.
const A: f64 = 3.9083e-3;
const B: f64 = -5.775e-7;

impl Curve {
    /// The curve of a sensor.
    #[must_use]
    pub const fn new(thermistor: Thermistor) -> Self {
        match thermistor {
            Thermistor::Sheet(place) => {
                // As a `const` the table holds coefficients, not the points that they come from.
                const CURVES: [Curve; SHEETS.len()] = of_sheets();
                let place = if (place as usize) < CURVES.len() { place as usize } else { 0 };
                match CURVES.split_at(place).1 {
                    [curve, ..] => *curve,
                    [] => Self::Platinum,
                }
            }
            Thermistor::Beta { ohms, beta, cubic } => {
                let b = ((1 << 40) / if beta < LEAST_BETA { LEAST_BETA as i64 } else { beta as i64 }) as i32;
                let c = (cubic & Thermistor::MOST_CUBIC) as i32 * CUBIC;
                let at_25 = natural(log2(if ohms == 0 { 1 } else { ohms })) as i32;
                Self::SteinhartHart { a: AT_25 - of_logarithm(at_25, b, c), b, c }
            }
        }
    }

    /// The reading for a sample in units of 1/65,536 of the reference.
    #[must_use]
    pub fn read(&self, sample: Option<u16>) -> Reading {
        let Some(sample) = sample else { return Reading::Silent };
        let (short, open) = match self {
            // An NTC of 100 kOhm has less than 18 Ohm only above 450 C, and 2.3 MOhm at -38 C.
            Self::SteinhartHart { .. } => (250, 65_400),
            // 750 Ohm, -63 C, and 3.9 kOhm, 900 C.
            Self::Platinum => (9_000, 29_800),
        };
        if sample < short {
            return Reading::Short;
        }
        if sample > open {
            return Reading::Open;
        }
        Reading::Celsius(match *self {
            Self::SteinhartHart { a, b, c } => of_steinhart_hart(sample, a, b, c),
            Self::Platinum => of_platinum(sample),
        })
    }
}

/// The curves of all data sheets.
const fn of_sheets() -> [Curve; SHEETS.len()] {
    let mut curves = [Curve::Platinum; SHEETS.len()];
    let (mut places, mut sheets): (&mut [Curve], &[Sheet]) = (&mut curves, &SHEETS);
    while let ([place, other_places @ ..], [sheet, other_sheets @ ..]) = (places, sheets) {
        *place = match sheet.law {
            Law::Ntc(points) => through(points),
            Law::Platinum => Curve::Platinum,
        };
        (places, sheets) = (other_places, other_sheets);
    }
    curves
}

/// The curve through three points, in C and Ohm. Divided differences: the slopes of two chords do not hold a, and the
/// slope of the slopes does not hold b.
const fn through([(t0, r0), (t1, r1), (t2, r2)]: [(f64, f64); 3]) -> Curve {
    let (y0, y1, y2) = (1.0 / (t0 + 273.15), 1.0 / (t1 + 273.15), 1.0 / (t2 + 273.15));
    let (x0, x1, x2) = (ln(r0), ln(r1), ln(r2));
    // A chord from x to z has the slope b + c (x^2 + x z + z^2).
    let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y0) / (x2 - x0));
    let c = (second - first) / ((x2 - x1) * (x0 + x1 + x2));
    let b = first - c * (x0 * x0 + x0 * x1 + x1 * x1);
    let scale = (1u64 << 40) as f64;
    let a = y0 - b * x0 - c * x0 * x0 * x0;
    Curve::SteinhartHart { a: (a * scale) as i64, b: (b * scale) as i32, c: (c * scale * 256.0) as i32 }
}

/// The natural logarithm of a number from 1 on, to the last bits of a double: of its exponent, and of its mantissa by
/// the series of the area tangent. At compile time there is no other.
const fn ln(number: f64) -> f64 {
    let exponent = (number.to_bits() >> 52) as i64 - 1023;
    let mantissa = f64::from_bits(number.to_bits() & ((1 << 52) - 1) | 1023 << 52);
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    // s is below 1/3: a term is below a ninth of the one before, and after 20 of them nothing is left of 53 bits.
    let (mut terms, mut sum) = (20, 0.0);
    while terms > 0 {
        terms -= 1;
        sum = sum * s * s + 1.0 / (2 * terms + 1) as f64;
    }
    exponent as f64 * core::f64::consts::LN_2 + 2.0 * s * sum
}

/// `sample` is 250 to 65,400, so the resistance is 18 Ohm to 2.3 MOhm, and its logarithm 2.8 to 14.7.
fn of_steinhart_hart(sample: u16, a: i64, b: i32, c: i32) -> Celsius {
    let sample = u32::from(sample);
    // All bits of the quotient that fit: the sample alone would have 11 of them at 280 C.
    let shift = sample.leading_zeros();
    let ratio = (sample << shift) / ((1 << 16) - sample);
    let log2_ohms = log2(ratio) - (i64::from(shift) << FRACTION) + const { log2(PULL_UP) };
    let inverse = a + of_logarithm(natural(log2_ohms) as i32, b, c);
    // 38 fractional bits are left of the 40, so that 64 K and more fit into a word.
    let inverse = (inverse >> 2).clamp(1 << 26, u32::MAX.into()) as u32;
    Celsius::from_bits(saturated(i64::from(quotient(1 << 58, inverse)) - ZERO_C))
}

/// b ln R + c (ln R)^3, with 40 fractional bits. Logarithm, square and cube are words of 32 bits, with 26, 20 and 19
/// fractional bits.
const fn of_logarithm(log: i32, b: i32, c: i32) -> i64 {
    let square = (wide_mul(log, log) >> 32) as i32;
    let cube = (wide_mul(square, log) >> 27) as i32;
    (wide_mul(b, log) >> FRACTION) + (wide_mul(c, cube) >> 27)
}

const fn wide_mul(a: i32, b: i32) -> i64 {
    a as i64 * b as i64
}

fn of_platinum(sample: u16) -> Celsius {
    let sample = u64::from(sample);
    // R / R0 with 24 fractional bits.
    let ratio = ((sample * u64::from(PULL_UP)) << 24) / (1000 * ((1 << 16) - sample));
    // The root of A^2 - 4 B (1 - R/R0), with 60 and then 30 fractional bits.
    let square = const { (A * A * (1u64 << 60) as f64) as i64 };
    let slope = const { (-4.0 * B * (1u64 << 60) as f64) as i64 };
    // 12 bits fewer before the product and 12 after it: all of them would need 67 bits.
    let below = square + (((slope >> 12) * ((1 << 24) - ratio as i64)) >> 12);
    let root = whole_root(below.max(0).cast_unsigned()) as i64;
    let difference = const { (A * (1u64 << 30) as f64) as i64 } - root;
    // Over 2 |B|, with 20 fractional bits.
    let over = const { ((1u64 << 20) as f64 / (-2.0 * B * (1u64 << 20) as f64)) as i64 };
    Celsius::from_bits(((difference * over) >> 10) as i32)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    fn degrees(curve: Curve, ohms: f64) -> f64 {
        let sample = (65536.0 * ohms / (ohms + f64::from(PULL_UP))).round() as u16;
        match curve.read(Some(sample)) {
            Reading::Celsius(celsius) => celsius.to_num(),
            other => panic!("{other:?} at {ohms} Ohm"),
        }
    }

    #[test]
    fn curves_go_through_the_points_of_the_data_sheets() {
        // Of platinum those of IEC 60751, table 1.
        let platinum = [(0.0, 1000.0), (100.0, 1385.06), (400.0, 2470.92)];
        for thermistor in Thermistor::all() {
            let points = match thermistor.sheet().map(|sheet| sheet.law) {
                Some(Law::Ntc(points)) => points,
                Some(Law::Platinum) => platinum,
                None => continue,
            };
            for (celsius, ohms) in points {
                // A unit of the converter is 0.1 K at 300 C, and more at room temperature with 500 kOhm.
                let found = degrees(Curve::new(thermistor), ohms);
                assert!((found - celsius).abs() < 0.15, "{thermistor:?}: {found} at {celsius}");
            }
        }
    }

    /// Coefficients that were computed with another program from the same points.
    #[test]
    fn coefficients_are_those_of_another_computation() {
        let known = [
            (8.096_510_542_751_242e-4, 2.116_360_307_356_851_7e-4, 7.074_208_839_939_73e-8),
            (7.958_246_125_479_903e-4, 2.136_086_635_635_553e-4, 6.483_002_617_420_579e-8),
            (7.934_721_511_480_472e-4, 2.007_632_502_866_657_3e-4, 1.632_834_118_179_309e-7),
            (3.055_357_455_469_193_5e-4, 2.117_133_769_438_310_3e-4, 1.196_220_364_975_846_4e-7),
        ];
        let scale = (1u64 << 40) as f64;
        for (place, (a, b, c)) in (0..).zip(known) {
            let (a, b, c) = ((a * scale) as i64, (b * scale) as i32, (c * scale * 256.0) as i32);
            assert_eq!(Curve::new(Thermistor::Sheet(place)), Curve::SteinhartHart { a, b, c }, "{place}");
        }
    }

    #[test]
    fn logarithms_are_those_of_the_standard_library() {
        for ohms in [1.0, 1.5, 80.65, 1360.0, 126_800.0, 499_999.9, 2e6] {
            assert!((ln(ohms) - f64::ln(ohms)).abs() < 4e-15, "{ohms}");
        }
    }

    #[test]
    fn b_and_resistance_are_a_curve_too() {
        let curve = Curve::new(Thermistor::Beta { ohms: 100_000, beta: 3950, cubic: 0 });
        for celsius in [0.0, 25.0, 60.0, 120.0, 200.0] {
            let ohms = 100_000.0 * f64::exp(3950.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15));
            let found = degrees(curve, ohms);
            assert!((found - celsius).abs() < 0.05, "{found} at {celsius}");
        }
    }

    /// EPCOS B57560G104F, by three points of its data sheet.
    #[test]
    fn with_a_cubic_term_the_curve_bends_as_the_data_sheet_does() {
        let curve = Curve::new(Thermistor::Beta { ohms: 100_000, beta: 4612, cubic: 89 });
        for (celsius, ohms) in [(25.0, 100_000.0), (150.0, 1641.9), (250.0, 226.15)] {
            let found = degrees(curve, ohms);
            assert!((found - celsius).abs() < 0.15, "{found} at {celsius}");
        }
        let by_b = degrees(Curve::new(Thermistor::Beta { ohms: 100_000, beta: 4148, cubic: 0 }), 226.15);
        assert!(by_b > 255.0, "B alone was {by_b} at 250 C");
    }

    #[test]
    fn platinum_is_that_of_the_standard() {
        for celsius in [0.0, 25.0, 100.0, 215.0, 300.0, 500.0] {
            let ohms = 1000.0 * (1.0 + A * celsius + B * celsius * celsius);
            let found = degrees(Curve::Platinum, ohms);
            assert!((found - celsius).abs() < 0.05, "{found} at {celsius}");
        }
    }

    #[test]
    fn all_readings_have_an_answer_and_ntcs_fall() {
        for thermistor in Thermistor::all().filter(|thermistor| *thermistor != Thermistor::PT1000) {
            let curve = Curve::new(thermistor);
            let mut last = Celsius::MAX;
            for sample in 0..=u16::MAX {
                match curve.read(Some(sample)) {
                    Reading::Celsius(celsius) => {
                        assert!(celsius <= last, "{thermistor:?} rises at {sample}");
                        last = celsius;
                    }
                    Reading::Short => assert!(sample < 250),
                    Reading::Open => assert!(sample > 65_400),
                    Reading::Silent => panic!("a sample is no silence"),
                }
            }
        }
        assert_eq!(Curve::Platinum.read(Some(0)), Reading::Short);
        assert_eq!(Curve::Platinum.read(Some(u16::MAX)), Reading::Open);
        assert_eq!(Curve::Platinum.read(None), Reading::Silent);
        // Nonsense from a machine file must not panic either.
        for (ohms, beta, cubic) in [(0, 0, 0), (1, 1, 1), (u32::MAX, u16::MAX, u16::MAX)] {
            let curve = Curve::new(Thermistor::Beta { ohms, beta, cubic });
            for sample in (0..=u16::MAX).step_by(97) {
                let _ = curve.read(Some(sample));
            }
        }
    }
}
