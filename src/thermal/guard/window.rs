//! Readings that no working machine has.
//!
//! | reading | heater | reaction |
//! |---|---|---|
//! | beyond either end from the first one on | had no power yet | refused: it does not heat, and nothing else stops |
//! | too cold | off | refused |
//! | too cold | on | fault |
//! | too hot, after one within the window | on or off | fault: its switch may be stuck |
//!
//! A refusal begins with the first such reading, and ends with [`MOST`] readings within the window in a row. The window
//! has been seen from then on. So another kind of sensor than set, or a winter night, never halts the machine: a halted
//! machine would refuse the settings that mend it.

use super::Alarm;
use crate::fault::Cause;
use crate::units::Celsius;

/// No printer is colder. An NTC of 100 kOhm has 630 kOhm there, which differs clearly from an open one. So a cold
/// garage is not a fault, as it is with limits of 0 or 5 C.
pub const LEAST: Celsius = Celsius::const_from_int(-15);

/// Periods outside the window that are a fault, and periods inside of it that end a refusal: 0.2 s, so that noise at
/// its edge is neither.
const MOST: u8 = 10;

/// The guard of a sensor's window.
#[derive(Clone, Copy, Debug, Default)]
pub struct Window {
    /// A reading within the window has been seen.
    is_seen: bool,
    /// Why it must not heat.
    refused: Option<Cause>,
    /// Periods outside the window in a row, or periods inside of it that a refusal still needs.
    periods: u8,
}

impl Window {
    /// Nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { is_seen: false, refused: None, periods: 0 }
    }

    /// Whether a reading within the window has been seen.
    #[must_use]
    pub const fn is_seen(&self) -> bool {
        self.is_seen
    }

    /// Follows a reading of a heater that may not be hotter than `most`. Returns why it must not heat, if so.
    ///
    /// # Errors
    /// The reading is a fault.
    pub fn look(&mut self, most: Celsius, measured: Celsius, is_off: bool) -> Result<Option<Cause>, Alarm> {
        let (cause, limit) = if measured > most { (Cause::TooHot, most) } else { (Cause::TooCold, LEAST) };
        let is_inside = LEAST <= measured && measured <= most;
        if is_inside {
            // A refusal ends after as many readings inside as a fault needs outside.
            let is_over = self.refused.is_none() || self.periods <= 1;
            self.periods = if is_over { 0 } else { self.periods - 1 };
            self.refused = self.refused.filter(|_| !is_over);
            self.is_seen |= is_over;
        } else if !self.is_seen || is_off && cause == Cause::TooCold {
            (self.refused, self.periods) = (Some(cause), MOST);
        } else {
            // It was counting readings inside until now, and begins with those outside.
            self.periods = if self.refused.take().is_some() { 1 } else { self.periods.saturating_add(1) };
            if self.periods >= MOST {
                return Err(Alarm { cause, value: measured, limit });
            }
        }
        Ok(self.refused)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn c(degrees: i32) -> Celsius {
        Celsius::from_num(degrees)
    }

    /// A window that has seen a reading of a room.
    fn seen() -> Window {
        let mut window = Window::new();
        assert_eq!(window.look(c(300), c(25), true), Ok(None));
        window
    }

    #[test]
    fn what_stays_beyond_is_a_fault_within_a_fifth_of_a_second() {
        for (measured, cause, is_off) in
            [(301, Cause::TooHot, false), (301, Cause::TooHot, true), (-16, Cause::TooCold, false)]
        {
            let mut window = seen();
            let found =
                (1..).find_map(|n| window.look(c(300), c(measured), is_off).err().map(|alarm| (n, alarm.cause)));
            assert_eq!(found, Some((u32::from(MOST), cause)));
        }
        let mut window = seen();
        for n in 0..1000 {
            let edge = window.look(c(300), c(if n % 2 == 0 { 299 } else { 305 }), false);
            assert_eq!(edge, Ok(None), "noise at the edge");
        }
    }

    /// Reproducer: another kind of sensor than set, and a cold room, halted the machine at each start.
    #[test]
    fn what_is_beyond_from_the_first_reading_on_is_refused_until_it_is_inside_for_a_fifth_of_a_second() {
        for (measured, cause) in [(301, Cause::TooHot), (-16, Cause::TooCold)] {
            let mut window = Window::new();
            assert!((0..1000).all(|_| window.look(c(300), c(measured), true) == Ok(Some(cause))));
            let edge = |n: i32| if n % 9 == 0 { measured } else { 20 };
            assert!((0..1000).all(|n| window.look(c(300), c(edge(n)), true) == Ok(Some(cause))), "noise at the edge");
            let ended = (1..).find(|_| window.look(c(300), c(20), true) == Ok(None));
            assert_eq!((ended, window.is_seen()), (Some(i32::from(MOST)), true));
            assert!((0..100).any(|_| window.look(c(300), c(301), true).is_err()), "it rises from the window");
        }
    }

    #[test]
    fn a_cold_night_is_refused_while_off_and_a_fault_while_on() {
        let mut window = seen();
        assert_eq!(window.look(c(300), c(-16), true), Ok(Some(Cause::TooCold)));
        assert!((0..9).all(|_| window.look(c(300), c(-16), false).is_ok()));
        assert!(window.look(c(300), c(-16), false).is_err());
    }
}
