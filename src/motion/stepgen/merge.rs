//! Merging: the steps of all groups in the order of their ticks, as events.
//!
//! An example with three groups that step. All steps up to the tick 30 (`until`) are known, and no other group steps
//! earlier.
//!
//! ```text
//! tick        10   12   14   16   18   20   22   24   26   28   30
//! first  (a)   x         x         x              x         x
//! second (b)   x              x              x              x
//! third  (c)                       x                             x
//! event       ab    .    a    b   ac    .    b    a    .   ab   |
//! ```
//!
//! The first two groups, the belts, are merged in rows up to `stop`, the next step of the third group: at first the
//! tick 18, then 30. Before 18 these are a pair at 10, `a` at 14 and `b` at 16. A row of one belt's steps ends where
//! the other belt steps. At 18 the third group's step is added together with `a`'s step. Merging continues up to
//! `limit`: the earliest of `until`, the first step of a fourth group, and the tick after which enough events are made.

use super::StepGenerator;
use super::group_stepper::GroupStepper;
use crate::kinematics::Groups;
use crate::motion::queue::PackedEvent;
use crate::motion::ticks::{earlier, is_before};

/// A step of the first and the second group.
const OF_FIRST: u32 = PackedEvent::steps_of(0);
const OF_SECOND: u32 = PackedEvent::steps_of(1);

/// Directions are set this many ticks ahead of the step that needs them, if at least twice as many separate it from the
/// previous step. This is 3 us, more than twice the time that the Stepper needs to set them.
pub(super) const TURN_AHEAD: u32 = 30;

/// Whether the steps of an event leave no motor pulling against another one of its group.
fn is_unstrained(groups: &Groups, word: PackedEvent) -> bool {
    let coupling = groups.coupling();
    let (motors, forward) = (coupling.motors(word.steps()), coupling.forward_motors(word.forward()));
    groups.mechanism().is_unstrained(motors, forward)
}

/// The first of these groups to step before the tick `until`, its tick, and the tick up to which no other of them
/// steps.
#[inline(always)]
fn first_to_step(groups: &[GroupStepper], until: u32) -> (usize, u32, u32) {
    let (mut number, mut limit, mut tick) = (0, until, until);
    for (i, stepper) in groups.iter().enumerate() {
        let own = stepper.step_times.tick();
        if is_before(own, tick) {
            (number, limit, tick) = (i, tick, own);
        } else {
            limit = earlier(limit, own);
        }
    }
    (number, tick, limit)
}

impl StepGenerator<'_> {
    /// Makes up to `most` events of the steps before the tick `until`, at least one, and none after the tick `enough`;
    /// false if there are no steps. All groups that step in one tick step in one event.
    ///
    /// It handles three groups at once: the first two, which are the belts, and the first of the others to step. Those
    /// rest or step seldom, and a step of a fourth group ends the merging.
    #[inline(always)]
    pub(super) fn merge(&mut self, until: u32, most: u32, enough: u32) -> bool {
        let (setting, mechanism) = (self.waiting(), self.mechanism);
        let begin = self.last_tick as u32;
        let [first, second, others @ ..] = &mut self.group_steppers;
        let (number, tick, mut limit) = first_to_step(others, until);
        let Some(third) = others.get_mut(number) else { return false };
        // The steps of the first, the second and the third group.
        let (mut a, mut b, mut c) = (first.step_times.steps(), second.step_times.steps(), third.step_times.steps());
        let earliest = earlier(earlier(a.tick, b.tick), tick);
        if !is_before(earliest, until) {
            return false;
        }
        // An event of its own, so that setting the lines delays no step.
        let interval = earliest.wrapping_sub(begin);
        if interval >= 2 * TURN_AHEAD && self.events.turns_with(setting) {
            self.wait(interval - TURN_AHEAD);
            return true;
        }
        // Then `earliest`, `tick` and `limit` are the same: two groups beyond the first two step in this tick, which
        // the loop below cannot say.
        if !is_before(earliest, limit) {
            self.step_together(earliest);
            return true;
        }
        // A slow motor's next step may lie beyond `enough`. It is made all the same, because at least LEAST_AHEAD
        // events must wait.
        let most = if is_before(enough, earliest) { 1 } else { most };
        if most > 1 {
            // One more, because steps at `limit` itself are not made.
            limit = earlier(limit, enough.wrapping_add(1));
        }
        let of_third = self.events.step_of(number + 2);
        // The first two groups are merged up to here. Then comes a step of the third, or the end.
        let mut stop = earlier(c.tick, limit);
        let mut now = begin;
        let check = |steps| {
            debug_assert!(is_unstrained(mechanism, PackedEvent(setting.0 | steps)), "motors pull against each other");
        };
        self.events.put_runs(setting, most, &mut now, |run| {
            loop {
                // Nearly every event: a step of one of the first two groups, or of both.
                while !run.is_full() {
                    // By its sign, because ticks wrap.
                    let lead = a.tick.wrapping_sub(b.tick).cast_signed();
                    if !is_before(if lead < 0 { a.tick } else { b.tick }, stop) {
                        break;
                    }
                    if lead < 0 {
                        check(OF_FIRST);
                        run.put_steps(&mut a, earlier(b.tick, stop), OF_FIRST);
                    } else if lead > 0 {
                        check(OF_SECOND);
                        run.put_steps(&mut b, earlier(a.tick, stop), OF_SECOND);
                    } else {
                        check(OF_FIRST | OF_SECOND);
                        run.put_pairs([&mut a, &mut b], stop, OF_FIRST | OF_SECOND);
                    }
                }
                if run.is_full() {
                    return true;
                }
                // The step of the third group, with steps of the first two in the same tick.
                let tick = stop;
                if tick == limit {
                    return false;
                }
                let mut steps = of_third;
                c.advance();
                stop = earlier(c.tick, limit);
                if a.tick == tick {
                    a.advance();
                    steps |= OF_FIRST;
                }
                if b.tick == tick {
                    b.advance();
                    steps |= OF_SECOND;
                }
                check(steps);
                run.put(tick, steps);
            }
        });
        // The loop went on in copies of the groups' places.
        let (a, b, c) = (a.reached(), b.reached(), c.reached());
        first.step_times.advance_to(a);
        second.step_times.advance_to(b);
        third.step_times.advance_to(c);
        self.last_tick += u64::from(now.wrapping_sub(begin));
        true
    }

    /// Makes an event of all groups' steps at a tick with steps of two groups beyond the first two.
    #[cold]
    fn step_together(&mut self, tick: u32) {
        let mut word = self.waiting();
        for (number, stepper) in self.group_steppers.iter_mut().enumerate() {
            if stepper.step_times.left() > 0 && stepper.step_times.tick() == tick {
                word = PackedEvent(word.0 | PackedEvent::steps_of(number));
                let reached = stepper.step_times.steps().reached() + 1;
                stepper.step_times.advance_to(reached);
            }
        }
        let interval = tick.wrapping_sub(self.last_tick as u32);
        self.events.put(interval, word);
        self.last_tick += u64::from(interval);
    }
}
