//! Entries: takes work out of the MoveQueue, lays it as spans, and handles the end of motion.

use super::alignment::Alignment;
use super::brake::{Braking, PathPoint};
use super::group_stepper::GroupStepper;
use super::{StepGenerator, Task};
use crate::kinematics::{Grouping, count_at};
use crate::motion::work::Work;
use crate::port::EndstopSet;
use crate::units::{SpeedSq, Steps, SubTicks};

/// Whether a span was laid.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum LayResult {
    Laid,
    /// Motion ends here.
    AtRest,
    /// Motion should continue, but no work has arrived.
    Starved,
}

impl StepGenerator<'_> {
    /// Lays the next span of the trajectory.
    pub(super) fn lay_more(&mut self) -> LayResult {
        loop {
            if matches!(self.task, Task::Move | Task::Brake(_))
                && let Some(added) = self.current_move.lay_next(&mut self.trajectory)
            {
                if added > SubTicks::ZERO {
                    self.status.count_squeezed(added.whole_ticks() as u32);
                }
                return LayResult::Laid;
            }
            match self.task {
                Task::Sweep => {
                    if self.lay_sweep() {
                        return LayResult::Laid;
                    }
                }
                Task::Move => {
                    let rests = self.current_move.m.rests;
                    self.position = self.current_move.last;
                    self.last_phase = if rests { None } else { self.current_move.last_phase() };
                    if rests {
                        self.task = Task::ComingToRest(true);
                    } else {
                        self.finish();
                    }
                }
                Task::Brake(left_sq) => {
                    // Not the planned end of the move: braking may end anywhere on its path.
                    self.position = self.trajectory.end().position;
                    if left_sq == SpeedSq::ZERO {
                        self.task = Task::ComingToRest(true);
                    } else {
                        self.finish();
                    }
                    self.continue_brake(left_sq);
                }
                Task::ComingToRest(_) | Task::Dwell(_) => return LayResult::AtRest,
                Task::Nothing => {
                    if !self.next_entry() {
                        return if self.last_phase.is_none() { LayResult::AtRest } else { LayResult::Starved };
                    }
                }
            }
        }
    }

    pub(super) fn finish(&mut self) {
        self.task = Task::Nothing;
        // A context that sees the entry done must see its events made.
        self.publish();
        self.status.entry_done();
    }

    /// Takes the next entry; false if there is none.
    pub(super) fn next_entry(&mut self) -> bool {
        let Some(entry) = self.moves.peek() else {
            return false;
        };
        // Work that will not be made counts as done, too: the Console waits until as many entries are done as it has
        // queued.
        if entry.epoch != self.epoch || self.has_met_endstop() || self.braking == Braking::Done {
            self.moves.dequeue();
            self.status.entry_done();
            return true;
        }
        let is_done = match &entry.work {
            Work::Move(m) => {
                self.watch = m.watch;
                let offset = self.trajectory.z_offset();
                // Behind a shaper the motors are still on their way, so their counts do not tell where they will stand.
                let is_there = self.trajectory.is_prompt() && !offset.is_moving();
                let aside = [Steps::ZERO, Steps::ZERO, Steps::wrapping_from_num(offset.target().into()), Steps::ZERO];
                let counts = is_there.then(|| {
                    let mut counts = self.group_steppers.each_ref().map(GroupStepper::count);
                    // The live offset is in the counts, and not in the planned positions with which these are compared.
                    for (count, group) in counts.iter_mut().zip(self.mechanism.iter()).filter(|_| !offset.is_none()) {
                        *count = count.wrapping_sub(count_at(group.coordinate(aside)));
                    }
                    counts
                });
                let ends =
                    self.alignment.ends(m, &self.position, counts, self.mechanism, !self.trajectory.has_surface());
                // At most half a step, to the line on which the motors stand already.
                if ends.0 != self.position {
                    self.position = ends.0;
                    self.trajectory.shift(&self.position);
                }
                self.current_move.take_up(m, &ends);
                match self.braking {
                    // The stop began in an earlier move, which was too short for it.
                    Braking::Slowing(speed_sq) => self.brake(PathPoint { covered: 0, speed_sq }),
                    Braking::No | Braking::Done => self.task = Task::Move,
                }
                false
            }
            Work::Sweep(sweep) => {
                self.watch = EndstopSet::NONE;
                self.sweeping.begin(sweep, self.position);
                self.task = Task::Sweep;
                false
            }
            Work::Dwell(time) => {
                self.watch = EndstopSet::NONE;
                self.task = Task::Dwell(SubTicks::of_ticks(self.last_tick) + *time);
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
            Work::Surface(frame) => {
                self.trajectory.follow_surface(*frame);
                true
            }
            Work::Heights(row, heights) => {
                self.trajectory.set_heights(usize::from(*row), *heights);
                true
            }
            Work::Regroup(grouping) => {
                let grouping = *grouping;
                self.regroup(grouping);
                true
            }
            Work::Position([x, y, z, e]) => {
                self.position = [*x, *y, *z, *e, Steps::ZERO];
                // It is in the counts of this position.
                self.trajectory.z_offset_mut().rest_at(0);
                self.z_count.is_placed = true;
                self.alignment.stand_at([*x, *y, *z]);
                let real = self.trajectory.to_real([*x, *y, *z, *e]);
                let steppers = self.group_steppers.iter_mut().zip(&mut self.published);
                for ((stepper, published), group) in steppers.zip(self.mechanism.iter()) {
                    let before = stepper.count();
                    stepper.stand_at(group.coordinate(real), self.last_tick as u32);
                    // A new name for a position is not a step.
                    *published = published.wrapping_add(stepper.count().wrapping_sub(before));
                }
                true
            }
        };
        // Only now: the entry was read in its place, which the Console may fill again from here on.
        self.moves.dequeue();
        if is_done {
            self.status.entry_done();
        }
        true
    }

    /// Rare, and kept out of the way of moves.
    #[cold]
    #[inline(never)]
    fn regroup(&mut self, grouping: Grouping) {
        self.mechanism = self.groupings.of(grouping);
        self.alignment = Alignment::new(self.mechanism);
        // The step pins have the new coupling already.
        self.events.set_slow_groups(self.status.slow_groups());
    }

    /// All motors are at rest. Ends the task that waited for this, or begins the next one; false if there is none.
    pub(super) fn go_on_from_rest(&mut self) -> bool {
        match self.task {
            Task::Nothing => {
                if !self.next_entry() {
                    return false;
                }
                if matches!(self.task, Task::Move | Task::Brake(_) | Task::Sweep) {
                    let now = SubTicks::of_ticks(self.last_tick);
                    self.trajectory.rest_at(self.position, now);
                    self.group_steppers.iter_mut().for_each(|stepper| stepper.break_off(now));
                }
            }
            // At a standstill an event without steps marks the end of the motion: time is whole there, and the Stepper
            // knows that nothing is missing.
            Task::ComingToRest(ends_entry) => {
                let before = self.events.made();
                if self.pass_until(self.trajectory.rest_time()) {
                    if self.events.made() == before {
                        self.wait(0);
                    }
                    (self.task, self.is_under_way) = (Task::Nothing, false);
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
            // The motors are moving from the begin of a move.
            Task::Move | Task::Brake(_) | Task::Sweep => {}
        }
        true
    }
}
