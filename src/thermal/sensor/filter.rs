//! The filter: a loose contact or a spark is not a temperature. Impossible readings are skipped, and too many of them
//! are a fault.

use super::curve::Reading;
use crate::fault::Cause;
use crate::units::Celsius;

/// The verdict on a reading.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Contact {
    /// A temperature.
    Good(Celsius),
    /// Not reliable: it must never raise the power.
    Doubtful,
    /// The sensor is broken.
    Broken(Cause),
}

/// Doubtful readings in a row that are a fault: 0.4 s. A connector that is bumped loses contact for up to 0.3 s.
const MOST_IN_A_ROW: u16 = 20;

/// Weight of a doubtful reading against good ones: one in twenty may be doubtful for ever.
const WEIGHT: u16 = 20;

/// Weight of doubtful readings that means a loose contact: 30 together.
const LOOSE: u16 = 600;

/// Greatest possible change in a control period of 20 ms: 150 K/s. (A block of 10 J/K would need 1500 W.) A contact
/// that opens within a sample shows a greater jump.
const JUMP: Celsius = Celsius::const_from_int(3);

/// Greatest change per period of a gap: 25 K/s, six times the effect of 60 W on a hotend.
const GAP: Celsius = Celsius::lit("0.5");

/// The filter of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Filter {
    last: Option<Celsius>,
    /// Doubtful readings since the last good one.
    in_a_row: u16,
    /// Weight of doubtful readings, minus one for each good one.
    weight: u16,
}

impl Filter {
    /// No reading yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: None, in_a_row: 0, weight: 0 }
    }

    /// Takes a reading; called once in a control period.
    pub fn take(&mut self, reading: Reading) -> Contact {
        let cause = match reading {
            // The longer the gap, the more the temperature may have changed.
            Reading::Celsius(celsius) if self.is_near(celsius) => {
                (self.last, self.in_a_row) = (Some(celsius), 0);
                self.weight = self.weight.saturating_sub(1);
                return Contact::Good(celsius);
            }
            Reading::Celsius(_) => Cause::SensorFlickers,
            Reading::Open => Cause::SensorOpen,
            Reading::Short => Cause::SensorShort,
            Reading::Silent => Cause::ConverterStopped,
        };
        self.in_a_row = self.in_a_row.saturating_add(1);
        self.weight = self.weight.saturating_add(WEIGHT);
        if self.in_a_row >= MOST_IN_A_ROW {
            Contact::Broken(cause)
        } else if self.weight >= LOOSE {
            Contact::Broken(Cause::SensorFlickers)
        } else {
            Contact::Doubtful
        }
    }

    fn is_near(&self, celsius: Celsius) -> bool {
        let most = JUMP.saturating_add(GAP.saturating_mul_int(self.in_a_row.into()));
        self.last.is_none_or(|last| last.saturating_sub(celsius).saturating_abs() <= most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WARM: Reading = Reading::Celsius(Celsius::const_from_int(200));

    /// The fault within a minute, if any, of a contact that is open for `open` of `period` readings.
    fn after_a_minute(open: usize, period: usize) -> Option<(usize, Cause)> {
        let mut filter = Filter::new();
        (0..3000).find_map(|n| {
            let reading = if n % period >= period - open { Reading::Open } else { WARM };
            match filter.take(reading) {
                Contact::Broken(cause) => Some((n, cause)),
                Contact::Good(_) | Contact::Doubtful => None,
            }
        })
    }

    #[test]
    fn an_open_sensor_is_found_within_half_a_second() {
        let mut filter = Filter::new();
        assert_eq!(filter.take(WARM), Contact::Good(Celsius::const_from_int(200)));
        for _ in 1..MOST_IN_A_ROW {
            assert_eq!(filter.take(Reading::Open), Contact::Doubtful);
        }
        assert_eq!(filter.take(Reading::Open), Contact::Broken(Cause::SensorOpen));
        for (reading, cause) in [(Reading::Short, Cause::SensorShort), (Reading::Silent, Cause::ConverterStopped)] {
            let mut filter = Filter::new();
            let last = (0..MOST_IN_A_ROW).map(|_| filter.take(reading)).last();
            assert_eq!(last, Some(Contact::Broken(cause)));
        }
        const { assert!(MOST_IN_A_ROW * 20 <= 500) };
    }

    #[test]
    fn a_bump_is_no_fault_and_a_loose_contact_is_one() {
        assert_eq!(after_a_minute(15, 500), None, "0.3 s every 10 s");
        assert_eq!(after_a_minute(1, 30), None, "a spark now and then");
        assert!(matches!(after_a_minute(15, 50), Some((0..250, Cause::SensorFlickers))), "0.3 s every second");
        assert!(matches!(after_a_minute(3, 5), Some((0..100, Cause::SensorFlickers))), "ten times a second");
    }

    #[test]
    fn a_jump_is_not_believed() {
        let mut filter = Filter::new();
        let _ = filter.take(WARM);
        let cold = Reading::Celsius(Celsius::const_from_int(100));
        assert_eq!(filter.take(cold), Contact::Doubtful);
        assert_eq!(filter.take(WARM), Contact::Good(Celsius::const_from_int(200)));
        let last = (0..MOST_IN_A_ROW).map(|_| filter.take(cold)).last();
        assert_eq!(last, Some(Contact::Broken(Cause::SensorFlickers)));
    }
}
