//! Bounds: the possible models of a heater of a kind, by its power. A result of M303 outside of them is discarded; M306
//! refuses it, and `config check` warns of it ([`Plausible`](super::Plausible)).
//!
//! | | power, W | K/s at full power, in an insulated room | lags, s | K above the room at full power |
//! |---|---|---|---|---|
//! | hotend | 5 to 200 | 0.6 (25 W, 34 J/K: 0.74) to 40 (100 W, 3 J/K: 33) | 0.2 to 60 | 100 to 4000 |
//! | bed | 10 to 2000 | 0.02 (220 W, 5500 J/K: 0.04) to 5 | 1 to 240 | 10 to 1000 |
//! | chamber | 10 to 2000 | 0.005 (300 W, 20,000 J/K: 0.015) to 2 | 2 to 240 | 5 to 1000 |
//!
//! Losses of a hotend in a sock of silicone are 0.05 W/K (Marlin's default for MPC: 0.068), of a plate 2 to 10 W/K.
//!
//! The slowest are some two thirds of real ones: an owner may have given the power of a supply of 24 V that has 20.

use crate::connectors::Heater;
use crate::settings::Range;
use crate::units::{JoulesPerKelvin, Ratio, Seconds, Watts};

/// The bounds of a kind of heater.
#[derive(Debug)]
pub struct Bounds {
    /// K/s at full power without losses.
    rate: [Ratio; 2],
    /// From the heater to the sensor.
    pub lag: Range<Seconds>,
    /// W.
    pub power: [u16; 2],
    /// K above the room that full power keeps.
    pub above_room: [u16; 2],
}

impl Bounds {
    /// The bounds of a heater.
    #[must_use]
    pub const fn of(heater: Heater) -> &'static Self {
        /// Blocks of 3 to 60 J/K with 25 to 120 W.
        const HOTEND: Bounds = Bounds {
            rate: [Ratio::lit("0.6"), Ratio::lit("40")],
            lag: Range { least: Seconds::lit("0.2"), most: Seconds::lit("60") },
            power: [5, 200],
            above_room: [100, 4000],
        };
        /// Plates of 100 to 10,000 J/K with 50 to 2,000 W.
        const BED: Bounds = Bounds {
            rate: [Ratio::lit("0.02"), Ratio::lit("5")],
            lag: Range { least: Seconds::lit("1"), most: Seconds::lit("240") },
            power: [10, 2000],
            above_room: [10, 1000],
        };
        /// Air and walls.
        const CHAMBER: Bounds = Bounds {
            rate: [Ratio::lit("0.005"), Ratio::lit("2")],
            lag: Range { least: Seconds::lit("2"), most: Seconds::lit("240") },
            power: [10, 2000],
            above_room: [5, 1000],
        };
        match heater {
            Heater::Hotend => &HOTEND,
            Heater::Bed => &BED,
            Heater::Chamber => &CHAMBER,
        }
    }

    /// The heat capacities that a heater of this power can have.
    #[must_use]
    pub fn capacity(&self, power: Watts) -> Range<JoulesPerKelvin> {
        let [slowest, quickest] = self.rate.map(|rate| u64::from(rate.to_bits()).max(1));
        let of = |rate: u64| {
            let bits = (u64::from(power.to_bits()) << JoulesPerKelvin::FRAC_NBITS) / rate;
            JoulesPerKelvin::from_bits(u32::try_from(bits).unwrap_or(u32::MAX))
        };
        Range { least: of(quickest), most: of(slowest) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_heaters_are_within_and_nonsense_is_not() {
        let is_one = |heater, watt: u32, joule: u32| {
            let range = Bounds::of(heater).capacity(Watts::from_num(watt));
            (range.least..=range.most).contains(&JoulesPerKelvin::from_num(joule))
        };
        assert!(is_one(Heater::Hotend, 25, 34) && is_one(Heater::Hotend, 40, 11) && is_one(Heater::Hotend, 100, 6));
        assert!(!is_one(Heater::Hotend, 40, 130), "what a tuning from 215 C gave for 10.8 J/K");
        assert!(is_one(Heater::Bed, 220, 5500) && is_one(Heater::Bed, 500, 1700) && is_one(Heater::Bed, 1500, 5500));
        assert!(!is_one(Heater::Bed, 500, 50) && !is_one(Heater::Bed, 220, 20_000));
        assert!(is_one(Heater::Chamber, 300, 6000) && is_one(Heater::Chamber, 300, 20_000));
    }
}
