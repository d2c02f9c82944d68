//! Tracks: the way of one motor group along the trajectory, step by step.

use super::crossing::{Crossings, Edge};
use super::number::{from_f32, ticks, time};
use super::phase::Curve;
use super::trajectory::{State, Trajectory};
use crate::kinematics::{Group, count_at};
use crate::units::Steps;

/// Two pulses of a motor are at least this many ticks apart: 1 us, ten times what the driver asks for
/// (TMC2209 datasheet rev 1.09, section 13.1: STEP high and low 100 ns each). Motion at legal speeds is at
/// most half as dense; a motor that reverses within half a step can come near it.
pub const MIN_STEP_INTERVAL: u64 = 10;

/// Half a step.
const HALF: i64 = 1 << 31;

/// A reversal this near to an end of a piece is none, in ticks.
const LEAST_TIME: f32 = 2.0;

/// What a group does next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Next {
    /// Nothing: it rests.
    Nothing,
    /// A step.
    Step,
    /// Its way goes on otherwise.
    Change,
}

/// One motor group.
pub(super) struct Track {
    /// The group's count of steps.
    pub count: i32,
    /// What it does next.
    pub next: Next,
    /// The tick at which it does that.
    pub due: u32,
    /// Steps left in its present piece.
    left: u32,
    /// Whether they lead forward.
    pub is_forward: bool,
    /// When its next step may come at the earliest.
    free: u32,
    crossings: Crossings,
    /// When its present piece began.
    pub start: u64,
    /// Where it ends.
    pub end: Edge,
    /// The tick at which it ends.
    ends: u32,
    /// Where the trajectory next changes, if the present piece ends before in a reversal.
    beyond: Option<Edge>,
}

/// The axes that a group follows, and how many times; with the filament comes the pressure that it needs.
fn axes(group: &Group) -> impl Iterator<Item = (usize, i8)> {
    let [x, y, z, e] = group.row;
    [x, y, z, e, e].into_iter().enumerate().filter(|(_, times)| *times != 0)
}

/// The state of a group, as a sum of the axes'.
fn sum(group: &Group, trajectory: &Trajectory, at: u64) -> State {
    let mut sum = State::rest(Steps::ZERO);
    for (axis, times) in axes(group) {
        let state = trajectory.state(axis, at);
        let (position, speed) = match times {
            1 => (state.position, state.speed),
            -1 => (state.position.wrapping_neg(), -state.speed),
            _ => (state.position.wrapping_mul_int(i64::from(times)), state.speed * f32::from(times)),
        };
        sum = State { position: sum.position.wrapping_add(position), speed: sum.speed + speed };
    }
    sum
}

impl Track {
    /// At rest at 0.
    pub fn still() -> Self {
        Self {
            count: 0,
            next: Next::Nothing,
            due: 0,
            left: 0,
            is_forward: true,
            free: 0,
            crossings: Crossings::NONE,
            start: 0,
            end: Edge { time: u64::MAX, position: Steps::ZERO, speed: 0.0 },
            ends: 0,
            beyond: None,
        }
    }

    /// Rests where it is.
    pub fn stop(&mut self) {
        self.next = Next::Nothing;
        self.left = 0;
        self.free = 0;
        self.start = 0;
        self.end.time = u64::MAX;
        self.beyond = None;
    }

    /// Rests at a position.
    pub fn stand_at(&mut self, position: Steps) {
        self.stop();
        self.count = count_at(position);
    }

    /// Its present piece ends at `time`.
    pub fn break_off(&mut self, time: u64) {
        self.left = 0;
        self.end.time = time;
        self.ends = whole(time);
        self.beyond = None;
        self.plan_next();
    }

    /// Whether the trajectory is known as far as the group needs it at `time`.
    pub fn is_known(group: &Group, trajectory: &mut Trajectory, time: u64) -> bool {
        axes(group).fold(true, |known, (axis, _)| trajectory.advance(axis, time) && known)
    }

