//! Trapezoids: times and speeds of a move's three phases, and the part of it that was made when it ends early.

use corehbot::motion::{Move, WHOLE};
use corehbot::units::TICKS_PER_SECOND;
use corehbot_twin::math::powi;

/// Ticks times 2^16 a second.
const SUB_TICKS: f64 = TICKS_PER_SECOND as f64 * 65536.0;

/// Times and speeds of a move.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Trapezoid {
    /// Of the three phases, in s.
    pub times: [f64; 3],
    /// Entry, top and exit speed in mm/s.
    pub speeds: [f64; 3],
}

impl Trapezoid {
    /// A planned move's.
    pub fn of(m: &Move) -> Self {
        let times = [m.accelerate, m.cruise, m.decelerate].map(|time| time.0 as f64 / SUB_TICKS);
        let length = m.length.0 as f64 / powi(2.0, 32);
        let part = |fraction: u32| f64::from(fraction) / f64::from(WHOLE);
        let ends = [part(m.accelerated), part(m.cruised), 1.0];
        let means: [f64; 3] = std::array::from_fn(|i| {
            let begin = if i == 0 { 0.0 } else { ends[i - 1] };
            if times[i] > 0.0 { (ends[i] - begin) * length / times[i] } else { 0.0 }
        });
        // A phase's lower speed alone would cover the share of it, and its mean is half the sum of its two speeds. The
        // longest phase tells the top: fractions are rounded, so the mean of one of a few ticks says nothing.
        let [rise, cruise, fall] = times;
        let high = |mean: f64, share: u32| (2.0 - part(share)) * mean;
        let top = if cruise >= rise.max(fall) {
            means[1]
        } else if rise >= fall {
            if m.brakes_first { part(m.entry_share) * means[0] } else { high(means[0], m.entry_share) }
        } else {
            high(means[2], m.exit_share)
        };
        let ratio = |share: u32| part(share) / (2.0 - part(share));
        let entry = match ratio(m.entry_share) {
            _ if rise <= 0.0 => top,
            ratio if m.brakes_first && ratio > 0.0 => top / ratio,
            ratio => top * ratio,
        };
        let exit = if fall > 0.0 { top * ratio(m.exit_share) } else { top };
        Self { times, speeds: [entry, top, exit] }
    }

    /// Its part in the first `time` s, and the share of its way in it.
    pub fn cut(&self, time: f64) -> (Self, f64) {
        let [entry, top, exit] = self.speeds;
        let (mut left, mut way, mut whole) = (time, 0.0, 0.0);
        let (mut times, mut end) = ([0.0; 3], entry);
        for (i, (from, to)) in [(entry, top), (top, top), (top, exit)].into_iter().enumerate() {
            whole += (from + to) / 2.0 * self.times[i];
            times[i] = left.clamp(0.0, self.times[i]);
            if times[i] > 0.0 {
                end = from + (to - from) * times[i] / self.times[i];
                way += (from + end) / 2.0 * times[i];
            }
            left -= times[i];
        }
        let top = if times[1] > 0.0 || times[2] > 0.0 { top } else { end };
        (Self { times, speeds: [entry, top, end] }, if whole > 0.0 { way / whole } else { 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::port::EndstopSet;
    use corehbot::units::{Length, MmPerSec2, Steps, SubTicks};

    /// Reproducer: a cruise of three ticks, which rounding has made 8 um long, had a top speed of 27 m/s.
    #[test]
    fn a_phase_of_a_few_ticks_does_not_tell_the_speed() {
        let ticks = |seconds: f64| SubTicks((seconds * SUB_TICKS) as u64);
        let fraction = |part: f64| (part * f64::from(WHOLE)) as u32;
        // From 30 to 34 mm/s in 8 ms, which are 0.256 mm, and a cruise.
        let rise = Move {
            length: Length((0.264 * powi(2.0, 32)) as u64),
            accelerated: fraction(0.256 / 0.264),
            cruised: WHOLE,
            accelerate: ticks(0.008),
            cruise: ticks(3e-7),
            entry_share: fraction(60.0 / 64.0),
            exit_share: WHOLE,
            decelerate: SubTicks::ZERO,
            end: [Steps::ZERO; 4],
            acceleration: MmPerSec2::ZERO,
            advance: Steps::ZERO,
            brakes_first: false,
            rests: false,
            watch: EndstopSet::NONE,
        };
        let fall = Move {
            accelerated: 0,
            cruised: fraction(0.008 / 0.264),
            accelerate: SubTicks::ZERO,
            decelerate: rise.accelerate,
            entry_share: WHOLE,
            exit_share: rise.entry_share,
            ..rise
        };
        for (planned, known) in [(rise, [30.0, 34.0, 34.0]), (fall, [34.0, 34.0, 30.0])] {
            let speeds = Trapezoid::of(&planned).speeds;
            assert!(speeds.iter().zip(known).all(|(v, known)| (v - known).abs() < 1e-3), "{speeds:?}");
        }
        let brakes = Move { brakes_first: true, ..rise };
        let speeds = Trapezoid::of(&brakes).speeds;
        assert!(speeds.iter().zip([34.0, 30.0, 30.0]).all(|(v, known)| (v - known).abs() < 1e-3), "{speeds:?}");
    }

    #[test]
    fn a_part_of_a_trapezoid_has_the_way_under_it() {
        let whole = Trapezoid { times: [1.0, 2.0, 1.0], speeds: [0.0, 10.0, 0.0] };
        // 5 + 20 + 5 mm.
        let (part, share) = whole.cut(0.5);
        assert_eq!((part.times, part.speeds), ([0.5, 0.0, 0.0], [0.0, 5.0, 5.0]));
        assert!((share - 1.25 / 30.0).abs() < 1e-12);
        let (part, share) = whole.cut(3.5);
        assert_eq!((part.times, part.speeds), ([1.0, 2.0, 0.5], [0.0, 10.0, 5.0]));
        assert!((share - 28.75 / 30.0).abs() < 1e-12);
        let (part, share) = whole.cut(9.0);
        assert_eq!((part, share), (whole, 1.0));
    }
}
