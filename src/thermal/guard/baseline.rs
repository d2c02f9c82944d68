//! What a heater takes and moves when it is healthy: the medians of its first hour of holds after a tuning.
//!
//! A model is never quite right, so each heater is compared with itself. What was learned never adapts: a fault that
//! comes slowly would be learned too. It counts once the Console has stored it and tells it back; until then, and
//! without storage, the model itself is the baseline.

use super::response::{BITS, Ratio8};
use crate::connectors::Heater;
use crate::settings::{HeaterSettings, sum};

/// A median moves by this much at each look, first and later.
const STEPS: [Ratio8; 2] = [8, 2];
const FIRST: u8 = 16;

/// 1.
const ONE: Ratio8 = 1 << BITS;

/// The sum of all that a baseline is learned with: the heater's model and its power.
#[must_use]
pub fn baseline_subject(settings: &HeaterSettings) -> u32 {
    sum(&(settings.model, settings.power, settings.max_duty, settings.thermistor))
}

/// Whether a model is not the one that any heater of its kind begins with.
#[must_use]
pub fn has_own_model(heater: Heater, settings: &HeaterSettings) -> bool {
    let any = match heater {
        Heater::Hotend => HeaterSettings::hotend(settings.output, settings.sensor),
        Heater::Bed => HeaterSettings::bed(settings.output, settings.sensor),
        Heater::Chamber => HeaterSettings::chamber(settings.output, settings.sensor),
    };
    settings.model != any.model
}

/// The baseline of a heater: of its power, and of how much less it moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Baseline {
    /// What counts; 0 is nothing yet.
    known: [Ratio8; 2],
    medians: [Ratio8; 2],
    looks: u8,
}

impl Baseline {
    /// Nothing learned.
    #[must_use]
    pub const fn new() -> Self {
        Self { known: [0; 2], medians: [0; 2], looks: 0 }
    }

    /// One that was stored; zeros begin to learn it.
    #[must_use]
    pub const fn stored(known: [Ratio8; 2]) -> Self {
        Self { known, ..Self::new() }
    }

    /// Whether one is known.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.known != [0; 2]
    }

    /// Learns from a cycle; an hour has so many.
    pub fn learn(&mut self, figures: [Ratio8; 2], hour: u8) {
        if self.is_known() || self.looks >= hour {
            return;
        }
        let step = STEPS[usize::from(self.looks >= FIRST)];
        for (median, figure) in self.medians.iter_mut().zip(figures) {
            *median = match *median {
                0 => figure,
                at if figure > at => at + step.min(figure - at),
                at => at - step.min(at - figure),
            };
        }
        self.looks += 1;
    }

    /// What was learned in an hour, if it is not known yet.
    #[must_use]
    pub fn learned(&self, hour: u8) -> Option<[Ratio8; 2]> {
        (!self.is_known() && self.looks >= hour).then_some(self.medians)
    }

    /// Figures over the baseline.
    #[must_use]
    pub fn compare(&self, figures: [Ratio8; 3]) -> [Ratio8; 3] {
        let [power, less] = self.known.map(|known| if known == 0 { ONE } else { known });
        let [a, b, c] = figures;
        [(a, power), (b, less), (c, less)].map(|(figure, base)| {
            Ratio8::try_from((u32::from(figure) << BITS) / u32::from(base)).unwrap_or(Ratio8::MAX)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_hour_is_learned_and_never_adapts() {
        let mut baseline = Baseline::new();
        for n in 0..225_u16 {
            assert_eq!(baseline.learned(225), None);
            // Every fourth is far off.
            let off = if n % 4 == 0 { 200 } else { n % 8 };
            baseline.learn([300 + off, 200 + off], 225);
        }
        let learned = baseline.learned(225).unwrap();
        assert!(learned[0].abs_diff(304) < 8 && learned[1].abs_diff(204) < 8, "{learned:?}");
        (0..500).for_each(|_| baseline.learn([600; 2], 225));
        assert_eq!(baseline.learned(225), Some(learned));
        let mut known = Baseline::stored(learned);
        (0..500).for_each(|_| known.learn([600; 2], 225));
        assert_eq!(known.learned(225), None);
        let [power, less, quick] = known.compare([learned[0], 2 * learned[1], 0]);
        assert_eq!((power, less, quick), (ONE, 2 * ONE, 0));
        assert_eq!(Baseline::new().compare([300, 200, 100]), [300, 200, 100]);
    }
}
