//! The current move: the phases of the move that is being laid as spans, and the progress of laying.
//!
//! There is only one, which takes up move after move in place: a copy would cost as much as the move.

use crate::motion::moves::{LONG_TIME, Move};
use crate::motion::trajectory::phase::{Curve, Phase, phases};
use crate::motion::trajectory::{AXES, LONGEST, Position, Trajectory};
use crate::units::{Length, Steps, SubTicks};
use heapless::Vec;

/// Progress of laying a move.
pub(in crate::motion) struct CurrentMove {
    pub m: Move,
    pub first: Position,
    pub last: Position,
    phases: Vec<Phase, 3>,
    index: usize,
    /// Time of the present phase that is laid.
    elapsed: SubTicks,
    /// Covered fraction of the move at the begin of the present phase.
    begin: u32,
    /// Phase of the last span, covered fraction of the move at the begin of that phase, and begin of the span within
    /// the phase.
    laid: Option<(Phase, u32, SubTicks)>,
}

/// The last phase of a move.
#[derive(Clone, Copy)]
pub(in crate::motion) struct LastPhase {
    pub phase: Phase,
    /// Covered fraction of the move at its begin.
    pub begin: u32,
    /// Length of the move.
    pub length: Length,
}

impl CurrentMove {
    /// No move.
    pub const NONE: Self = Self {
        m: Move::NONE,
        first: [Steps::ZERO; AXES],
        last: [Steps::ZERO; AXES],
        phases: Vec::new(),
        index: 0,
        elapsed: SubTicks::ZERO,
        begin: 0,
        laid: None,
    };

    /// Takes up a move between these positions; its first phase is laid next.
    pub fn take_up(&mut self, m: &Move, (first, last): &(Position, Position)) {
        self.m = *m;
        (self.first, self.last) = (*first, *last);
        self.phases = phases(m);
        (self.index, self.elapsed, self.begin, self.laid) = (0, SubTicks::ZERO, 0, None);
    }

    /// The time of it that is laid.
    pub fn laid_time(&self) -> SubTicks {
        let before = self.phases.iter().take(self.index).map(|phase| phase.time.0).sum::<u64>();
        SubTicks(before) + self.elapsed
    }

    /// End of the move.
    pub fn last_phase(&self) -> Option<LastPhase> {
        let (last, before) = self.phases.split_last()?;
        let begin = before.last().map_or(0, |phase| phase.end);
        Some(LastPhase { phase: *last, begin, length: self.m.length })
    }

    /// Lays the next span. Returns by how much it is longer than planned, in ticks times 2^16; `None` if all spans are
    /// laid.
    pub fn lay_next(&mut self, trajectory: &mut Trajectory) -> Option<SubTicks> {
        let phase = self.phases.get(self.index).copied()?;
        let left = phase.time - self.elapsed;
        // The last two have equal length, so that neither is too short.
        let time = if left <= LONGEST { left } else { LONGEST.min(SubTicks(left.0 / 2)) };
        let from = self.elapsed;
        let span = match phase.curve {
            _ if time == phase.time => phase,
            Curve::Steady if phase.time >= LONG_TIME && time < left => phase.cut_evenly(self.begin, from, time),
            _ => phase.cut(self.begin, from, from + time),
        };
        let added = trajectory.least_time().saturating_sub(span.time);
        trajectory.lay(&self.first, &self.last, &Phase { time: span.time + added, ..span });
        self.laid = Some((phase, self.begin, from));
        self.elapsed += span.time;
        if self.elapsed >= phase.time {
            (self.index, self.elapsed, self.begin) = (self.index + 1, SubTicks::ZERO, phase.end);
        }
        Some(added)
    }

    /// Cuts the last span at the first tap's position at `time` and drops the rest of the move from the trajectory.
    /// Returns the phase and its elapsed time there; `None` if no part was laid.
    pub fn cut(&mut self, trajectory: &mut Trajectory, time: SubTicks) -> Option<(Phase, u32, SubTicks)> {
        let (phase, begin, from) = self.laid?;
        let Some(passed) = trajectory.take_back(time) else {
            // Everything laid has passed.
            return Some((phase, begin, if self.elapsed > SubTicks::ZERO { self.elapsed } else { phase.time }));
        };
        if passed > SubTicks::ZERO {
            trajectory.lay(&self.first, &self.last, &phase.cut(begin, from, from + passed));
        }
        Some((phase, begin, from + passed))
    }

    /// Continues with another phase, from the covered fraction `begin` of the move.
    pub fn replace_by(&mut self, phase: Phase, begin: u32) {
        self.phases = Vec::new();
        let _ = self.phases.push(phase);
        (self.index, self.elapsed, self.begin, self.laid) = (0, SubTicks::ZERO, begin, None);
    }
}
