//! Sweep: the motion of a resonance test, in pieces of constant acceleration.
//!
//! ```text
//! acceleration  +--+                  a half period: a pulse of a quarter period, and one against it,
//!               |  |        +----+    each of `accel_per_hz` times the frequency. The next half period goes
//!            ---+  +--+-----+    +    the other way, and its frequency is higher.
//!                     |     |
//!                     +-----+
//! ```
//!
//! A slow swing is added, so that the tool does not rest in one place of its guides: Klipper, `resonance_tester.py`
//! (December 2024), with its law of times. The last piece brings the tool to rest, some millimetres from the begin.
//!
//! Everything is integer, so the sweep is the same everywhere. The Console reckons with it before it begins and the
//! measurement while it runs, and the generator makes it.

use super::moves::WHOLE;
use super::ramps::fraction;
use super::trajectory::phase::{Curve, Phase};
use crate::units::{Hertz, Mm, MmPerSec2, Ratio, Seconds, Steps, SubTicks, TICKS_PER_SECOND, mul_div, part_of};

/// Longest piece: no span is longer (`LONGEST` of the trajectory).
const LONGEST: SubTicks = super::trajectory::LONGEST;

/// A second.
const SECOND: u64 = (TICKS_PER_SECOND as u64) << 16;

/// The part of the swing's period until its first turn, the square root of 2 over 8, times 2^32. So the tool swings
/// round the place where it began.
const FIRST_TURN: u64 = 759_250_125;

/// What a sweep does.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Sweep {
    /// First frequency.
    pub from: Hertz,
    /// Last frequency.
    pub to: Hertz,
    /// Acceleration of a pulse for each Hz.
    pub accel_per_hz: MmPerSec2,
    /// Growth of the frequency in Hz a second.
    pub hz_per_s: Ratio,
    /// Acceleration of the swing; 0 is none.
    pub swing: MmPerSec2,
    /// Period of the swing.
    pub period: Seconds,
    /// Acceleration by which it comes to rest.
    pub brake: MmPerSec2,
    /// Steps of x and y for a mm along the sweep, times 2^16.
    pub steps_per_mm: [i32; 2],
}

impl Sweep {
    /// None.
    pub const NONE: Self = Self {
        from: Hertz::ZERO,
        to: Hertz::ZERO,
        accel_per_hz: MmPerSec2::ZERO,
        hz_per_s: Ratio::ZERO,
        swing: MmPerSec2::ZERO,
        period: Seconds::ZERO,
        brake: MmPerSec2::ZERO,
        steps_per_mm: [0; 2],
    };

    /// The greatest acceleration of its pulses and its swing together.
    #[must_use]
    pub fn most_acceleration(&self) -> MmPerSec2 {
        let pulse = mul_div(self.accel_per_hz.to_bits().into(), self.to.to_bits().into(), 1 << Hertz::FRAC_NBITS);
        MmPerSec2::from_bits(u32::try_from(pulse).unwrap_or(u32::MAX)).saturating_add(self.swing)
    }

    /// Its pieces.
    #[must_use]
    pub const fn pieces(&self) -> Pieces {
        let period = SubTicks(mul_div(self.period.to_bits() as u64, SECOND, 1 << Seconds::FRAC_NBITS));
        let first = SubTicks(mul_div(period.0, FIRST_TURN, 1 << 32));
        let has_swing = self.swing.to_bits() > 0 && period.0 > 0;
        Pieces {
            sweep: *self,
            hz: (self.from.to_bits() as u64) << 16,
            left: SubTicks::ZERO,
            // The first pulse turns both round, and so goes forward.
            is_second: true,
            is_back: true,
            period,
            swing_left: if has_swing { first } else { SubTicks::MAX },
            // The first two turns are special (Klipper's law of times). All later ones are half a period apart.
            turn: SubTicks(first.0 + period.0 / 4),
            swings_back: false,
            is_braking: false,
            after_turn: None,
            segments: 0,
            now: Motion { at: 0, speed: 0 },
        }
    }
}

