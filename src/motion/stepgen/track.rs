//! Tracks: the way of one motor group along the trajectory, step by step.

use super::ahead::{Ahead, is_before};
use super::crossing::{Crossings, Edge};
use crate::kinematics::{Group, count_at};
use crate::motion::number::{from_f32, ticks, time};
use crate::motion::trajectory::phase::Curve;
use crate::motion::trajectory::{State, Trajectory};
use crate::units::Steps;

/// Between the ticks of two pulses of a motor there are at least so many: 1.7 us. Motion at legal speeds is less dense
/// (2 us); a motor that reverses within half a step can come near it.
pub const MIN_STEP_INTERVAL: u64 = 17;

/// Half a step.
const HALF: i64 = 1 << 31;

/// What rests is known to rest for so many ticks from now: 3 s, far longer than the longest span.
const FAR: u32 = 1 << 25;

/// Less than that: until when a group rests is only looked at when it is so near. Time passes in events of so many ticks
/// where motors are under way for longer without a step.
pub(in crate::motion) const NEAR: u32 = FAR / 2;

/// A reversal this near to an end of a piece is none, in ticks.
const LEAST_TIME: f32 = 2.0;

/// One motor group.
pub(in crate::motion) struct Track {
    /// Its next steps.
    pub ahead: Ahead,
    /// Steps of its present piece that are not among them, and whether none of these comes before the piece ends.
    left: u32,
    is_over: bool,
    /// The tick at which it ends.
    ends: u32,
    crossings: Crossings,
    /// Whether the steps lead forward.
    is_forward: bool,
    /// The group's count of steps when none are left.
    goal: i32,
    /// When its present piece began.
    pub start: u64,
    /// Where it ends.
    pub end: Edge,
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
    pub const STILL: Self = Self {
        ahead: Ahead::NONE,
        left: 0,
        is_over: true,
        ends: 0,
        crossings: Crossings::NONE,
        is_forward: true,
        goal: 0,
        start: 0,
        end: Edge { time: u64::MAX, position: Steps::ZERO, speed: 0.0 },
        beyond: None,
    };

    /// Finds its next steps, if all were made that were known, and it does not end there. If it rests, it goes on resting
    /// from `now`.
    #[inline(always)]
    pub fn look_ahead(&mut self, now: u32) {
        if self.ahead.left() == 0 {
            if !self.is_over {
                self.find_steps();
            } else if is_before(self.ahead.until(), now.wrapping_add(NEAR)) {
                self.rest_on(now);
            }
        }
    }

    #[inline(never)]
    fn rest_on(&mut self, now: u32) {
        if self.end.time == u64::MAX {
            self.ahead.begin(now);
            self.ahead.clear(now.wrapping_add(FAR));
        }
    }

    /// Whether its way goes on otherwise at a tick, up to which it is known.
    pub const fn changes_at(&self, tick: u32) -> bool {
        self.is_over && self.ahead.left() == 0 && self.ends == tick && self.end.time != u64::MAX
    }

    /// Whether its coordinate grows with the steps of its present piece, if there are any.
    pub fn direction(&self) -> Option<bool> {
        (self.left > 0 || self.ahead.left() > 0).then_some(self.is_forward)
    }

    /// Rests where it is from a tick on.
    pub fn stop(&mut self, now: u32) {
        self.goal = self.count();
        self.left = 0;
        self.is_over = true;
        self.ahead = Ahead::at(now);
        self.start = 0;
        self.end.time = u64::MAX;
        self.beyond = None;
    }

    /// Rests at a position from a tick on.
    pub fn stand_at(&mut self, position: Steps, now: u32) {
        self.stop(now);
        self.goal = count_at(position);
    }

    /// Its present piece ends at `time`.
    pub fn break_off(&mut self, time: u64) {
        self.goal = self.count();
        self.left = 0;
        self.is_over = true;
        self.end.time = time;
        self.ends = whole(time);
        self.beyond = None;
        self.ahead.clear(self.ends);
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
        let count = self.count();
        let goal = count_at(to.position);
        let ahead = to.position.wrapping_sub(from.position);
        let way = goal.wrapping_sub(count);
        self.begin(from.time, to);
        if (way > 0 && ahead > Steps::ZERO) || (way < 0 && ahead < Steps::ZERO) {
            self.lead_to(goal, count);
            self.crossings = Crossings::new(&from, &to, edge(count, self.is_forward), self.is_forward, shape);
        } else {
            self.lead_to(count, count);
        }
        self.find_steps();
    }

    /// Its steps lead from one count to another.
    fn lead_to(&mut self, goal: i32, count: i32) {
        let way = goal.wrapping_sub(count);
        (self.goal, self.left, self.is_forward) = (goal, way.unsigned_abs(), way > 0);
    }

    /// Its count of steps.
    pub const fn count(&self) -> i32 {
        let left = self.left.cast_signed().wrapping_add(self.ahead.left() as i32);
        self.goal.wrapping_sub(if self.is_forward { left } else { left.wrapping_neg() })
    }

    fn begin(&mut self, start: u64, end: Edge) {
        self.ahead.begin(whole(start));
        self.start = start;
        self.end = end;
        self.ends = whole(end.time);
        self.beyond = None;
    }

    /// What rounding has left over is made up at once.
    fn come_to_rest(&mut self, at: Edge) {
        self.begin(at.time, Edge { time: u64::MAX, ..at });
        self.ends = whole(at.time).wrapping_add(FAR);
        self.lead_to(count_at(at.position), self.count());
        self.crossings = Crossings::at_once(at.time);
        self.find_steps();
    }

    /// Finds its next steps.
    fn find_steps(&mut self) {
        let (found, is_over) = self.ahead.fill(&mut self.crossings, self.left, self.ends);
        self.left -= found;
        self.is_over = is_over;
    }
}

/// The position at which a group steps on from a count.
fn edge(count: i32, is_forward: bool) -> Steps {
    Steps::from_bits((i64::from(count) << 32).wrapping_add(if is_forward { HALF } else { -HALF }))
}

/// The tick nearest to a time.
const fn whole(time: u64) -> u32 {
    (time.saturating_add(1 << 15) >> 16) as u32
}
