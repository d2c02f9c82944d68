//! Pace: decides when virtual time may advance.

use corehbot::units::TICKS_PER_SECOND;
use std::time::Duration;

/// With [`Speed::Max`], a host may think for this long while time stands still. It is eight times the longest gap
/// between two lines of OctoPrint on an idle computer of two cores (30 ms), for computers that are not idle.
const THINKING: Duration = Duration::from_millis(250);

/// A computer that lags by more than this does not make it good: a host would see time race.
const LAG: Duration = Duration::from_millis(200);

/// How fast virtual time goes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Speed {
    /// This many times as fast as the wall clock.
    Times(f64),
    /// As fast as it can be computed. While the printer waits for its host, virtual time first stands still for a
    /// moment, because a host's thinking time would count as long otherwise. Then it follows the wall clock, because
    /// silence means something.
    Max,
}

/// Reads a speed.
pub fn parse(text: &str) -> Result<Speed, String> {
    match text.parse::<f64>() {
        _ if text == "max" => Ok(Speed::Max),
        Ok(times) if (0.01..=1000.0).contains(&times) => Ok(Speed::Times(times)),
        _ => Err("expected a number from 0.01 to 1000, or max".to_owned()),
    }
}

/// Keeps virtual time in step with the wall clock, which counts from the start.
#[derive(Debug)]
pub struct Pace {
    speed: Speed,
    /// A moment on the wall clock, and the tick that belongs to it.
    anchor: (Duration, u64),
    /// Since when the host thinks.
    asked: Option<Duration>,
    /// Moves that the printer had planned when the host last got time to think.
    moves: u32,
}

impl Pace {
    /// A pace from the start on.
    #[must_use]
    pub const fn new(speed: Speed) -> Self {
        Self { speed, anchor: (Duration::ZERO, 0), asked: None, moves: 0 }
    }

    /// The host has sent something, and the printer has planned this many moves. Time may stand still once more only if
    /// the number has grown. Otherwise a host that asks for temperatures ten times a second would never see them
    /// change.
    pub const fn hear(&mut self, moves: u32) {
        if self.moves != moves {
            self.moves = moves;
            self.asked = None;
        }
    }

    /// How long to wait before time advances from `tick`.
    pub fn wait(&mut self, wall: Duration, tick: u64, is_awaiting_host: bool) -> Duration {
        match self.speed {
            Speed::Times(times) => self.real(wall, tick, times),
            Speed::Max if is_awaiting_host => {
                let end = *self.asked.get_or_insert(wall) + THINKING;
                if wall >= end {
                    return self.real(wall, tick, 1.0);
                }
                self.anchor = (end, tick);
                end - wall
            }
            Speed::Max => {
                self.asked = None;
                Duration::ZERO
            }
        }
    }

    fn real(&mut self, wall: Duration, tick: u64, times: f64) -> Duration {
        let (begin, from) = self.anchor;
        let seconds = tick.saturating_sub(from) as f64 / f64::from(TICKS_PER_SECOND) / times;
        let due = begin + Duration::from_secs_f64(seconds);
        if wall > due + LAG {
            self.anchor = (wall, tick);
        }
        due.saturating_sub(wall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: u64 = TICKS_PER_SECOND as u64;

    fn ms(ms: u64) -> Duration {
        Duration::from_millis(ms)
    }

    #[test]
    fn time_goes_as_fast_as_is_asked_for() {
        let mut pace = Pace::new(parse("10").unwrap());
        assert_eq!(pace.wait(ms(100), SECOND, true), Duration::ZERO);
        assert_eq!(pace.wait(ms(100), 2 * SECOND, false), ms(100));
        for bad in ["0", "-1", "nan", "1e9", "", "fast"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_computer_that_was_asleep_does_not_make_time_race() {
        let mut pace = Pace::new(Speed::Times(1.0));
        assert_eq!(pace.wait(ms(60_000), SECOND, true), Duration::ZERO);
        assert_eq!(pace.wait(ms(60_000), 2 * SECOND, true), ms(1000));
    }

    #[test]
    fn at_full_speed_time_stands_still_while_the_host_thinks_but_not_for_ever() {
        let mut pace = Pace::new(Speed::Max);
        assert_eq!(pace.wait(ms(0), 100 * SECOND, false), Duration::ZERO);
        assert_eq!(pace.wait(ms(100), 100 * SECOND, true), THINKING);
        assert_eq!(pace.wait(ms(200), 100 * SECOND, true), THINKING - ms(100));
        pace.hear(1);
        assert_eq!(pace.wait(ms(300), 100 * SECOND, true), THINKING);
        assert_eq!(pace.wait(ms(550), 100 * SECOND, true), Duration::ZERO);
        assert_eq!(pace.wait(ms(550), 101 * SECOND, true), ms(1000));
        assert_eq!(pace.wait(ms(550), 101 * SECOND, false), Duration::ZERO);
    }

    #[test]
    fn at_full_speed_time_goes_on_while_a_host_asks_again_and_again() {
        let mut pace = Pace::new(Speed::Max);
        let mut tick = 0;
        for wall in (0..10_000).step_by(100) {
            pace.hear(0);
            let mut wall = ms(wall);
            let end = wall + ms(100);
            while wall < end {
                match pace.wait(wall, tick, true) {
                    Duration::ZERO => tick += SECOND / 1000,
                    wait => wall += wait,
                }
            }
        }
        assert!((9 * SECOND..=10 * SECOND).contains(&tick), "{tick}");
    }
}