/// Place and speed along a sweep.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Motion {
    /// Place in mm times 2^32.
    pub at: i64,
    /// Speed in mm/s times 2^32.
    pub speed: i64,
}

impl Motion {
    /// After a time in which the speed changes evenly.
    fn after(self, time: SubTicks, speed: i64) -> Self {
        Self { at: self.at + part_of(self.speed + speed, time.0, 2 * SECOND), speed }
    }
}

/// A time of constant acceleration, in which the tool does not turn round.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Piece {
    /// How long it takes.
    pub time: SubTicks,
    /// At its begin.
    pub begin: Motion,
    /// At its end.
    pub end: Motion,
}

impl Piece {
    /// No piece.
    pub const NONE: Self =
        Self { time: SubTicks::ZERO, begin: Motion { at: 0, speed: 0 }, end: Motion { at: 0, speed: 0 } };

    /// Its speed after a part of its time, in mm/s times 2^32.
    #[must_use]
    pub const fn speed_after(&self, time: SubTicks) -> i64 {
        self.begin.speed
            + part_of(self.end.speed - self.begin.speed, time.0, if self.time.0 == 0 { 1 } else { self.time.0 })
    }

    /// Its first part.
    pub(in crate::motion) fn cut(&self, time: SubTicks) -> Self {
        Self { time, begin: self.begin, end: self.begin.after(time, self.speed_after(time)) }
    }

    /// It as a phase of a move of its own length.
    pub(in crate::motion) fn phase(&self) -> Phase {
        let (from, to) = (self.begin.speed.unsigned_abs(), self.end.speed.unsigned_abs());
        let curve = match from.cmp(&to) {
            core::cmp::Ordering::Less => Curve::Speeding,
            core::cmp::Ordering::Equal => Curve::Steady,
            core::cmp::Ordering::Greater => Curve::Slowing,
        };
        let slow_share = if from == to { 0 } else { fraction(2 * from.min(to), from + to) };
        Phase { curve, end: WHOLE, slow_share, time: self.time }
    }
}

/// The pieces of a sweep, one after the other.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pieces {
    sweep: Sweep,
    /// The frequency times 2^32.
    hz: u64,
    /// Time that is left of the present pulse.
    left: SubTicks,
    /// It is the second pulse of its half period.
    is_second: bool,
    /// The first pulse of the half period goes back.
    is_back: bool,
    period: SubTicks,
    /// Time until the swing turns.
    swing_left: SubTicks,
    /// The time from that turn to the next.
    turn: SubTicks,
    swings_back: bool,
    is_braking: bool,
    /// The tool turns round in this segment: what is left of its time, and the speed at its end.
    after_turn: Option<(SubTicks, i64)>,
    segments: u32,
    now: Motion,
}

impl Pieces {
    /// Place and speed at the end of the last piece.
    #[must_use]
    pub const fn now(&self) -> Motion {
        self.now
    }

    /// Times of constant acceleration so far, whether the tool turned round in them or not.
    #[must_use]
    pub const fn segments(&self) -> u32 {
        self.segments
    }

    /// The present frequency.
    #[must_use]
    pub const fn frequency(&self) -> Hertz {
        Hertz::from_bits((self.hz >> 16) as u32)
    }

    /// Ends the sweep from here: the next pieces bring the tool to rest.
    pub(in crate::motion) fn brake(&mut self, from: Motion) {
        (self.now, self.is_braking, self.after_turn) = (from, true, None);
    }

    /// Steps of x and y at a place, from the begin.
    pub(in crate::motion) fn steps(&self, at: i64) -> [Steps; 2] {
        // Cut off towards zero, so that mirrored groups stay mirrored.
        self.sweep.steps_per_mm.map(|times| {
            let steps = part_of(at, times.unsigned_abs().into(), 1 << 16);
            Steps::from_bits(if times < 0 { -steps } else { steps })
        })
    }

    /// The place as a length.
    #[must_use]
    pub const fn place(at: i64) -> Mm {
        Mm::from_bits(at)
    }

