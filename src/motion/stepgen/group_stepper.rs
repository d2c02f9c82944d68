//! Group stepper: how one motor group follows the trajectory, piece by piece and step by step.

use super::step_time_buffer::StepTimeBuffer;
use super::step_time_solver::{Endpoint, StepTimeSolver};
use crate::kinematics::{Group, count_at};
use crate::motion::number::{from_f32, ticks, time};
use crate::motion::ticks::{FAR, NEAR, is_before};
use crate::motion::trajectory::phase::Curve;
use crate::motion::trajectory::{AxisState, Trajectory};
use crate::units::{Steps, SubTicks};

/// Half a step.
const HALF: i64 = 1 << 31;

/// A reversal this close to an end of a piece is ignored, in ticks.
const LEAST_TIME: f32 = 2.0;

/// One motor group.
pub(in crate::motion) struct GroupStepper {
    /// Its next steps.
    pub step_times: StepTimeBuffer,
    /// Steps of the present piece without a solved time. Rounding may leave some for the next piece.
    unsolved: u32,
    /// Whether all steps before the end of the piece are solved.
    is_piece_solved: bool,
    /// Tick of the piece's end.
    end_tick: u32,
    solver: StepTimeSolver,
    /// Whether the steps lead forward.
    is_forward: bool,
    /// The group's count after all steps of the piece.
    target_count: i32,
    /// Begin of its present piece.
    pub start: SubTicks,
    /// End of the piece; at rest its time is never.
    pub end: Endpoint,
    /// Next change of the trajectory, if the present piece ends in an earlier reversal.
    after_reversal: Option<Endpoint>,
}

/// The axes that a group follows, with their factors. The filament includes the pressure axis.
fn axes(group: &Group) -> impl Iterator<Item = (usize, i8)> {
    let [x, y, z, e] = group.row;
    [x, y, z, e, e].into_iter().enumerate().filter(|(_, times)| *times != 0)
}

/// State of a group, as a sum over its axes.
fn sum(group: &Group, trajectory: &Trajectory, at: SubTicks) -> AxisState {
    let mut sum = AxisState::at_rest(Steps::ZERO);
    for (axis, times) in axes(group) {
        let state = trajectory.state(axis, at);
        let (position, speed) = match times {
            1 => (state.position, state.speed),
            -1 => (state.position.wrapping_neg(), -state.speed),
            _ => (state.position.wrapping_mul_int(i64::from(times)), state.speed * f32::from(times)),
        };
        sum = AxisState { position: sum.position.wrapping_add(position), speed: sum.speed + speed };
    }
    sum
}

impl GroupStepper {
    /// At rest at 0.
    pub const STILL: Self = Self {
        step_times: StepTimeBuffer::NONE,
        unsolved: 0,
        is_piece_solved: true,
        end_tick: 0,
        solver: StepTimeSolver::NONE,
        is_forward: true,
        target_count: 0,
        start: SubTicks::ZERO,
        end: Endpoint { time: SubTicks::MAX, position: Steps::ZERO, speed: 0.0 },
        after_reversal: None,
    };

    /// Solves the next steps if all known ones are made and the piece continues. A group at rest stays at rest from
    /// `now`.
    #[inline(always)]
    pub fn refill(&mut self, now: u32) {
        if self.step_times.left() == 0 {
            if !self.is_piece_solved {
                self.solve();
            } else if is_before(self.step_times.known_until(), now.wrapping_add(NEAR)) {
                self.extend_rest(now);
            }
        }
    }

    #[inline(never)]
    fn extend_rest(&mut self, now: u32) {
        if self.end.time == SubTicks::MAX {
            self.step_times.begin(now);
            self.step_times.clear(now.wrapping_add(FAR));
        }
    }

    /// Whether the present piece ends at a tick with all its steps made.
    pub fn piece_ends_at(&self, tick: u32) -> bool {
        self.is_piece_solved && self.step_times.left() == 0 && self.end_tick == tick && self.end.time != SubTicks::MAX
    }

    /// Direction of the steps of its present piece, if there are any: true if the coordinate grows.
    pub fn direction(&self) -> Option<bool> {
        (self.unsolved > 0 || self.step_times.left() > 0).then_some(self.is_forward)
    }

    /// Rests at its position from a tick on.
    pub fn stop(&mut self, now: u32) {
        self.target_count = self.count();
        self.unsolved = 0;
        self.is_piece_solved = true;
        self.step_times = StepTimeBuffer::at(now);
        self.start = SubTicks::ZERO;
        self.end.time = SubTicks::MAX;
        self.after_reversal = None;
    }

    /// Rests at a position from a tick on.
    pub fn stand_at(&mut self, position: Steps, now: u32) {
        self.stop(now);
        self.target_count = count_at(position);
    }

