//! The live offset of z: whole steps that are added to the path of z, and changed while moves are under way (M290).
//!
//! ```text
//! speed     /\
//!          /  \         a change: evenly faster to its middle, evenly slower to its end
//!         /    \
//! -------+--+---+-----
//!        0  1   2       knots
//! ```
//!
//! A change is piecewise quadratic, as the trajectory is, so the sum of both is too. It begins and ends on whole steps:
//! all motors of z stand where they would without it, that many steps aside. Its ends are exact, so no sum drifts.

use super::span::AxisState;
use crate::motion::number::{from_f32, root, ticks, time, to_f32};
use crate::motion::z_limits::ZLimits;
use crate::units::{Steps, SubTicks};

/// The longest change in ticks: a tenth of a second. So each of its halves is a piece of usual length (`LONGEST` in
/// `span`). A farther way takes several changes.
const LONGEST: f32 = 1_000_000.0;

/// The shortest half of a change in ticks: a step takes longer with any sensible limits.
const SHORTEST_HALF: f32 = 64.0;

/// The offset, at rest or in the middle of a change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ZOffset {
    /// Begin, middle and end of the last change. At rest the offset is that of its end.
    times: [SubTicks; 3],
    /// Offsets at begin and end, in steps.
    from: i32,
    to: i32,
    /// The speed in the middle, in steps a tick.
    peak: f32,
    /// The knots that z has passed.
    passed: u8,
}

/// The number of knots.
const KNOTS: u8 = 3;

impl ZOffset {
    /// None.
    pub const NONE: Self = Self { times: [SubTicks::ZERO; 3], from: 0, to: 0, peak: 0.0, passed: KNOTS };

    /// Whether there is neither an offset nor a change.
    #[inline(always)]
    pub const fn is_none(&self) -> bool {
        self.to == 0 && self.passed == KNOTS
    }

    /// Whether z follows a change that has not ended.
    pub const fn is_moving(&self) -> bool {
        self.passed < KNOTS
    }

    /// The steps at rest, or at the end of the present change.
    pub const fn target(&self) -> i32 {
        self.to
    }

    /// Rests at so many steps.
    pub const fn rest_at(&mut self, steps: i32) {
        *self = Self { from: steps, to: steps, ..Self::NONE };
    }

    /// Begins a change by up to `way` steps at `now`. It ends within `time` ticks, so it may be shorter; false if not
    /// even a step would fit.
    pub fn begin(&mut self, now: SubTicks, way: i32, within: f32, limits: ZLimits) -> bool {
        let half = 0.5 * if within < LONGEST { within } else { LONGEST };
        let ZLimits { speed, acceleration } = limits;
        // In the time of a half: by the acceleration, and by the speed in the middle.
        let (by_acceleration, by_speed) = (acceleration * (half * half), speed * half);
        let most = if by_acceleration < by_speed { by_acceleration } else { by_speed };
        let steps = (most as u32).min(way.unsigned_abs());
        if half < SHORTEST_HALF || steps == 0 {
            return false;
        }
        // Back from whole steps to their time. Both limits rise with the steps, so it is no longer than `half`.
        let (needed, slowest) = (root(steps as f32 / acceleration), steps as f32 / speed);
        let needed = if needed > slowest { needed } else { slowest };
        let half = time(if needed > SHORTEST_HALF { needed } else { SHORTEST_HALF });
        let by = if way < 0 { steps.cast_signed().wrapping_neg() } else { steps.cast_signed() };
        *self = Self {
            times: [now, now + half, now + half + half],
            from: self.to,
            to: self.to.wrapping_add(by),
            peak: by as f32 / ticks(half),
            passed: 1,
        };
        true
    }

    /// Z has come to `time`.
    #[inline(always)]
    pub fn advance(&mut self, time: SubTicks) {
        while self.times.get(usize::from(self.passed)).is_some_and(|knot| *knot <= time) {
            self.passed += 1;
        }
    }

    /// The next knot; `SubTicks::MAX` at rest.
    #[inline(always)]
    pub fn next_change(&self) -> SubTicks {
        self.times.get(usize::from(self.passed)).copied().unwrap_or(SubTicks::MAX)
    }