    /// Begins the next pulse; false after the last one.
    fn begin_pulse(&mut self) -> bool {
        let half = |hz: u64| SubTicks(mul_div(SECOND / 4, 1 << 32, hz));
        if self.is_second {
            if self.segments > 0 {
                let growth = mul_div(2 * half(self.hz).0, u64::from(self.sweep.hz_per_s.to_bits()) << 16, SECOND);
                self.hz += growth.max(1);
            }
            // Klipper has a millionth of a Hz here.
            if self.hz > ((u64::from(self.sweep.to.to_bits())) << 16) + 4295 {
                return false;
            }
            self.is_back = !self.is_back;
        }
        self.is_second = !self.is_second;
        self.left = half(self.hz);
        true
    }

    /// The next time of constant acceleration and the acceleration, in mm/s^2 times 2^16; `None` at the end.
    fn next_segment(&mut self) -> Option<(SubTicks, i64)> {
        if self.left == SubTicks::ZERO && !self.begin_pulse() {
            return None;
        }
        let pulse = mul_div(self.sweep.accel_per_hz.to_bits().into(), self.hz, 1 << (8 + 16)).cast_signed();
        // Forward, back, back, forward, as Klipper has it: after two half periods place and speed are as before.
        let pulse = if self.is_back == self.is_second { pulse } else { -pulse };
        let swing = i64::from(self.sweep.swing.to_bits()) << 8;
        let swing = match (self.swing_left == SubTicks::MAX, self.swings_back) {
            (true, _) => 0,
            (false, false) => swing,
            (false, true) => -swing,
        };
        let time = self.left.min(self.swing_left).min(LONGEST);
        self.left = self.left - time;
        if self.swing_left != SubTicks::MAX {
            self.swing_left = self.swing_left - time;
            if self.swing_left == SubTicks::ZERO {
                (self.swing_left, self.turn) = (self.turn, SubTicks(self.period.0 / 2));
                self.swings_back = !self.swings_back;
            }
        }
        self.segments += 1;
        Some((time, pulse + swing))
    }

    /// The next piece of coming to rest; `None` at rest.
    fn next_of_brake(&self) -> Option<(SubTicks, i64)> {
        let speed = self.now.speed;
        let brake = u64::from(self.sweep.brake.to_bits()) << 8;
        let time = SubTicks(mul_div(speed.unsigned_abs(), TICKS_PER_SECOND.into(), brake.max(1)));
        if time <= LONGEST {
            return (time > SubTicks::ZERO).then_some((time, 0));
        }
        Some((LONGEST, speed - part_of(speed, LONGEST.0, time.0)))
    }
}

impl Iterator for Pieces {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        let begin = self.now;
        let (time, speed) = loop {
            if let Some(rest) = self.after_turn.take() {
                break rest;
            }
            if self.is_braking {
                break self.next_of_brake()?;
            }
            match self.next_segment() {
                Some((time, acceleration)) => {
                    break (time, begin.speed + part_of(acceleration, time.0, TICKS_PER_SECOND.into()));
                }
                None => self.is_braking = true,
            }
        };
        // A span has one direction, so a piece ends where the speed is 0.
        let turns = begin.speed != 0 && speed != 0 && (begin.speed < 0) != (speed < 0);
        let piece = if turns {
            let (before, after) = (begin.speed.unsigned_abs(), speed.unsigned_abs());
            let until = SubTicks(mul_div(before, time.0, before + after));
            self.after_turn = Some((time - until, speed));
            Piece { time: until, begin, end: begin.after(until, 0) }
        } else {
            Piece { time, begin, end: begin.after(time, speed) }
        };
        self.now = piece.end;
        Some(piece)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    fn klippers(accel_per_hz: i32, swing: i32) -> Sweep {
        Sweep {
            from: Hertz::from_num(5),
            to: Hertz::from_num(135),
            accel_per_hz: MmPerSec2::from_num(accel_per_hz),
            hz_per_s: Ratio::ONE,
            swing: MmPerSec2::from_num(swing),
            period: Seconds::from_num(1.2),
            brake: MmPerSec2::from_num(5000),
            steps_per_mm: [80 << 16, 0],
        }
    }

