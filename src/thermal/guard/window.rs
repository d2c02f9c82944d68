//! Readings that no working machine has.

use super::Alarm;
use crate::fault::Cause;
use crate::units::Celsius;

/// No printer is colder. An NTC of 100 kOhm has 630 kOhm there, which differs clearly from an open one. So a cold
/// garage is not a fault, as it is with limits of 0 or 5 C.
pub const LEAST: Celsius = Celsius::const_from_int(-15);

/// Periods outside the window that are a fault: 0.2 s, so that noise at its edge is not.
const MOST: u8 = 10;

/// The guard of a sensor's window.
#[derive(Clone, Copy, Debug, Default)]
pub struct Window {
    beyond: u8,
}

impl Window {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { beyond: 0 }
    }

    /// Follows a reading of a heater that may not be hotter than `most`.
    pub fn look(&mut self, most: Celsius, measured: Celsius) -> Option<Alarm> {
        let is_inside = LEAST <= measured && measured <= most;
        self.beyond = if is_inside { 0 } else { self.beyond.saturating_add(1) };
        let (cause, limit) = if measured > most { (Cause::TooHot, most) } else { (Cause::TooCold, LEAST) };
        (self.beyond >= MOST).then_some(Alarm { cause, value: measured, limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stays_beyond_is_a_fault_within_a_fifth_of_a_second() {
        let c = |degrees: i32| Celsius::from_num(degrees);
        for (measured, cause) in [(301, Cause::TooHot), (-16, Cause::TooCold)] {
            let mut window = Window::new();
            let found = (1..).find_map(|n| window.look(c(300), c(measured)).map(|alarm| (n, alarm.cause)));
            assert_eq!(found, Some((u32::from(MOST), cause)));
        }
        let mut window = Window::new();
        for n in 0..1000 {
            assert_eq!(window.look(c(300), c(if n % 2 == 0 { 299 } else { 305 })), None, "noise at the edge");
        }
    }
}
