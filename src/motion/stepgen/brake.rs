//! Unplanned braking: from any point of a move to rest, along the path.
//!
//! The tool slows down with the acceleration of its move, so it is nowhere faster than planned and enters every corner
//! at most as fast as planned. If a move is too short to stop in it, a part of the squared speed is left at its end
//! (`left_sq`), and the next move continues braking from there.

use super::current_move::LastPhase;
use super::{StepGenerator, Task};
use crate::motion::moves::{Move, WHOLE};
use crate::motion::ramps::{fraction, ramp_length, speed_of};
use crate::motion::trajectory::phase::{Curve, Phase};
use crate::units::{Length, SpeedSq, SubTicks, TICKS_PER_SECOND, mul_div};

/// State of an unplanned stop.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Braking {
    No,
    /// Braking. The next move begins with this speed squared.
    Slowing(SpeedSq),
    /// At rest; the rest of the epoch's work is dropped.
    Done,
}

/// A point of a move with the tool's speed there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct PathPoint {
    /// Covered fraction of the move.
    pub covered: u32,
    /// Speed squared.
    pub speed_sq: SpeedSq,
}

/// Time over `length` at a mean speed (2^-32 mm/s).
const fn time_over(Length(length): Length, mean: u64) -> SubTicks {
    SubTicks(if length == 0 { 0 } else { mul_div(length, (TICKS_PER_SECOND as u64) << 16, mean) })
}

impl PathPoint {
    /// Point and speed in a move of a length, `elapsed` (ticks times 2^16) after the begin of a phase that begins with
    /// the fraction `begin` covered.
    pub fn within(length: Length, phase: &Phase, begin: u32, elapsed: SubTicks) -> Self {
        let whole = u64::from(WHOLE);
        let (way, pace) = phase.progress(u64::from(fraction(elapsed.min(phase.time).0, phase.time.0)));
        let share = u64::from(phase.end.saturating_sub(begin));
        let mean = mul_div(length.part(share, whole).0, u64::from(TICKS_PER_SECOND) << 16, phase.time.0);
        let speed = mul_div(mean, pace, whole) >> 16;
        let covered = begin + (share * way / whole) as u32;
        Self { covered: covered.min(WHOLE), speed_sq: SpeedSq(speed.saturating_mul(speed)) }
    }

    /// At the end of a move.
    pub fn at_end_of(last_phase: &LastPhase) -> Self {
        Self::within(last_phase.length, &last_phase.phase, last_phase.begin, SubTicks::MAX)
    }

    /// Brakes from here on. Returns the phase to play and the speed squared at its end. If that is not zero, the phase
    /// ends where the move ends.
    pub fn brake(self, m: &Move) -> (Phase, SpeedSq) {
        let left = m.length.part(u64::from(WHOLE - self.covered), u64::from(WHOLE));
        let before = speed_of(self.speed_sq);
        let left_sq = self.speed_sq.saturating_sub(SpeedSq::gained(m.acceleration, left));
        if left_sq > SpeedSq::ZERO {
            let after = speed_of(left_sq);
            let time = time_over(left, before.midpoint(after).max(1));
            let slow_share = fraction(2 * after, before + after);
            return (
                Phase { curve: Curve::Slowing, end: WHOLE, slow_share, time },
                // A move that rests at its end is planned to stop there, so what is left is rounding.
                if m.rests { SpeedSq::ZERO } else { left_sq },
            );
        }
        let length = ramp_length(self.speed_sq, m.acceleration).min(left);
        let way = length.parts_of(m.length, u64::from(WHOLE)).min(u64::from(WHOLE - self.covered)) as u32;
        let time = time_over(length, (before / 2).max(1));
        (Phase { curve: Curve::Slowing, end: self.covered + way, slow_share: 0, time }, SpeedSq::ZERO)
    }
}

impl StepGenerator<'_> {
    /// The next move begins with this speed squared.
    pub(super) fn continue_brake(&mut self, left_sq: SpeedSq) {
        self.braking = if left_sq > SpeedSq::ZERO { Braking::Slowing(left_sq) } else { Braking::Done };
        if left_sq == SpeedSq::ZERO && !matches!(self.task, Task::ComingToRest(_)) {
            // A move may still be moving axes when all of it is laid.
            self.task = Task::ComingToRest(false);
        }
    }

    /// Slows the motion down from now on. Steps that are made already are played at their speed.
    pub(super) fn begin_brake(&mut self) {
        let now = self.next_instant();
        match self.task {
            Task::Move => {
                let point = match self.current_move.cut(&mut self.trajectory, now) {
                    Some((phase, begin, elapsed)) => {
                        PathPoint::within(self.current_move.m.length, &phase, begin, elapsed)
                    }
                    None => PathPoint { covered: 0, speed_sq: self.speed_sq_after_last() },
                };
                self.brake(point);
                self.group_steppers.iter_mut().for_each(|stepper| stepper.break_off(now));
            }
            Task::Nothing => self.continue_brake(self.speed_sq_after_last()),
            Task::Dwell(_) => {
                self.finish();
                self.continue_brake(SpeedSq::ZERO);
            }
            Task::Sweep => self.brake_sweep(now),
            Task::Brake(_) | Task::ComingToRest(_) => {}
        }
    }

    fn speed_sq_after_last(&self) -> SpeedSq {
        self.last_phase.map_or(SpeedSq::ZERO, |last_phase| PathPoint::at_end_of(&last_phase).speed_sq)
    }

    /// Continues with the phase that brakes the current move from `point` on.
    pub(super) fn brake(&mut self, point: PathPoint) {
        let (phase, left_sq) = point.brake(&self.current_move.m);
        self.current_move.replace_by(phase, point.covered);
        self.task = Task::Brake(left_sq);
    }
}
