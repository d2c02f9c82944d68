//! Switching: a duty as on and off. The board's pulse-width modulation takes any duty each control period; a relay is
//! on or off for whole periods, and no more often than its cycle.

use super::fixed_point::PERIOD_MS;

/// The output of one heater.
#[derive(Clone, Copy, Debug)]
pub struct Switching {
    /// Control periods of a cycle of a relay; 0 is pulse-width modulation.
    cycle: u16,
    /// Remaining periods until the next cycle.
    left: u16,
    /// Periods of this cycle that it is on for.
    on: u16,
    /// Requested and not yet given power, in periods times 65,535.
    owed: u32,
}

impl Switching {
    /// An output that is switched once in so many milliseconds.
    #[must_use]
    pub const fn new(period_ms: u16) -> Self {
        let cycle = (period_ms as u32 / PERIOD_MS) as u16;
        Self { cycle, left: 0, on: 0, owed: 0 }
    }

    /// The output duty for this control period.
    pub fn next(&mut self, duty: u16) -> u16 {
        if duty == 0 {
            // Off takes effect at once; the next cycle does not begin earlier.
            (self.on, self.owed, self.left) = (0, 0, self.left.saturating_sub(1));
            return 0;
        }
        if self.cycle <= 1 {
            return duty;
        }
        if self.left == 0 {
            self.owed += u32::from(duty) * u32::from(self.cycle);
            self.on = (self.owed / 65_535) as u16;
            self.owed -= u32::from(self.on) * 65_535;
            self.left = self.cycle;
        }
        self.left -= 1;
        let is_on = self.on > 0;
        self.on = self.on.saturating_sub(1);
        if is_on { u16::MAX } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relay_gives_what_was_asked_for_and_switches_once_a_cycle() {
        for duty in [1, 300, 6_553, 20_000, 40_001, 65_534, 65_535] {
            let mut output = Switching::new(1000);
            let given: Vec<_> = (0..50_000).map(|_| output.next(duty)).collect();
            let sum: u64 = given.iter().map(|duty| u64::from(*duty)).sum();
            let wanted = 50_000 * u64::from(duty);
            assert!(sum.abs_diff(wanted) <= 65_535 * 50, "{duty}: {sum} for {wanted}");
            assert!(given.iter().all(|duty| [0, u16::MAX].contains(duty)));
            let switched = given.windows(2).filter(|pair| pair[0] == 0 && pair[1] > 0).count();
            assert!(switched <= 1000, "{duty}");
        }
    }

    #[test]
    fn off_is_off_at_once_and_a_board_modulates_by_itself() {
        let mut relay = Switching::new(1000);
        assert_eq!(relay.next(50_000), u16::MAX);
        assert_eq!(relay.next(0), 0);
        assert_eq!(Switching::new(0).next(1234), 1234);
        assert_eq!(Switching::new(20).next(1234), 1234);
    }

    extern crate std;
    use std::vec::Vec;
}
