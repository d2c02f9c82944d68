//! What a heater has shown of its heat while it held a target.

use crate::connectors::Heater;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Heaters that show figures; a chamber shows none.
pub const WITH_FIGURES: [Heater; 2] = [Heater::Hotend, Heater::Bed];

/// A model that is off by more cannot be judged by: 0.6 to 1.7.
const PLAUSIBLE: core::ops::RangeInclusive<u16> = 154..=435;

/// Ratios with 8 fractional bits; 0 is not known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeatFigures {
    /// It takes so many times the power of its baseline, or of its model without one.
    pub power: u16,
    /// Its reading moves so many times less.
    pub less: u16,
    /// A baseline is known.
    pub has_baseline: bool,
    /// Both are so great that the user is told.
    pub is_low: bool,
    /// Both as the first hour has shown them, until they are known as the baseline.
    pub learned: [u16; 2],
}

impl HeatFigures {
    /// Nothing shown.
    pub const NONE: Self = Self { power: 0, less: 0, has_baseline: false, is_low: false, learned: [0; 2] };

    /// Whether both figures are known.
    #[must_use]
    pub const fn are_known(&self) -> bool {
        self.power > 0 && self.less > 0
    }

    /// Whether the first hour has shown figures that no right model has.
    #[must_use]
    pub fn is_far_off(&self) -> bool {
        self.learned != [0; 2] && !self.learned.into_iter().all(|figure| PLAUSIBLE.contains(&figure))
    }

    /// Whether the first hour has shown figures that can be a baseline.
    #[must_use]
    pub fn has_learned(&self) -> bool {
        self.learned != [0; 2] && !self.is_far_off()
    }

    /// The lesser of both: how many times too low the sensor reads, if it does.
    #[must_use]
    pub fn low(&self) -> u16 {
        self.power.min(self.less)
    }
}

/// Figures of a heater. Written by the thermal context.
pub(super) struct Place([AtomicU32; 3]);

/// The flags.
const BASELINE: u32 = 1;
const LOW: u32 = 1 << 1;

impl Place {
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; 3])
    }

    pub fn load(&self) -> HeatFigures {
        let [figures, flags, learned] = self.0.each_ref().map(|word| word.load(Relaxed));
        HeatFigures {
            power: figures as u16,
            less: (figures >> 16) as u16,
            has_baseline: flags & BASELINE != 0,
            is_low: flags & LOW != 0,
            learned: [learned as u16, (learned >> 16) as u16],
        }
    }

    pub fn store(&self, figures: HeatFigures) {
        let HeatFigures { power, less, has_baseline, is_low, learned: [a, b] } = figures;
        let [place, flags, learned] = &self.0;
        let bit = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        place.store(u32::from(power) | u32::from(less) << 16, Relaxed);
        flags.store(bit(has_baseline, BASELINE) | bit(is_low, LOW), Relaxed);
        learned.store(u32::from(a) | u32::from(b) << 16, Relaxed);
    }
}
