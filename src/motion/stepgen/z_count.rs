//! The live offset of z: taken up from the Console's order as soon as z's limits leave room for it.
//!
//! Between moves it is made at once, and the next move waits for its end. During a move it begins behind the events
//! that are made already. Then it must end before the last move that the Console has queued, because a later move may
//! lift the tool. So a far way is made in several changes. Only the pieces of z's own groups are broken off.

use super::{StepGenerator, Task};
use crate::motion::trajectory::Z;
use crate::motion::z_limits::ZLimits;
use crate::port::EndstopSet;
use crate::units::SubTicks;

/// The count of the offset, which the trajectory has from the last position on.
pub(super) struct ZCount {
    /// Steps at the end of the present change, since the start.
    pub ordered: i32,
    /// The Console has not heard that they are made.
    is_under_way: bool,
    /// The machine's position is known in this epoch.
    pub is_placed: bool,
    /// The tick at which a change is made again.
    pub replay: Option<u32>,
}

impl ZCount {
    pub const fn new() -> Self {
        Self { ordered: 0, is_under_way: false, is_placed: true, replay: None }
    }
}

impl StepGenerator<'_> {
    /// Begins a change of the offset, if it is possible now. One that is made `again` is as far as it was at first.
    #[cold]
    #[inline(never)]
    pub(super) fn shift_z(&mut self, again: bool) {
        if self.trajectory.z_offset().is_moving() || !self.z_count.is_placed {
            return;
        }
        let order = self.status.z_offset();
        // All that is still to go: a change that had to be short, or was dropped, is followed by another.
        let way = order.ordered().wrapping_sub(self.z_count.ordered);
        let [speed, acceleration] = order.limits();
        let limits = ZLimits { speed, acceleration };
        let before = self.trajectory.z_offset().target();
        let now = match self.task {
            Task::Nothing if self.last_phase.is_none() => {
                let now = self.next_whole_instant();
                if !self.trajectory.z_offset_mut().begin(now, way, f32::MAX, limits) {
                    return;
                }
                // Its events must not end at the endstop of an earlier homing move.
                self.watch = EndstopSet::NONE;
                self.trajectory.rest_at(self.position, now);
                self.task = Task::ComingToRest(false);
                now
            }
            // Where an endstop is watched, a homing or probing move measures z.
            Task::Move if self.current_move.m.watch == EndstopSet::NONE => {
                let now = self.next_whole_instant();
                let tick = self.base_tick.wrapping_add(now.whole_ticks() as u32);
                let [from, until] = order.quiet();
                // Z is late by its delay, and so is the end of its last fast move. Signed, because ticks wrap.
                let since = (tick.wrapping_sub(from)).cast_signed() as f32 - self.trajectory.delay_ticks();
                let within = if again { f32::MAX } else { (until.wrapping_sub(tick)).cast_signed() as f32 };
                if since < 0.0 && !again || !self.trajectory.z_offset_mut().begin(now, way, within, limits) {
                    return;
                }
                now
            }
            _ => return,
        };
        for (stepper, group) in self.group_steppers.iter_mut().zip(self.mechanism.iter()) {
            if group.row.get(Z).is_some_and(|times| *times != 0) {
                stepper.break_off(now);
            }
        }
        let by = self.trajectory.z_offset().target().wrapping_sub(before);
        self.z_count.ordered = self.z_count.ordered.wrapping_add(by);
        self.z_count.is_under_way = true;
        order.note_change(self.base_tick.wrapping_add(now.whole_ticks() as u32), by);
    }

    /// The next instant at a whole tick: that is enough to make a change again.
    fn next_whole_instant(&self) -> SubTicks {
        SubTicks::of_ticks((self.next_instant() + SubTicks(SubTicks::of_ticks(1).0 - 1)).whole_ticks())
    }

    /// Takes up the tick of a change that is to be made again.
    pub(super) fn note_replay(&mut self) {
        self.z_count.replay = self.status.z_offset().replay_tick().map(|tick| tick.wrapping_sub(self.base_tick));
    }

    /// Makes a change again, if it is due before the next step. Where the machine rests, time does not pass for it.
    #[cold]
    #[inline(never)]
    pub(super) fn replay_shift(&mut self, due: u32) -> bool {
        let left = due.wrapping_sub(self.last_tick as u32).wrapping_sub(1).cast_signed();
        if left > 0 {
            if !matches!(self.task, Task::Move) {
                return false;
            }
            self.wait(left.cast_unsigned());
        } else if !matches!(self.task, Task::Move | Task::Nothing) {
            return false;
        }
        self.z_count.replay = None;
        self.status.z_offset().order_replay();
        self.shift_z(true);
        true
    }

    /// Tells the Console of a change that has ended. Its events are published.
    pub(super) fn tell_z_offset(&mut self) {
        if self.z_count.is_under_way && !self.trajectory.z_offset().is_moving() {
            self.z_count.is_under_way = false;
            self.status.z_offset().set_reached(self.z_count.ordered);
        }
    }

    /// Motion was dropped after this time: a change that was under way ends there, on a whole step.
    pub(super) fn drop_z_offset(&mut self, played: SubTicks) {
        let before = self.trajectory.z_offset().target();
        self.trajectory.z_offset_mut().settle(played);
        let missed = before.wrapping_sub(self.trajectory.z_offset().target());
        self.z_count.ordered = self.z_count.ordered.wrapping_sub(missed);
        (self.z_count.is_under_way, self.z_count.is_placed) = (false, false);
        let offset = self.status.z_offset();
        offset.set_reached(self.z_count.ordered);
        offset.set_epoch(self.epoch);
    }
}