    /// Offset and speed at a time.
    pub fn state(&self, time: SubTicks) -> AxisState {
        let [begin, middle, end] = self.times;
        let (from, to) = (Steps::wrapping_from_num(self.from.into()), Steps::wrapping_from_num(self.to.into()));
        let at = |elapsed: SubTicks| {
            let share = ticks(elapsed) / ticks(middle - begin);
            let half = 0.5 * to_f32(to.wrapping_sub(from));
            (from_f32(half * (share * share)), self.peak * share)
        };
        if time >= end {
            AxisState::at_rest(to)
        } else if time <= begin {
            AxisState::at_rest(from)
        } else if time <= middle {
            let (gone, speed) = at(time - begin);
            AxisState { position: from.wrapping_add(gone), speed }
        } else {
            let (left, speed) = at(end - time);
            AxisState { position: to.wrapping_sub(left), speed }
        }
    }

    /// Stops at the whole step next to where it is at a time.
    pub fn settle(&mut self, time: SubTicks) {
        let at = self.state(time).position.wrapping_round();
        self.rest_at(at.to_num());
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// 10 mm/s and 100 mm/s2 at 800 steps/mm.
    const LIMITS: ZLimits = ZLimits { speed: 8e-4, acceleration: 8e-10 };

    fn now() -> SubTicks {
        SubTicks((1 << 45) + 0x1234)
    }

    /// The offset at rest, and the end of its change.
    fn made(way: i32, within: f32) -> Option<(ZOffset, SubTicks)> {
        let mut offset = ZOffset::NONE;
        offset.begin(now(), way, within, LIMITS).then(|| (offset, offset.times[2]))
    }

    #[test]
    fn a_change_ends_on_its_step_and_keeps_to_the_limits() {
        for way in [1, -1, 7, 40, -200] {
            let (mut offset, end) = made(way, f32::MAX).unwrap();
            let time = ticks(end - now());
            let (mut last, mut pieces) = (offset.state(now()), 0);
            assert_eq!(last, AxisState::at_rest(Steps::ZERO));
            while offset.is_moving() {
                let knot = offset.next_change();
                let state = offset.state(knot);
                assert!(state.speed.abs() <= LIMITS.speed * 1.0001, "{way}: {state:?}");
                let rise = (state.speed - last.speed).abs() / (0.5 * time);
                assert!(rise <= LIMITS.acceleration * 1.0001, "{way}: {rise}");
                // The sum of even changes of speed is the way.
                let mean = 0.5 * (state.speed + last.speed) * (0.5 * time);
                let gone = to_f32(state.position.wrapping_sub(last.position));
                assert!((mean - gone).abs() < 1e-3, "{way}: {mean} {gone}");
                offset.advance(knot);
                (last, pieces) = (state, pieces + 1);
            }
            assert_eq!(
                (offset.state(end), offset.target(), pieces),
                (AxisState::at_rest(Steps::from_num(way)), way, 2)
            );
            assert_eq!(offset.next_change(), SubTicks::MAX);
        }
    }

    #[test]
    fn a_change_is_as_far_as_its_time_allows() {
        // 0.8e-9 * (2.5e5)^2 = 50 steps in 50 ms.
        let (offset, end) = made(1000, 500_000.0).unwrap();
        assert_eq!(offset.target(), 50);
        assert!(ticks(end - now()) <= 500_000.0);
        // A single step takes 7.1 ms.
        assert!(made(1000, 70_000.0).is_none());
        assert!(made(1000, 71_000.0).is_some_and(|(offset, _)| offset.target() == 1));
        assert!(made(0, f32::MAX).is_none());
        assert!(made(5, -3.0).is_none());
    }

    #[test]
    fn stopped_in_the_middle_it_rests_on_a_whole_step() {
        let (mut offset, end) = made(-40, f32::MAX).unwrap();
        let middle = SubTicks(now().0.midpoint(end.0));
        offset.settle(middle);
        assert_eq!((offset.target(), offset.is_moving()), (-20, false));
        assert_eq!(offset.state(SubTicks::ZERO), AxisState::at_rest(Steps::from_num(-20)));
    }
}
