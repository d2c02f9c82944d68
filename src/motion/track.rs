//! Tracks: the way of one motor group through the phases of a move, step by step.

use super::crossing::{Curve, Path};
use super::moves::{Move, WHOLE};
use crate::kinematics::count_at;
use crate::units::Steps;

/// Half a step.
const HALF: i64 = 1 << 31;

/// One motor group.
#[derive(Clone, Copy)]
pub(super) struct Track {
    /// The group's count of steps.
    pub count: i32,
    pub path: Path,
    /// When its next step is due, and which way.
    pub next: Option<(u64, bool)>,
    /// When its next step may come at the earliest.
    pub free: u64,
}

/// A phase of a move.
#[derive(Clone, Copy)]
pub(super) struct Phase {
    pub curve: Curve,
    /// Fraction of the move behind at its end.
    pub end: u32,
    pub slow_share: u32,
    pub time: u64,
}

impl Track {
    /// At rest at 0.
    pub fn still() -> Self {
        let path = Path::new(Steps::ZERO, Steps::ZERO, Curve::Steady, 0, 0);
        Self { count: 0, path, next: None, free: 0 }
    }

    /// Takes over the way from `start` to `stop` in a phase that begins at `begin`.
    pub fn lay(&mut self, start: Steps, stop: Steps, phase: &Phase, begin: u64) {
        self.path = Path::new(start, stop, phase.curve, phase.slow_share, phase.time);
        self.plan_next(begin);
    }

    /// Finds the group's next step in its present path, which began at `begin`.
    pub fn plan_next(&mut self, begin: u64) {
        let goal = count_at(self.path.end());
        if goal == self.count {
            self.next = None;
            return;
        }
        let ahead = goal.wrapping_sub(self.count) > 0;
        let edge = Steps::from_bits((i64::from(self.count) << 32).wrapping_add(if ahead { HALF } else { -HALF }));
        // A step that is left over from the phase before is due at once.
        let after = if ahead == self.path.is_forward() { self.path.reaches(edge) } else { 0 };
        let tick = (begin + after + (1 << 15)) >> 16;
        self.next = Some((tick.max(self.free), ahead));
    }
}

/// The phases of a move; one without time is left out.
pub(super) fn phases(m: &Move) -> heapless::Vec<Phase, 3> {
    let mut phases = heapless::Vec::new();
    let first = if m.brakes_first { Curve::Slowing } else { Curve::Speeding };
    let all = [
        Phase { curve: first, end: m.accelerated, slow_share: m.entry_share, time: m.accelerate },
        Phase { curve: Curve::Steady, end: m.cruised, slow_share: 0, time: m.cruise },
        Phase { curve: Curve::Slowing, end: WHOLE, slow_share: m.exit_share, time: m.decelerate },
    ];
    for phase in all {
        if phase.time > 0 {
            let _ = phases.push(phase);
        }
    }
    // The last phase ends where the move does.
    if let Some(last) = phases.last_mut() {
        last.end = WHOLE;
    }
    phases
}

/// The point a fraction of the way from `first` to `last`.
pub(super) fn point(first: Steps, last: Steps, fraction: u32) -> Steps {
    if fraction == WHOLE {
        return last;
    }
    // Rounded towards zero, so that groups that mirror each other still do.
    let way = i128::from(last.wrapping_sub(first).to_bits()) * i128::from(fraction) / i128::from(WHOLE);
    first.wrapping_add(Steps::from_bits(way as i64))
}
