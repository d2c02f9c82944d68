//! Thermistors: the resistance at a temperature.
//!
//! Two laws of the field. Beta, from one resistance and one slope: 1/T = 1/T25 + ln(R/R25)/B. Steinhart-Hart, through
//! three points of a table: 1/T = a + b ln R + c (ln R)^3. T in kelvin, R in ohm.

/// 0 C in kelvin.
pub(super) const ZERO_CELSIUS: f64 = 273.15;

/// The law of a thermistor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Thermistor {
    /// Resistance at 25 C and slope.
    Beta {
        /// Resistance at 25 C, ohm.
        ohm_at_25: f64,
        /// B, kelvin.
        beta: f64,
    },
    /// The coefficients for R in ohm and T in kelvin.
    SteinhartHart {
        /// a, 1/K.
        a: f64,
        /// b, 1/K.
        b: f64,
        /// c, 1/K.
        c: f64,
    },
    /// A platinum resistor of 1 kOhm at 0 C (IEC 60751, above 0 C).
    Platinum,
}

impl Thermistor {
    /// NTC 100K B3950, the sensor of most heated beds. Its sellers give R25 = 100 kOhm and B25/50 = 3950 K and nothing
    /// else, so the law is Beta. Real ones bend away from it: Klipper's "Generic 3950" has 1770 Ohm at 150 C, Beta 1997
    /// Ohm, which is 5 C.
    pub const NTC_100K_B3950: Self = Self::Beta { ohm_at_25: 100e3, beta: 3950.0 };

    /// ATC Semitec 104GT-2, E3D's thermistor: Steinhart-Hart through 126.8 kOhm at 20 C, 1360 Ohm at 150 C and 80.65
    /// Ohm at 300 C. These are from Semitec's table for the GT series, as in Klipper's temperature_sensors.cfg (R25 =
    /// 100 kOhm, B25/85 = 4267 K).
    #[must_use]
    pub fn semitec_104gt2() -> Self {
        Self::through([(20.0, 126.8e3), (150.0, 1360.0), (300.0, 80.65)])
    }

    /// Steinhart-Hart through three points (Celsius, ohm) of a table.
    #[must_use]
    pub fn through(points: [(f64, f64); 3]) -> Self {
        let [(y0, x0), (y1, x1), (y2, x2)] =
            points.map(|(celsius, ohm)| (1.0 / (celsius + ZERO_CELSIUS), libm::log(ohm)));
        // Divided differences: the slopes of the two chords do not know a, the slope of the slopes does not know b.
        let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y0) / (x2 - x0));
        let c = (second - first) / ((x2 - x1) * (x0 + x1 + x2));
        let b = first - c * (x0 * x0 + x0 * x1 + x1 * x1);
        Self::SteinhartHart { a: y0 - b * x0 - c * x0 * x0 * x0, b, c }
    }

    /// Steinhart-Hart through the resistance at 25 C, ohm, with b = 1/`beta` and c in 1/K.
    #[must_use]
    pub fn bent(ohm_at_25: f64, beta: f64, c: f64) -> Self {
        let log = libm::log(ohm_at_25);
        Self::SteinhartHart { a: 1.0 / (25.0 + ZERO_CELSIUS) - log / beta - c * log * log * log, b: 1.0 / beta, c }
    }

    /// The resistance at a temperature, ohm.
    #[must_use]
    pub fn ohm(&self, celsius: f64) -> f64 {
        let inverse = 1.0 / (celsius + ZERO_CELSIUS);
        match *self {
            Self::Beta { ohm_at_25, beta } => ohm_at_25 * libm::exp(beta * (inverse - 1.0 / (25.0 + ZERO_CELSIUS))),
            Self::Platinum => 1000.0 * (1.0 + 3.9083e-3 * celsius - 5.775e-7 * celsius * celsius),
            // The one real root of the cubic in ln R, by Cardano.
            Self::SteinhartHart { a, b, c } => {
                let (half, third) = ((inverse - a) / (2.0 * c), b / (3.0 * c));
                let root = libm::sqrt(half * half + third * third * third);
                libm::exp(libm::cbrt(root + half) - libm::cbrt(root - half))
            }
        }
    }
}
