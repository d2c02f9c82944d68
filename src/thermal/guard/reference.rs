//! The converter's internal reference shows whether its supply is right, and whether its channels come in order. A
//! wrong order would put a thermistor's reading into its slot.

use super::Alarm;
use crate::fault::Cause;
use crate::units::Celsius;

/// 1.21 V of 3.3 V (STM32F446 datasheet, V_REFINT: 1.18 to 1.24 V), in 1/65,536.
const NOMINAL: u16 = 24_030;

/// Permitted deviation: 2.5 % of the reference, and 3.0 to 3.6 V of supply. Thermistor readings are relative to the
/// same supply, so they stay right.
const TOLERANCE: u16 = 2_900;

/// Periods beyond it that are a fault: 0.2 s.
const MOST: u8 = 10;

/// The guard of the reference.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reference {
    beyond: u8,
}

impl Reference {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { beyond: 0 }
    }

    /// Follows a control period.
    pub fn look(&mut self, sample: u16) -> Option<Alarm> {
        let is_right = sample.abs_diff(NOMINAL) <= TOLERANCE;
        self.beyond = if is_right { 0 } else { self.beyond.saturating_add(1) };
        let [value, limit] = [sample, NOMINAL].map(|part| Celsius::from_bits(part.into()));
        (self.beyond >= MOST).then_some(Alarm { cause: Cause::Reference, value, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_reference_and_a_slipped_channel_are_found() {
        let finds = |sample| {
            let mut guard = Reference::new();
            (0..MOST).filter_map(|_| guard.look(sample)).count() == 1
        };
        assert!(finds(62_594), "a cold thermistor's reading in its slot");
        assert!(finds(1_500), "a hot one's");
        assert!(finds(NOMINAL + 3_000), "2.9 V");
        assert!(!finds(NOMINAL) && !finds(26_434), "3.0 V");
    }
}
