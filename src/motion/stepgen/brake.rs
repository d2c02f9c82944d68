//! Braking where it was not planned: from any point of a move to rest, along the path.
//!
//! The tool slows down with the acceleration of the move it is in, so it is nowhere faster than planned, and enters
//! every corner at most as fast as planned. Where a move is too short the next one goes on from the speed that is
//! left.

use super::{StepGenerator, Task};
use crate::kinematics::GROUPS;
use crate::motion::crossing::Curve;
use crate::motion::moves::{Move, WHOLE};
use crate::motion::profile::{fraction, gain, ramp_length, speed};
use crate::motion::track::{Phase, phases, point};
use crate::port::Pend;
use crate::units::{Steps, TICKS_PER_SECOND, mul_div};

/// Events are made this far ahead, in ticks, and no farther: 10 ms, as long as a full queue lasts at the greatest
/// speed. What is made cannot be braked any more.
const AHEAD: i32 = 100_000;

/// So many events are made ahead however long they take.
const LEAST_AHEAD: u32 = 4;

/// Whether motion is to come to rest.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Braking {
    No,
    /// It slows down. The next move begins with this speed squared.
    Slowing(u64),
    /// It has come to rest, and the rest of the epoch's work is dropped.
    Done,
}

/// A point of a move, and how fast the tool is there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Moment {
    /// The fraction of the move behind.
    pub done: u32,
    /// Speed squared, in raw bits of 2^-32 mm2/s2.
    pub square: u64,
}

/// Time over `length` (raw `Mm` bits) at a mean speed (2^-32 mm/s), in ticks times 2^16.
const fn time_over(length: u64, mean: u64) -> u64 {
    if length == 0 { 0 } else { mul_div(length, (TICKS_PER_SECOND as u64) << 16, mean) }
}

impl Moment {
    /// Where a move is, and how fast, when `elapsed` (ticks times 2^16) of its phase `index` has passed.
    pub fn within(m: &Move, index: usize, elapsed: u64) -> Self {
        let phases = phases(m);
        let Some(phase) = phases.get(index) else {
            return Self { done: WHOLE, square: 0 };
        };
        let begin = index.checked_sub(1).and_then(|before| phases.get(before)).map_or(0, |before| before.end);
        let (whole, share) = (u64::from(WHOLE), u64::from(phase.slow_share.min(WHOLE)));
        let part = |a: u64, b: u64| a * b / whole;
        let x = u64::from(fraction(elapsed.min(phase.time), phase.time));
        // As in `crossing`: the way from the slow end, and the speed there as a part of the mean one.
        let way = |x: u64| part(share, x) + part(whole - share, part(x, x));
        let pace = |x: u64| share + 2 * part(whole - share, x);
        let (way, pace) = match phase.curve {
            Curve::Steady => (x, whole),
            Curve::Speeding => (way(x), pace(x)),
            Curve::Slowing => (whole - way(whole - x), pace(whole - x)),
        };
        let share = phase.end.saturating_sub(begin);
        let mean = mul_div(mul_div(m.length, u64::from(share), whole), u64::from(TICKS_PER_SECOND) << 16, phase.time);
        let speed = mul_div(mean, pace, whole) >> 16;
        let done = begin + part(u64::from(share), way) as u32;
        Self { done: done.min(WHOLE), square: speed.saturating_mul(speed) }
    }

    /// At the end of a move.
    pub fn behind(m: &Move) -> Self {
        match phases(m).len().checked_sub(1) {
            Some(last) if !m.rests => Self::within(m, last, u64::MAX),
            _ => Self { done: WHOLE, square: 0 },
        }
    }

    /// Brakes from here on: the phase to play, and the speed squared that is left at its end, which is that of the
    /// move then.
    pub fn brake(self, m: &Move) -> (Phase, u64) {
        let left = mul_div(m.length, u64::from(WHOLE - self.done), u64::from(WHOLE));
        let before = speed(self.square);
        let rest = self.square.saturating_sub(gain(m.acceleration, left));
        if rest > 0 {
            let after = speed(rest);
            let time = time_over(left, before.midpoint(after).max(1));
            let slow_share = fraction(2 * after, before + after);
            return (Phase { curve: Curve::Slowing, end: WHOLE, slow_share, time }, if m.rests { 0 } else { rest });
        }
        let length = ramp_length(self.square, m.acceleration).min(left);
        let way = mul_div(length, u64::from(WHOLE), m.length).min(u64::from(WHOLE - self.done)) as u32;
        let time = time_over(length, (before / 2).max(1));
        (Phase { curve: Curve::Slowing, end: self.done + way, slow_share: 0, time }, 0)
    }
}

impl<W: Pend> StepGenerator<'_, W> {
    /// Whether the events made reach far enough.
    pub(super) fn is_ahead(&self) -> bool {
        let ahead = self.base.wrapping_add(self.last as u32).wrapping_sub(self.status.tick());
        ahead as i32 > AHEAD && self.status.events_waiting() >= LEAST_AHEAD
    }

    /// The next move begins with this speed squared.
    pub(super) fn go_on_with(&mut self, rest: u64) {
        self.braking = if rest > 0 { Braking::Slowing(rest) } else { Braking::Done };
        if rest == 0 {
            self.tracks.iter_mut().for_each(|track| track.next = None);
            self.status.set_stopped(Some(self.epoch));
        }
    }

    /// From now on the motion slows down. What is made already is played at its speed.
    pub(super) fn begin_brake(&mut self) {
        match self.task {
            Task::Move(m, from, phase) if phase > 0 => {
                // A tick after the last event, so that its step lies behind.
                let length = self.tracks[0].path.time();
                let begin = self.end - length;
                let elapsed = ((self.last + 1) << 16).saturating_sub(begin).min(length);
                self.end = begin + elapsed;
                self.brake(&m, from, Moment::within(&m, phase - 1, elapsed));
            }
            Task::Move(m, from, _) => self.brake(&m, from, Moment { done: 0, square: self.speed_behind() }),
            Task::Nothing => self.go_on_with(self.speed_behind()),
            Task::Dwell => {
                self.finish();
                self.go_on_with(0);
            }
            Task::Brake(..) => {}
        }
    }

    fn speed_behind(&self) -> u64 {
        self.behind.map_or(0, |m| Moment::behind(&m).square)
    }

    /// Lays the phase that brakes a move from `moment` on, which is now.
    pub(super) fn brake(&mut self, m: &Move, from: [Steps; 4], moment: Moment) {
        let (phase, rest) = moment.brake(m);
        let begin = self.end;
        self.end += phase.time;
        for (track, group) in self.tracks.iter_mut().zip(&GROUPS) {
            let (first, last) = (group.coordinate(from), group.coordinate(m.end));
            track.lay(point(first, last, moment.done), point(first, last, phase.end), &phase, begin);
            // Half a step may be left over where the path was rounded; it is no reason to turn round.
            track.next = track.next.filter(|(_, ahead)| *ahead == track.path.is_forward());
        }
        let mut end = m.end;
        for (end, from) in end.iter_mut().zip(from) {
            *end = point(from, *end, phase.end);
        }
        self.task = Task::Brake(end, rest);
    }
}
