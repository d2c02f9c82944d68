//! Shapers: those of this firmware, and Klipper's with three humps, which this firmware does not have.
//!
//! The firmware's come from `corehbot_twin::shaping`. The one with three humps is Singhose, Seering and Singer's (1996)
//! in the fit over the damping that Klipper uses, `shaper_defs.py`.

use corehbot_twin::shaping::shaper::{self, Impulse, ShaperKind};
use serde::Serialize;

/// A shaper that is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shaper {
    /// One of this firmware.
    Own(ShaperKind),
    /// Extra insensitive with three humps.
    ThreeHumpEi,
}

impl Shaper {
    /// All of them, the shortest first: Klipper tries them in this order.
    pub const ALL: [Self; 6] = [
        Self::Own(ShaperKind::Zv),
        Self::Own(ShaperKind::Mzv),
        Self::Own(ShaperKind::Zvd),
        Self::Own(ShaperKind::Ei),
        Self::Own(ShaperKind::TwoHumpEi),
        Self::ThreeHumpEi,
    ];

    /// Its usual name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Own(kind) => kind.name(),
            Self::ThreeHumpEi => "3HUMP_EI",
        }
    }

    /// Whether this firmware has it.
    #[must_use]
    pub const fn in_firmware(self) -> bool {
        matches!(self, Self::Own(_))
    }

    /// Whether Klipper chooses among it. Klipper has ZVD, but never suggests it.
    #[must_use]
    pub const fn in_klippers_choice(self) -> bool {
        !matches!(self, Self::Own(ShaperKind::Zvd))
    }

    /// Its parts.
    #[must_use]
    pub fn impulses(self, frequency_hz: f64, damping: f64) -> Vec<Impulse> {
        match self {
            Self::Own(kind) => shaper::impulses(kind, frequency_hz, damping),
            Self::ThreeHumpEi => three_hump(frequency_hz, damping),
        }
    }
}

impl Serialize for Shaper {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.name())
    }
}

/// Times in undamped periods.
fn three_hump(frequency_hz: f64, z: f64) -> Vec<Impulse> {
    let cubic = |[a, b, c, d]: [f64; 4]| a + z * (b + z * (c + z * d));
    let parts = [
        ([0.11275, 0.76632, 3.2916, -1.4438], [0.0; 4]),
        ([0.23698, 0.61164, -2.5785, 4.8522], [0.49974, 0.23834, 0.44559, 12.472]),
        ([0.30008, -0.19062, -2.1456, 0.13744], [0.99849, 0.29808, -2.3646, 23.399]),
        ([0.23775, -0.73297, 0.46885, -2.0865], [1.4987, 0.10306, -2.0139, 17.032]),
        ([0.11244, -0.45439, 0.96382, -1.46], [1.9996, -0.28231, 0.61536, 5.4045]),
    ]
    .map(|(amount, time)| (cubic(amount), cubic(time)));
    let sum: f64 = parts.iter().map(|(amount, _)| amount).sum();
    parts.map(|(amount, time)| Impulse { amount: amount / sum, time_s: time / frequency_hz }).into()
}
