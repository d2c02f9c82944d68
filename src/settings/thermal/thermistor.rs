//! Thermistors: kinds of temperature sensor. A kind with a data sheet is a row of [`SHEETS`]. Its name in machine
//! files, its number in records, its curve (`thermal::sensor`) and its law in the simulated plant come from there.

use crate::settings::field::Number;
use crate::settings::ranges;
use serde::{Deserialize, Serialize};

/// The values of a data sheet.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sheet {
    /// The name in machine files.
    pub name: &'static str,
    /// Its resistance.
    pub law: Law,
}

/// How a resistance follows from a temperature.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Law {
    /// An NTC, by the equation of Steinhart and Hart through three points of the data sheet: C and Ohm.
    Ntc([(f64, f64); 3]),
    /// A platinum resistor of 1 kOhm at 0 C (IEC 60751).
    Platinum,
}

/// The kinds with a data sheet. Records hold the place of a row, so a new one comes last.
pub const SHEETS: [Sheet; 5] = [
    // ATC Semitec 104GT-2, most hotends up to 300 C: Semitec's table of the GT-2 series.
    Sheet { name: "104gt2", law: Law::Ntc([(20.0, 126_800.0), (150.0, 1360.0), (300.0, 80.65)]) },
    // ATC Semitec 104NT-4-R025H42G: Semitec's table of the NT-4 series.
    Sheet { name: "104nt4", law: Law::Ntc([(25.0, 100_000.0), (160.0, 1074.0), (300.0, 82.78)]) },
    // 100 kOhm and B 3950, most beds: Keenovo's table.
    Sheet { name: "ntc_3950", law: Law::Ntc([(25.0, 100_000.0), (150.0, 1770.0), (250.0, 230.0)]) },
    // Slice Engineering's of 500 kOhm, for up to 450 C: its table.
    Sheet { name: "slice_450", law: Law::Ntc([(25.0, 500_000.0), (200.0, 3734.0), (400.0, 240.0)]) },
    // A platinum resistor, as Slice Engineering's for 500 C.
    Sheet { name: "pt1000", law: Law::Platinum },
];

/// A kind of temperature sensor.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum Thermistor {
    /// The sensor of a row of [`SHEETS`].
    Sheet(u8),
    /// Any other NTC, by 1/T = 1/T25 + ln(R/R25) / B + C (ln(R)^3 - ln(R25)^3): the equation of Steinhart and Hart.
    Beta {
        /// Resistance at 25 C, in Ohm.
        ohms: u32,
        /// B, in K.
        beta: u16,
        /// C, in 1e-9 / K, up to [`MOST_CUBIC`](Thermistor::MOST_CUBIC); 0 of an NTC that is known by its B alone. With
        /// it records hold multiples of 8 Ohm.
        cubic: u16,
    },
}

impl Thermistor {
    /// Most hotends.
    pub const SEMITEC_104GT2: Self = Self::Sheet(0);

    /// Most beds.
    pub const NTC_3950: Self = Self::Sheet(2);

    /// Platinum.
    pub const PT1000: Self = Self::Sheet(4);

    /// Every kind, of [`Self::Beta`] one that is usual.
    pub fn all() -> impl Iterator<Item = Self> {
        let usual = Self::Beta { ohms: 100_000, beta: 3950, cubic: 0 };
        (0..SHEETS.len() as u8).map(Self::Sheet).chain([usual])
    }

    /// The kind with that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let place = SHEETS.iter().position(|sheet| sheet.name == name)?;
        u8::try_from(place).ok().map(Self::Sheet)
    }

    /// Its data sheet, if it has one.
    #[must_use]
    pub fn sheet(self) -> Option<&'static Sheet> {
        match self {
            Self::Sheet(place) => SHEETS.get(usize::from(place)),
            Self::Beta { .. } => None,
        }
    }

    /// The greatest C, which has 9 bits in a record.
    pub const MOST_CUBIC: u16 = 511;

    /// The number of an NTC without a data sheet and without C.
    const BETA: i64 = 0xFF;
    /// Bits of the number of a kind, and of the Ohm of an NTC above them, in a record.
    const KIND_BITS: u32 = 8;
    const OHM_BITS: u32 = 21;

    /// The number of an NTC with C. Above it are 18 bits of Ohm / 8, 12 bits of B above the least one, and C: records
    /// have no room for more than 47 bits.
    const BENT: i64 = 0xFE;
    const BELOW_BETA: u32 = 26;
    const BELOW_CUBIC: u32 = 38;
    const LEAST_BETA: i64 = ranges::BETA.least as i64;
}

impl Number for Thermistor {
    /// The number of a kind; of any other NTC 255, its Ohm and its B, or 254, its Ohm, its B and its C.
    fn value(&self) -> Option<i64> {
        Some(match *self {
            Self::Sheet(place) => place.into(),
            Self::Beta { ohms, beta, cubic: 0 } => {
                let ohms = i64::from(ohms) << Self::KIND_BITS;
                i64::from(beta) << (Self::KIND_BITS + Self::OHM_BITS) | ohms | Self::BETA
            }
            Self::Beta { ohms, beta, cubic } => {
                let beta = (i64::from(beta) - Self::LEAST_BETA) << Self::BELOW_BETA;
                i64::from(cubic) << Self::BELOW_CUBIC | beta | i64::from(ohms >> 3) << Self::KIND_BITS | Self::BENT
            }
        })
    }

    fn put(&mut self, number: i64) -> bool {
        let kind = number & 0xFF;
        // Any bits give some NTC; `Settings::check` has its ranges.
        if kind == Self::BETA {
            let ohms = (number >> Self::KIND_BITS) & ((1 << Self::OHM_BITS) - 1);
            let beta = (number >> (Self::KIND_BITS + Self::OHM_BITS)) & 0xFFFF;
            *self = Self::Beta { ohms: ohms as u32, beta: beta as u16, cubic: 0 };
            return true;
        }
        if kind == Self::BENT {
            // The bits above the Ohm's are those of B.
            let ohms = (number >> Self::KIND_BITS << 3) & 0x1F_FFFF;
            let beta = (number >> Self::BELOW_BETA & 0xFFF) + Self::LEAST_BETA;
            let cubic = (number >> Self::BELOW_CUBIC) as u16 & Self::MOST_CUBIC;
            *self = Self::Beta { ohms: ohms as u32, beta: beta as u16, cubic };
            return true;
        }
        let place = u8::try_from(number).ok().filter(|place| usize::from(*place) < SHEETS.len());
        // A kind of later firmware: the record is not taken.
        let Some(place) = place else { return false };
        *self = Self::Sheet(place);
        true
    }
}
