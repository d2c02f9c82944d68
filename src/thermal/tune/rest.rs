//! Rest: whether the mass behind the sensor follows no longer.
//!
//! A sensor in a heating mat swings with the mat alone, in 8 to 28 s, while the plate on it is still 6 to 11 K colder.
//! Until the plate has followed, the swings take more power than the losses. So swings are summed up in windows of a
//! minute, and only the last three windows count, once each takes as much as the one before.

use super::{RATE, Swing};

/// The shortest window, in periods: 60 s.
const WINDOW: u32 = 60 * RATE.unsigned_abs();

/// Two windows take as much if their mean powers differ by less than this, in percent.
const ALIKE: u64 = 3;

/// Windows of swings.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rest {
    now: Window,
    /// The last ones, the newest first.
    last: [Window; 3],
}

/// Swings of a minute.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    periods: u32,
    /// Periods with power.
    on: u32,
    /// Sum of the temperature above the room, in K periods with 8 fractional bits.
    warmth: i64,
}

impl Rest {
    /// Adds a swing of so many periods.
    pub fn add(&mut self, swing: &Swing, periods: u32) {
        let Window { periods: before, on, warmth } = self.now;
        self.now = Window { periods: before + periods, on: on + swing.on, warmth: warmth + swing.warmth };
        if self.now.periods >= WINDOW {
            let [newest, middle, _] = self.last;
            (self.last, self.now) = ([self.now, newest, middle], Window::default());
        }
    }

    /// Whether the last windows took as much power as each other.
    pub fn is_reached(&self) -> bool {
        let [newest, middle, oldest] = self.last;
        newest.is_like(middle) && middle.is_like(oldest)
    }

    /// The losses by the last windows, in W/K with 24 fractional bits, of a heater of `power` in W with 20.
    pub fn loss(&self, power: i64) -> Option<i64> {
        let sum = |of: fn(&Window) -> i64| self.last.iter().map(of).sum::<i64>();
        let periods = sum(|window| window.periods.into());
        let warmth = sum(|window| window.warmth).checked_div(periods)?.max(1);
        Some(power.checked_mul(sum(|window| window.on.into()))?.checked_div(periods)?.checked_mul(1 << 12)? / warmth)
    }
}

impl Window {
    fn is_like(self, other: Self) -> bool {
        let [a, b] = [(self, other), (other, self)].map(|(one, two)| u64::from(one.on) * u64::from(two.periods));
        a.abs_diff(b) * 100 < ALIKE * a.max(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_of_a_minute_are_at_rest_when_three_take_as_much() {
        let mut rest = Rest::default();
        let mut add = |on| {
            // Four swings of 20 s: the third one ends a window.
            for _ in 0..3 {
                rest.add(&Swing { on, warmth: 256 * 40 * 1000, ..Swing::NEW }, 1000);
            }
            rest.is_reached()
        };
        assert_eq!([700, 500, 420, 410, 405].map(&mut add), [false, false, false, false, true]);
        // 100 W, 41 % of the time, 40 K above the room.
        let loss = rest.loss(100 << 20).unwrap() as f64 / f64::from(1 << 24);
        assert!((loss - 100.0 * (420.0 + 410.0 + 405.0) / 3000.0 / 40.0).abs() < 0.001, "{loss}");
        assert_eq!(Rest::default().loss(1 << 20), None);
    }
}
