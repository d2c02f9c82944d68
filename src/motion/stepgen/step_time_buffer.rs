//! Step time buffer: the known ticks of a motor group's next steps.

use super::step_time_solver::StepTimeSolver;
use crate::motion::queue::StepTimes;
use crate::motion::ticks::{MIN_STEP_INTERVAL, is_before, later};

/// Slots for ticks, a power of two: 0.5 KiB a group. With 32 slots an event takes 13 instructions more, because merging
/// usually stops where the known steps of a group end.
const SLOTS: usize = 128;
const _: () = assert!(SLOTS.is_power_of_two());

/// Most steps that are solved at once.
pub(in crate::motion) const MOST: usize = SLOTS - 1;

/// The next steps of a group.
pub(in crate::motion) struct StepTimeBuffer {
    /// First tick with nothing known.
    known_until: u32,
    /// Ticks of made steps, then of steps to come, and after them `known_until`.
    ticks: [u32; SLOTS],
    /// Slot of the next step, and slot after the last one.
    next: usize,
    end: usize,
    /// Earliest tick of the first step.
    earliest: u32,
}

/// Steps being made, in order.
pub(in crate::motion) struct StepTimeReader<'a> {
    ticks: &'a [u32; SLOTS],
    /// Slot of the next one.
    next: usize,
    /// Tick of the next one; after the last, the first tick with nothing known.
    pub tick: u32,
}

impl StepTimeReader<'_> {
    /// Marks the next one as made; there must be one.
    #[inline(always)]
    pub fn advance(&mut self) {
        self.advance_by(1);
    }

    /// Slot of the next one.
    pub const fn reached(&self) -> usize {
        self.next
    }
}

impl StepTimes for StepTimeReader<'_> {
    #[inline(always)]
    fn tick(&self) -> u32 {
        self.tick
    }

    #[inline(always)]
    fn advance_by(&mut self, count: usize) {
        self.next += count;
        self.tick = self.ticks[self.next % SLOTS];
    }

    #[inline(always)]
    fn following(&self) -> &[u32] {
        self.ticks.split_at((self.next + 1).min(SLOTS)).1
    }
}

impl StepTimeBuffer {
    /// No steps, and nothing is known.
    pub const NONE: Self = Self { known_until: 0, ticks: [0; SLOTS], next: 0, end: 0, earliest: 0 };

    /// Forgets all steps, also those that are made. Nothing is known from a tick on.
    pub const fn restart(&mut self, now: u32) {
        (self.next, self.end) = (0, 0);
        (self.known_until, self.earliest) = (now, now);
        self.ticks[0] = now;
    }

    /// Tick of the next step; if none is left, the first tick with nothing known.
    pub const fn tick(&self) -> u32 {
        self.ticks[self.next % SLOTS]
    }

    /// First tick with nothing known.
    pub const fn known_until(&self) -> u32 {
        self.known_until
    }

    /// Number of steps left.
    pub const fn left(&self) -> usize {
        self.end - self.next
    }