    /// Its present piece ends at `time`.
    pub fn break_off(&mut self, time: SubTicks) {
        self.target_count = self.count();
        self.unsolved = 0;
        self.is_piece_solved = true;
        self.end.time = time;
        self.end_tick = whole(time);
        self.after_reversal = None;
        self.step_times.clear(self.end_tick);
    }

    /// Whether the trajectory is known as far as the group needs it at `time`.
    pub fn is_known(group: &Group, trajectory: &mut Trajectory, time: SubTicks) -> bool {
        axes(group).fold(true, |known, (axis, _)| trajectory.advance(axis, time) && known)
    }

    /// Continues from `time`, when no axis may need a span that is not laid yet.
    pub fn begin_next_piece(&mut self, group: &Group, trajectory: &Trajectory, time: SubTicks) {
        let state = sum(group, trajectory, time);
        let from = Endpoint { time, position: state.position, speed: state.speed };
        let change = axes(group).map(|(axis, _)| trajectory.next_change(axis)).min().unwrap_or(SubTicks::MAX);
        if change == SubTicks::MAX {
            return self.come_to_rest(from);
        }
        let state = sum(group, trajectory, change);
        let to = Endpoint { time: change, position: state.position, speed: state.speed };
        match trajectory.follows(axes(group).map(|(axis, _)| axis), time) {
            Some(span) => self.begin_piece(from, to, Some((span.curve, span.slow_share))),
            None => self.begin_way(from, to),
        }
    }

    /// Begins the motion after a reversal, if the present piece ends in one.
    pub fn begin_return(&mut self) -> bool {
        let Some(after_reversal) = self.after_reversal.take() else {
            return false;
        };
        self.begin_piece(self.end, after_reversal, None);
        true
    }

    /// Begins the motion to the next change, or only to the reversal if there is one.
    fn begin_way(&mut self, from: Endpoint, to: Endpoint) {
        if from.speed * to.speed < 0.0 {
            let all = ticks(to.time - from.time);
            let turn = all * (from.speed / (from.speed - to.speed));
            if turn > LEAST_TIME && turn < all - LEAST_TIME {
                let position = from.position.wrapping_add(from_f32(0.5 * (from.speed * turn)));
                self.begin_piece(from, Endpoint { time: from.time + time(turn), position, speed: 0.0 }, None);
                self.after_reversal = Some(to);
                return;
            }
        }
        self.begin_piece(from, to, None);
    }

    /// Begins a piece without a reversal. Its steps lead to the count at its end, unless rounding has already moved the
    /// group beyond it.
    fn begin_piece(&mut self, from: Endpoint, to: Endpoint, shape: Option<(Curve, f32)>) {
        let count = self.count();
        let target = count_at(to.position);
        let distance = to.position.wrapping_sub(from.position);
        let steps = target.wrapping_sub(count);
        self.set_bounds(from.time, to);
        if (steps > 0 && distance > Steps::ZERO) || (steps < 0 && distance < Steps::ZERO) {
            self.set_target(target, count);
            self.solver =
                StepTimeSolver::new(&from, &to, step_threshold(count, self.is_forward), self.is_forward, shape);
        } else {
            self.set_target(count, count);
        }
        self.solve();
    }

    /// Sets its steps from one count to another.
    fn set_target(&mut self, target: i32, count: i32) {
        let steps = target.wrapping_sub(count);
        (self.target_count, self.unsolved, self.is_forward) = (target, steps.unsigned_abs(), steps > 0);
    }

    /// Its count of steps.
    pub const fn count(&self) -> i32 {
        let left = self.unsolved.cast_signed().wrapping_add(self.step_times.left() as i32);
        self.target_count.wrapping_sub(if self.is_forward { left } else { left.wrapping_neg() })
    }

    fn set_bounds(&mut self, start: SubTicks, end: Endpoint) {
        self.step_times.begin(whole(start));
        self.start = start;
        self.end = end;
        self.end_tick = whole(end.time);
        self.after_reversal = None;
    }

    /// The group rests from `at` on. It makes up steps that rounding has left over at once.
    fn come_to_rest(&mut self, at: Endpoint) {
        self.set_bounds(at.time, Endpoint { time: SubTicks::MAX, ..at });
        self.end_tick = whole(at.time).wrapping_add(FAR);
        self.set_target(count_at(at.position), self.count());
        self.solver = StepTimeSolver::at_once(at.time);
        self.solve();
    }

    /// Solves its next steps.
    fn solve(&mut self) {
        let (found, is_piece_solved) = self.step_times.fill(&mut self.solver, self.unsolved, self.end_tick);
        self.unsolved -= found;
        self.is_piece_solved = is_piece_solved;
    }
}

/// Position at which a group steps from a count.
fn step_threshold(count: i32, is_forward: bool) -> Steps {
    Steps::from_bits((i64::from(count) << 32).wrapping_add(if is_forward { HALF } else { -HALF }))
}

/// The tick nearest to a time.
const fn whole(time: SubTicks) -> u32 {
    time.nearest_tick() as u32
}
