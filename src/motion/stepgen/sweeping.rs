//! Sweeping: the sweep of a resonance test, laid piece by piece.
//!
//! The generator makes the pieces itself: in the MoveQueue they would fill it 300 times a second. A brake ends a sweep
//! at once, with the acceleration by which it would come to rest anyway.

use super::brake::Braking;
use super::{StepGenerator, Task};
use crate::motion::sweep::{Piece, Pieces, Sweep};
use crate::motion::trajectory::{AXES, Position, Trajectory};
use crate::units::{SpeedSq, Steps, SubTicks};

/// Progress of a sweep.
pub(super) struct Sweeping {
    pieces: Pieces,
    /// Where it began.
    origin: Position,
    /// The last piece.
    laid: Piece,
}

impl Sweeping {
    /// No sweep.
    pub const NONE: Self = Self { pieces: Sweep::NONE.pieces(), origin: [Steps::ZERO; AXES], laid: Piece::NONE };

    /// Begins a sweep there.
    pub fn begin(&mut self, sweep: &Sweep, origin: Position) {
        (self.pieces, self.origin, self.laid) = (sweep.pieces(), origin, Piece::NONE);
    }

    fn lay(&self, piece: &Piece, trajectory: &mut Trajectory) {
        let mut last = self.origin;
        for (steps, way) in last.iter_mut().zip(self.pieces.steps(piece.end.at)) {
            *steps = steps.wrapping_add(way);
        }
        let first = trajectory.end().position;
        trajectory.lay(&first, &last, &piece.phase());
    }
}

impl StepGenerator<'_> {
    /// Lays the next piece; false if there is none, and then the motors come to rest.
    #[inline(never)]
    pub(super) fn lay_sweep(&mut self) -> bool {
        if let Some(piece) = self.sweeping.pieces.next() {
            self.sweeping.lay(&piece, &mut self.trajectory);
            self.sweeping.laid = piece;
            return true;
        }
        self.position = self.trajectory.end().position;
        self.task = Task::ComingToRest(true);
        if self.braking != Braking::No {
            self.braking = Braking::Done;
        }
        false
    }

    /// Ends the sweep from `now` on.
    #[cold]
    #[inline(never)]
    pub(super) fn brake_sweep(&mut self, now: SubTicks) {
        let laid = self.sweeping.laid;
        let part = match self.trajectory.take_back(now) {
            Some(passed) => {
                let part = laid.cut(passed);
                if passed > SubTicks::ZERO {
                    self.sweeping.lay(&part, &mut self.trajectory);
                }
                part
            }
            None => laid,
        };
        self.sweeping.pieces.brake(part.end);
        self.braking = Braking::Slowing(SpeedSq::ZERO);
        self.group_steppers.iter_mut().for_each(|stepper| stepper.break_off(now));
    }
}