    /// Segments, time, peak speed, and the ends of the way at the ends of segments, up to the brake.
    fn extremes(sweep: Sweep) -> (u32, f64, f64, [f64; 2]) {
        let mm = |bits: i64| bits as f64 / 4_294_967_296.0;
        let (mut pieces, mut time, mut peak, mut way) = (sweep.pieces(), 0.0, 0.0_f64, [0.0_f64; 2]);
        while let Some(piece) = pieces.next().filter(|_| !pieces.is_braking) {
            time += piece.time.0 as f64 / SECOND as f64;
            peak = peak.max(mm(piece.end.speed).abs());
            if pieces.after_turn.is_none() {
                way = [way[0].min(mm(piece.end.at)), way[1].max(mm(piece.end.at))];
            }
        }
        (pieces.segments(), time, peak, way)
    }

    /// Simulated with Klipper's own code.
    #[test]
    fn the_usual_sweep_is_klippers() {
        for (sweep, peak, way) in [
            (klippers(60, 400), 134.99, [-17.78, 18.58]),
            (klippers(34, 400), 128.5, [-17.9, 18.3]),
            (klippers(34, 200), 68.5, [-8.9, 9.3]),
            (klippers(34, 0), 8.5, [0.0, 0.43]),
        ] {
            let (segments, time, speed, ends) = extremes(sweep);
            let expected = if sweep.swing == MmPerSec2::ZERO { 36_398 } else { 36_615 };
            assert_eq!(segments, expected);
            assert!((time - 130.002).abs() < 0.001, "{time}");
            assert!((speed / peak - 1.0).abs() < 2e-3, "{speed}");
            assert!(ends.iter().zip(way).all(|(end, way)| (end - way).abs() < 0.06), "{ends:?}");
        }
        let (.., speed, [back, forth]) = extremes(klippers(60, 400));
        assert!((speed / 134.99 - 1.0).abs() < 1e-3, "{speed}");
        assert!((back / -17.78 - 1.0).abs() < 1e-3 && (forth / 18.58 - 1.0).abs() < 1e-3, "{back} {forth}");
        assert_eq!(klippers(60, 400).most_acceleration(), MmPerSec2::from_num(8500));
    }

    /// Every piece begins where the last one ended, and its acceleration is within the limit.
    #[test]
    fn pieces_join_and_end_at_rest() {
        for sweep in [klippers(60, 400), klippers(34, 0), Sweep { period: Seconds::from_num(9), ..klippers(10, 100) }] {
            let most: f64 = sweep.most_acceleration().to_num();
            let (mut before, mut count) = (Piece::NONE, 0);
            for piece in sweep.pieces() {
                assert_eq!(piece.begin, before.end);
                assert!(piece.time <= LONGEST);
                assert!(
                    piece.begin.speed == 0 || piece.end.speed == 0 || (piece.begin.speed < 0) == (piece.end.speed < 0)
                );
                let gain = (piece.end.speed - piece.begin.speed) as f64 / 4_294_967_296.0;
                let time = piece.time.0 as f64 / SECOND as f64;
                // The last bit of a time counts where pieces are short.
                let brake: f64 = sweep.brake.to_num();
                assert!(gain.abs() <= most.max(brake) * (time + 1e-10), "{piece:?}");
                (before, count) = (piece, count + 1);
            }
            assert_eq!(before.end.speed, 0);
            assert!(count > 30_000);
        }
    }

    #[test]
    fn a_piece_that_is_cut_goes_where_it_would_have_been() {
        let pieces: std::vec::Vec<Piece> = klippers(60, 400).pieces().take(200).collect();
        for piece in pieces {
            let part = piece.cut(SubTicks(piece.time.0 / 3));
            let share = piece.phase().progress(u64::from(WHOLE) / 3).0 as f64 / f64::from(WHOLE);
            let (way, gone) = (piece.end.at - piece.begin.at, part.end.at - piece.begin.at);
            assert!((gone as f64 - share * way as f64).abs() < 1e-6 * way.abs() as f64 + 40.0, "{piece:?} {part:?}");
        }
    }
}
