//! Fan turns: a driven fan that does not turn, where its connector has a tachometer.
//!
//! No board counts pulses yet: `ThermalPort::tachometer` is `None` except in tests. A board that does needs
//!
//! - the pin in its `FanPin` (`chips/wiring/src/lib.rs`), where the compiler leads to the checks; it may be one
//!   of `inputs` so far;
//! - a count by an interrupt or a timer, because pulses are faster than a control period (`resources.rs`,
//!   `priorities.rs`); `heat.rs` there returns it;
//! - a setting for the presence of a tachometer in the connected fan (`FanSettings` in `settings/thermal/fans.rs`);
//! - the pin in `emulator/src/wiring.rs` and pulses in `heat.rs` there; otherwise every driven fan counts as stopped.
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
}

impl FanTurns {
    /// A fan that was not driven yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { before: 0, elapsed: 0, still: 0 }
    }

    /// One control period: the duty of 65,535, and the tachometer's count of pulses, wrapping.
    pub fn look(&mut self, duty: u16, pulses: u16) -> Option<Alarm> {
        if duty < DRIVEN {
            *self = Self { before: pulses, ..Self::new() };
            return None;
        }
        self.elapsed += 1;
        if self.elapsed < WINDOW {
            return None;
        }
        let stands = pulses.wrapping_sub(self.before) < LEAST;
        (self.before, self.elapsed) = (pulses, 0);
        self.still = if stands { self.still + 1 } else { 0 };
        let alarm = Alarm { cause: Cause::FanFailed, value: Celsius::ZERO, limit: Celsius::ZERO };
        (self.still >= MOST_STILL).then_some(alarm)
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
