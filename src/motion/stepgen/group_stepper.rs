//! Group stepper: how one motor group follows the trajectory, piece by piece and step by step.

use super::step_time_buffer::StepTimeBuffer;
use super::step_time_solver::{Endpoint, StepTimeSolver};
use crate::kinematics::{Group, count_at};
use crate::motion::number::{from_f32, ticks, time, to_f32};
use crate::motion::ticks::{FAR, NEAR, is_before};
use crate::motion::trajectory::phase::Curve;
use crate::motion::trajectory::{AxisState, Trajectory};
use crate::units::{Steps, SubTicks};

/// Half a step.
const HALF: i64 = 1 << 31;

/// A reversal this close to an end of a piece is ignored, in ticks.
const LEAST_TIME: f32 = 2.0;

/// On a surface a piece is a quadratic as far as these say, in steps. Its way differs from the way at its mean speed by
/// up to the first. A quadratic with the right speed at one end is then wrong by 8/27 of it. In between it differs by
/// up to the second from the cubic with the right speeds at both ends. Measured together: 0.2 steps
/// (docs/explanation/surface.md).
const MOST_UNEVEN: f32 = 0.4;
const MOST_BENT: f32 = 0.08;

/// A shorter piece, in ticks, is not looked at in its middle: 2 ms. Where the surface ends its slope jumps, in which a
/// speed of z that jumps by 1.9 mm/s is off by up to 0.4 steps.
const SHORT: f32 = 20_000.0;

/// A longer piece is looked at in its quarters, too: 8 ms.
const LONG: f32 = 80_000.0;

/// A shorter piece is not divided any more: 0.2 ms, in which a slope of 0.1 and 20 m/s2 bend the way by 0.01 um.
const SHORTEST_BENT: f32 = 2000.0;

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
    let [x, y, z, e] = group.row;
    // Not `axes`: at the least size its filter is called for each axis, and this runs for each piece.
    for (axis, times) in [x, y, z, e, e].iter().copied().enumerate() {
        if times == 0 {
            continue;
        }
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

/// Where a group is at a time.
fn endpoint(group: &Group, trajectory: &Trajectory, time: SubTicks) -> Endpoint {
    let AxisState { position, speed } = sum(group, trajectory, time);
    Endpoint { time, position, speed }
}

/// The end of a piece that begins at `from`, no later than `to`: so early that a quadratic is right. Each look ahead
/// halves the time.
#[inline(never)]
fn unbent(group: &Group, trajectory: &Trajectory, from: &Endpoint, to: Endpoint) -> Endpoint {
    let mut to = to;
    loop {
        let time = ticks(to.time - from.time);
        let way = to_f32(to.position.wrapping_sub(from.position));
        // With a speed that changes evenly, the way is that of the mean speed.
        let has_even_speed = (way - 0.5 * ((from.speed + to.speed) * time)).abs() < MOST_UNEVEN;
        if time < SHORTEST_BENT || (has_even_speed && time < SHORT) {
            return to;
        }
        let at =
            |quarters: u64| endpoint(group, trajectory, from.time + SubTicks((to.time - from.time).0 / 4 * quarters));
        let is_on_cubic = |point: &Endpoint, part: f32| {
            let left = 1.0 - part;
            // Hermite's cubic: `way (3 p^2 - 2 p^3) + T p (1 - p) (v0 (1 - p) - v1 p)`.
            let bent = (from.speed * left - to.speed * part) * (part * left * time);
            let expected = way * (part * part * (3.0 - (part + part))) + bent;
            (to_f32(point.position.wrapping_sub(from.position)) - expected).abs() < MOST_BENT
        };
        let middle = at(2);
        // A deviation that is odd about the middle is 0 there, so a long piece is looked at in its quarters, too.
        if has_even_speed
            && is_on_cubic(&middle, 0.5)
            && (time < LONG || (is_on_cubic(&at(1), 0.25) && is_on_cubic(&at(3), 0.75)))
        {
            return to;
        }
        to = middle;
    }
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
        self.step_times.restart(now);
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
        let from = endpoint(group, trajectory, time);
        let change = axes(group).map(|(axis, _)| trajectory.next_change(axis)).min().unwrap_or(SubTicks::MAX);
        if change == SubTicks::MAX {
            return self.come_to_rest(from);
        }
        let to = endpoint(group, trajectory, change);
        if group.row[2] != 0 && trajectory.has_surface() {
            return self.begin_way(from, unbent(group, trajectory, &from, to));
        }
        match trajectory.follows(axes(group).map(|(axis, _)| axis), time) {
            Some(span) => self.begin_piece(from, to, Some((span.curve(), span.slow_share()))),
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
            // Where a speed that changes evenly is 0. Up to there the mean speed is half of the first.
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
        // `refill` solves it.
        self.is_piece_solved = false;
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
        // `refill` solves it.
        self.is_piece_solved = false;
    }

    /// Solves its next steps.
    #[inline(always)]
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