    /// Goes on from `time`, at which no axis may need a span that is not laid yet.
    pub fn go_on(&mut self, group: &Group, trajectory: &Trajectory, time: u64) {
        let state = sum(group, trajectory, time);
        let from = Edge { time, position: state.position, speed: state.speed };
        let change = axes(group).map(|(axis, _)| trajectory.next_change(axis)).min().unwrap_or(u64::MAX);
        if change == u64::MAX {
            return self.come_to_rest(from);
        }
        let state = sum(group, trajectory, change);
        let to = Edge { time: change, position: state.position, speed: state.speed };
        match trajectory.follows(axes(group).map(|(axis, _)| axis), time) {
            Some(span) => self.follow(from, to, Some((span.curve, span.slow_share))),
            None => self.lay(from, to),
        }
    }

    /// Goes on behind a reversal, if its present piece ends in one.
    pub fn go_back(&mut self) -> bool {
        let Some(beyond) = self.beyond.take() else {
            return false;
        };
        self.follow(Edge { speed: 0.0, ..self.end }, beyond, None);
        true
    }

    /// The way to the next change, which may lead there and back.
    fn lay(&mut self, from: Edge, to: Edge) {
        if from.speed * to.speed < 0.0 {
            let all = ticks(to.time - from.time);
            let turn = all * (from.speed / (from.speed - to.speed));
            if turn > LEAST_TIME && turn < all - LEAST_TIME {
                let position = from.position.wrapping_add(from_f32(0.5 * (from.speed * turn)));
                self.follow(from, Edge { time: from.time + time(turn), position, speed: 0.0 }, None);
                self.beyond = Some(to);
                return;
            }
        }
        self.follow(from, to, None);
    }

    fn follow(&mut self, from: Edge, to: Edge, shape: Option<(Curve, f32)>) {
        let goal = count_at(to.position).wrapping_sub(self.count);
        let ahead = to.position.wrapping_sub(from.position);
        self.begin(from.time, to);
        let leads_there = (goal > 0 && ahead > Steps::ZERO) || (goal < 0 && ahead < Steps::ZERO);
        self.left = if leads_there { goal.unsigned_abs() } else { 0 };
        if self.left > 0 {
            self.is_forward = goal > 0;
            self.crossings = Crossings::new(&from, &to, self.edge(), self.is_forward, shape);
        }
        self.plan_next();
    }

    fn begin(&mut self, start: u64, end: Edge) {
        let tick = whole(start);
        if is_before(self.free, tick) {
            self.free = tick;
        }
        self.start = start;
        self.end = end;
        self.ends = whole(end.time);
        self.beyond = None;
    }

    /// The position at which the next step is due.
    fn edge(&self) -> Steps {
        Steps::from_bits((i64::from(self.count) << 32).wrapping_add(if self.is_forward { HALF } else { -HALF }))
    }

    /// What rounding has left over is made up at once.
    fn come_to_rest(&mut self, at: Edge) {
        let goal = count_at(at.position).wrapping_sub(self.count);
        self.begin(at.time, Edge { time: u64::MAX, ..at });
        self.left = goal.unsigned_abs();
        self.is_forward = goal > 0;
        self.crossings = Crossings::at_once(at.time);
        self.plan_next();
    }

    /// The next step was made, at its tick.
    pub fn step(&mut self) {
        self.count = self.count.wrapping_add(if self.is_forward { 1 } else { -1 });
        self.free = self.due.wrapping_add(MIN_STEP_INTERVAL as u32);
        self.left -= 1;
        self.plan_next();
    }

    fn plan_next(&mut self) {
        if self.left > 0 {
            let due = self.crossings.next();
            self.due = if is_before(due, self.free) { self.free } else { due };
            self.next = Next::Step;
            if self.end.time == u64::MAX || is_before(self.due, self.ends) {
                return;
            }
        }
        // Steps on the boundary between two pieces belong to the later one, where they meet those of other groups.
        self.next = if self.end.time == u64::MAX { Next::Nothing } else { Next::Change };
        self.due = self.ends;
    }
}

/// The tick nearest to a time.
const fn whole(time: u64) -> u32 {
    (time.saturating_add(1 << 15) >> 16) as u32
}

/// Whether a tick comes before another; they wrap.
const fn is_before(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}
