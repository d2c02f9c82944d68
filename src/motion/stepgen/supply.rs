//! Supply: where the spans of the trajectory come from, and what the end of motion means.

use super::brake::{Braking, Moment};
use super::track::Track;
use super::{StepGenerator, Task};
use crate::motion::moves::Work;
use crate::port::EndstopSet;
use crate::units::Steps;

/// Whether there was more to lay.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Supply {
    Laid,
    /// Motion ends here.
    Rests,
    /// Motion goes on, but nobody has said how.
    Starved,
}

impl StepGenerator<'_> {
    /// Lays the next span of the trajectory.
    pub(super) fn lay_more(&mut self) -> Supply {
        loop {
            if matches!(self.task, Task::Move | Task::Brake(_))
                && let Some(added) = self.course.lay_next(&mut self.trajectory)
            {
                if added > 0 {
                    self.status.count_squeezed((added >> 16) as u32);
                }
                return Supply::Laid;
            }
            match self.task {
                Task::Move => {
                    let rests = self.course.m.rests;
                    self.place = self.course.last;
                    self.behind = if rests { None } else { self.course.tail() };
                    if rests {
                        self.task = Task::Settling(true);
                    } else {
                        self.finish();
                    }
                }
                Task::Brake(rest) => {
                    self.place = self.trajectory.end().place;
                    if rest == 0 {
                        self.task = Task::Settling(true);
                    } else {
                        self.finish();
                    }
                    self.go_on_with(rest);
                }
                Task::Settling(_) | Task::Dwell(_) => return Supply::Rests,
                Task::Nothing => {
                    if !self.next_entry() {
                        return if self.behind.is_none() { Supply::Rests } else { Supply::Starved };
                    }
                }
            }
        }
    }

    pub(super) fn finish(&mut self) {
        self.task = Task::Nothing;
        // Who sees the entry done must see its events made.
        self.publish();
        self.status.entry_done();
    }

    /// Takes the next entry; false if there is none.
    pub(super) fn next_entry(&mut self) -> bool {
        let Some(entry) = self.moves.peek() else {
            return false;
        };
        if entry.epoch != self.epoch || self.has_met_endstop() || self.braking == Braking::Done {
            self.moves.dequeue();
            self.status.entry_done();
            return true;
        }
        let is_done = match &entry.work {
            Work::Move(m) => {
                self.watch = m.watch;
                let counts = (self.trajectory.is_prompt()).then(|| self.tracks.each_ref().map(Track::count));
                let ends = self.alignment.ends(m, &self.place, counts, self.mechanism);
                if ends.0 != self.place {
                    self.place = ends.0;
                    self.trajectory.shift(&self.place);
                }
                self.course.take_up(m, &ends);
                match self.braking {
                    Braking::Slowing(square) => self.brake(Moment { done: 0, square }),
                    Braking::No | Braking::Done => self.task = Task::Move,
                }
                false
            }
            Work::Dwell(time) => {
                self.watch = EndstopSet::NONE;
                self.task = Task::Dwell((self.last << 16) + time);
                false
            }
            Work::Follow(axis, taps) => {
                self.trajectory.follow(usize::from(*axis), taps);
                true
            }
            Work::Stiffen(axis, stiffening) => {
                self.trajectory.stiffen(usize::from(*axis), *stiffening);
                true
            }
            Work::Position([x, y, z, e]) => {
                self.place = [*x, *y, *z, *e, Steps::ZERO];
                self.alignment.stand_at([*x, *y, *z]);
                let tracks = self.tracks.iter_mut().zip(&mut self.told);
                for ((track, told), group) in tracks.zip(self.mechanism.iter()) {
                    let before = track.count();
                    track.stand_at(group.coordinate([*x, *y, *z, *e]), self.last as u32);
                    // A new name for a place is no step.
                    *told = told.wrapping_add(track.count().wrapping_sub(before));
                }
                true
            }
        };
        self.moves.dequeue();
        if is_done {
            self.status.entry_done();
        }
        true
    }

    /// All motors rest. Ends what that was waited for, or begins what comes next; false if nothing does.
    pub(super) fn rest(&mut self) -> bool {
        match self.task {
            Task::Nothing => {
                if !self.next_entry() {
                    return false;
                }
                if matches!(self.task, Task::Move | Task::Brake(_)) {
                    let now = self.last << 16;
                    self.trajectory.settle(self.place, now);
                    self.tracks.iter_mut().for_each(|track| track.break_off(now));
                }
            }
            // At a standstill an event without steps marks the end of the motion: time is whole there, and the Stepper knows
            // that nothing is missing.
            Task::Settling(ends_entry) => {
                let before = self.events.made();
                if self.pass_until(self.trajectory.settles()) {
                    if self.events.made() == before {
                        self.wait(0);
                    }
                    self.task = Task::Nothing;
                    if ends_entry {
                        self.finish();
                    }
                    if self.braking == Braking::Done {
                        self.status.set_stopped(Some(self.epoch));
                    }
                }
            }
            Task::Dwell(until) => {
                if self.pass_until(until) {
                    self.finish();
                }
            }
            // Their motors are under way from the moment at which they begin.
            Task::Move | Task::Brake(_) => {}
        }
        true
    }
}
