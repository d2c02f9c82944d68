//! The cycle of a fan's modulation, as numbers for a timer of 16 bits.

/// Prescaler and last count of a timer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cycle {
    /// The prescaler's register: one less than its factor.
    pub prescaler: u16,
    /// The last count: one less than the counts of a cycle.
    pub last: u16,
}

/// Counts of a cycle at most: one less than the timer can count, so that a compare value beyond the last count fits.
const MOST_COUNTS: u32 = u16::MAX as u32;

impl Cycle {
    /// The cycle for `hz` of a timer at `mhz`; 0 is 98 Hz.
    #[must_use]
    pub const fn of(mhz: u32, hz: u16) -> Self {
        if hz == 0 {
            // 180 MHz over 28 and 90 MHz over 14, and both over 65,535 counts.
            return Self { prescaler: (mhz * 7 / 45 - 1) as u16, last: u16::MAX - 1 };
        }
        let counts = mhz * 1_000_000 / hz as u32;
        let factor = counts.div_ceil(MOST_COUNTS);
        Self { prescaler: (factor - 1) as u16, last: (counts / factor - 1) as u16 }
    }
}

/// The compare value for a duty of 65,535, which is beyond the last count, so that the output stays on without a gap
/// (RM0390, PWM mode 1).
#[must_use]
pub const fn compare(duty: u16, last: u16) -> u16 {
    let counts = last as u32 + 1;
    ((duty as u32 * counts + MOST_COUNTS / 2) / MOST_COUNTS) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rate of a cycle in Hz.
    fn rate(mhz: u32, cycle: Cycle) -> f64 {
        f64::from(mhz) * 1e6 / (f64::from(cycle.prescaler) + 1.0) / (f64::from(cycle.last) + 1.0)
    }

    #[test]
    fn without_a_frequency_it_is_98_hz_in_steps_of_a_duty() {
        assert_eq!(Cycle::of(180, 0), Cycle { prescaler: 27, last: 65_534 });
        assert_eq!(Cycle::of(90, 0), Cycle { prescaler: 13, last: 65_534 });
        assert!([180, 90].iter().all(|mhz| (rate(*mhz, Cycle::of(*mhz, 0)) - 98.1).abs() < 0.1));
        assert!((0..=u16::MAX).all(|duty| compare(duty, 65_534) == duty));
    }

    #[test]
    fn any_frequency_is_met_within_a_thousandth() {
        for mhz in [90, 180] {
            for hz in 10..=50_000 {
                let cycle = Cycle::of(mhz, hz);
                assert!((rate(mhz, cycle) / f64::from(hz) - 1.0).abs() < 1e-3, "{hz} Hz at {mhz} MHz: {cycle:?}");
                assert!(cycle.last < u16::MAX);
            }
        }
        // Steps of a duty of 255 and finer, at the highest.
        assert_eq!(Cycle::of(90, 50_000), Cycle { prescaler: 0, last: 1799 });
        assert_eq!(Cycle::of(180, 10).prescaler, 274);
    }

    #[test]
    fn off_is_off_and_full_is_on_without_a_gap() {
        for hz in [0, 10, 98, 25_000, 50_000] {
            let last = Cycle::of(90, hz).last;
            assert_eq!((compare(0, last), u32::from(compare(u16::MAX, last))), (0, u32::from(last) + 1), "{hz}");
            let half = f64::from(compare(0x8000, last)) / (f64::from(last) + 1.0);
            assert!((half - 0.5).abs() < 1e-3, "{hz}: {half}");
        }
    }
}