    /// Its steps, to be made.
    pub fn steps(&self) -> StepTimeReader<'_> {
        StepTimeReader { ticks: &self.ticks, next: self.next, tick: self.tick() }
    }

    /// This many steps were made since it was filled.
    pub fn advance_to(&mut self, reached: usize) {
        self.next = reached;
    }

    /// Drops the steps that are left. Nothing is known from a tick on.
    pub fn clear(&mut self, until: u32) {
        self.earliest = self.earliest();
        (self.next, self.end) = (0, 0);
        self.known_until = until;
        self.ticks[0] = until;
    }

    /// Drops the steps that are left, and begins again at a tick.
    pub fn begin(&mut self, tick: u32) {
        self.clear(tick);
        if is_before(self.earliest, tick) {
            self.earliest = tick;
        }
    }

    /// Fills it with the steps of the next `left` ones that come before a tick, as far as there are slots. Returns
    /// their number, and whether more may come before that tick.
    #[inline(always)]
    pub fn fill(&mut self, solver: &mut StepTimeSolver, left: u32, end_tick: u32) -> (u32, bool) {
        self.clear(end_tick);
        let wanted = (left as usize).min(MOST);
        let Some(ticks) = self.ticks.get_mut(..wanted) else { return (0, false) };
        solver.fill(ticks);
        // Only where two pulses may be too close. Elsewhere the loop would cost a comparison a step.
        if solver.is_dense || ticks.first().is_some_and(|first| is_before(*first, self.earliest)) {
            let mut earliest = self.earliest;
            for tick in &mut *ticks {
                *tick = later(*tick, earliest);
                earliest = after(*tick);
            }
        }
        // Steps on the boundary between two pieces belong to the later piece, together with steps of other groups.
        let mut count = wanted;
        let mut last = end_tick;
        while let Some(tick) = count.checked_sub(1).and_then(|last| ticks.get(last)) {
            if is_before(*tick, end_tick) {
                last = *tick;
                break;
            }
            count -= 1;
        }
        let is_over = count < MOST || count as u32 == left;
        self.end = count;
        self.known_until = if is_over { end_tick } else { last.wrapping_add(1) };
        self.ticks[count % SLOTS] = self.known_until;
        (count as u32, is_over)
    }

    /// Earliest tick of the next step.
    fn earliest(&self) -> u32 {
        self.next.checked_sub(1).map_or(self.earliest, |last| after(self.ticks[last % SLOTS]))
    }
}

/// First tick at which another pulse may follow one.
const fn after(tick: u32) -> u32 {
    tick.wrapping_add(MIN_STEP_INTERVAL as u32)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::units::SubTicks;
    use std::vec::Vec;

    fn all(buffer: &StepTimeBuffer) -> Vec<u32> {
        let mut steps = buffer.steps();
        let next = |_| {
            let tick = steps.tick;
            steps.advance();
            tick
        };
        (0..=buffer.left()).map(next).collect()
    }

    #[test]
    fn steps_that_are_late_come_one_after_the_other() {
        // Also where 32-bit ticks are about to wrap.
        for begin in [1000, 1u32 << 31, u32::MAX - 1020] {
            let after = |ticks: [u32; 4]| ticks.map(|ticks| begin.wrapping_add(ticks));
            let (mut buffer, end) = (StepTimeBuffer::NONE, begin.wrapping_add(4000));
            buffer.restart(begin);
            let mut solver = StepTimeSolver::at_once(SubTicks::of_ticks(begin.into()));
            buffer.begin(begin);
            assert_eq!(buffer.fill(&mut solver, 3, end), (3, true));
            assert_eq!(all(&buffer), after([0, 17, 34, 4000]));
        }
        let mut buffer = StepTimeBuffer::NONE;
        buffer.begin(1000);
        assert_eq!(buffer.fill(&mut StepTimeSolver::at_once(SubTicks::of_ticks(1000)), 3, 5000), (3, true));
        // Two are made, the third is dropped: the next pulse keeps its distance from the second one.
        buffer.advance_to(2);
        buffer.begin(1012);
        assert_eq!(buffer.fill(&mut StepTimeSolver::at_once(SubTicks::of_ticks(1012)), 1, 5000), (1, true));
        assert_eq!(all(&buffer), [1034, 5000]);
    }

    #[test]
    fn steps_at_the_end_are_left_to_what_follows() {
        let mut buffer = StepTimeBuffer::NONE;
        buffer.begin(1000);
        assert_eq!(buffer.fill(&mut StepTimeSolver::at_once(SubTicks::of_ticks(1000)), 9, 1051), (3, true));
        assert_eq!(all(&buffer), [1000, 1017, 1034, 1051]);
    }

    #[test]
    fn it_is_filled_again_where_it_ended() {
        let mut buffer = StepTimeBuffer::NONE;
        let mut solver = StepTimeSolver::at_once(SubTicks::ZERO);
        let most = MOST as u32;
        assert_eq!(buffer.fill(&mut solver, most + 1, 5000), (most, false));
        assert_eq!(buffer.known_until(), 17 * most - 16, "a tick after the last");
        buffer.advance_to(MOST);
        assert_eq!(buffer.fill(&mut solver, 1, 5000), (1, true));
        assert_eq!(all(&buffer), [17 * most, 5000]);
    }
}
