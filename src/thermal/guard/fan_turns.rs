//! Fan turns: how fast a fan with a tachometer turns, and whether it stands still though it is driven.
//!
//! A standing fan of a hotend is a fault, because the cold end then melts what it holds. Any other is reported (M123,
//! M122), and the print goes on: a print without its part fan is spoilt at most, and drivers watch their own heat.
//!
//! The pulses are counted over windows of 2 s. A fan of a 3D printer gives two a turn and makes some 1000 turns a
//! minute at its slowest. So one turn in a window is far below any working fan. (4-wire fans: Intel, "4-Wire Pulse
//! Width Modulation Controlled Fans", rev 1.3, sections 3.1 and 3.2: two pulses a turn, standing below 30 % duty is
//! legal.)

use super::{Alarm, periods};
use crate::fault::Cause;
use crate::units::Celsius;

/// A window, in control periods.
const WINDOW: u32 = periods(2);

/// Pulses in a window: one turn.
const LEAST: u16 = 2;

/// Below a third of full duty a fan may stop.
const DRIVEN: u16 = u16::MAX / 3;

/// Windows in a row without a turn: in the first one after it is switched on, the fan may still be starting.
const MOST_STILL: u8 = 2;

/// The guard of one fan.
#[derive(Clone, Copy, Debug, Default)]
pub struct FanTurns {
    /// The pulse count at the begin of the window.
    before: u16,
    elapsed: u32,
    still: u8,
    /// The same of the windows that go on while the fan is off, and the pulses in the last one.
    measured: (u16, u32),
    pulses: u16,
}

/// Turns a minute, from the pulses in a window and those in a turn.
#[must_use]
pub fn turns_a_minute(pulses: u16, in_a_turn: u8) -> u32 {
    u32::from(pulses) * (60 * periods(1) / WINDOW) / u32::from(in_a_turn.max(1))
}

impl FanTurns {
    /// A fan that was not driven yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { before: 0, elapsed: 0, still: 0, measured: (0, 0), pulses: 0 }
    }

    /// The pulses in the last window that is over.
    #[must_use]
    pub const fn pulses(&self) -> u16 {
        self.pulses
    }

    /// Whether it stands still though it is driven.
    #[must_use]
    pub const fn is_still(&self) -> bool {
        self.still >= MOST_STILL
    }

    /// One control period: the duty of 65,535, and the tachometer's count of pulses, wrapping.
    pub fn look(&mut self, duty: u16, pulses: u16) -> Option<Alarm> {
        self.measure(pulses);
        if duty < DRIVEN {
            (self.before, self.elapsed, self.still) = (pulses, 0, 0);
            return None;
        }
        self.elapsed += 1;
        if self.elapsed < WINDOW {
            return None;
        }
        let stands = pulses.wrapping_sub(self.before) < LEAST;
        (self.before, self.elapsed) = (pulses, 0);
        self.still = if stands { self.still.saturating_add(1) } else { 0 };
        let alarm = Alarm { cause: Cause::FanFailed, value: Celsius::ZERO, limit: Celsius::ZERO };
        self.is_still().then_some(alarm)
    }

    fn measure(&mut self, pulses: u16) {
        let (before, elapsed) = self.measured;
        self.measured = if elapsed + 1 < WINDOW {
            (before, elapsed + 1)
        } else {
            self.pulses = pulses.wrapping_sub(before);
            (pulses, 0)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The s until an alarm, of a fan with these pulses a second.
    fn alarm_after(fan: &mut FanTurns, duty: u16, mut count: u16, pulses_per_s: u16) -> Option<u32> {
        (1..periods(60)).find_map(|period| {
            count = count.wrapping_add(if period % periods(1) == 0 { pulses_per_s } else { 0 });
            fan.look(duty, count).map(|_| period / periods(1))
        })
    }

    #[test]
    fn a_driven_fan_that_stands_still_is_found_in_4_s() {
        assert_eq!(alarm_after(&mut FanTurns::new(), u16::MAX, 0, 0), Some(4));
        assert_eq!(alarm_after(&mut FanTurns::new(), u16::MAX, u16::MAX, 1), None, "two pulses in 2 s are a turn");
        assert_eq!(alarm_after(&mut FanTurns::new(), DRIVEN, 0, 0), Some(4));
        assert_eq!(alarm_after(&mut FanTurns::new(), DRIVEN - 1, 0, 0), None);
    }

    #[test]
    fn turns_are_measured_at_any_duty() {
        for duty in [0, u16::MAX] {
            let mut fan = FanTurns::new();
            // 3000 turns a minute, two pulses each, are two in a period; the count wraps.
            let count = |period: u32| (u16::MAX - 60).wrapping_add(2 * period as u16);
            (0..=periods(4)).for_each(|period| assert_eq!(fan.look(duty, count(period)), None));
            assert_eq!((fan.pulses(), turns_a_minute(fan.pulses(), 2)), (200, 3000));
            // It stops.
            (0..periods(4)).for_each(|_| _ = fan.look(duty, 7));
            assert_eq!(fan.pulses(), 0);
        }
        assert_eq!([turns_a_minute(1, 1), turns_a_minute(1, 2), turns_a_minute(u16::MAX, 0)], [30, 15, 1_966_050]);
    }

    #[test]
    fn one_that_stops_later_is_found_and_one_that_starts_late_is_not() {
        let mut fan = FanTurns::new();
        assert_eq!(alarm_after(&mut fan, u16::MAX, 0, 40), None);
        let stopped = alarm_after(&mut fan, u16::MAX, 9, 0);
        assert!(stopped.is_some_and(|s| s <= 6), "{stopped:?}");
        let mut slow = FanTurns::new();
        for period in 0..periods(3) {
            assert_eq!(slow.look(u16::MAX, 0), None, "{period}");
        }
        assert_eq!(alarm_after(&mut slow, u16::MAX, 0, 40), None);
    }
}
