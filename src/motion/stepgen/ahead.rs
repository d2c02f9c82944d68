//! Ahead: the ticks of a motor group's next steps, as far as they are known.

use super::crossing::Crossings;
use crate::motion::MIN_STEP_INTERVAL;

/// Places for ticks, a power of two: 0.5 KiB a group. With 32 an event takes 13 instructions more, for rounds
/// of events end most often because the steps known of one group do.
const PLACES: usize = 128;
const _: () = assert!(PLACES.is_power_of_two());

/// Most steps that are found at once.
pub(in crate::motion) const MOST: usize = PLACES - 1;

/// The next steps of a group.
pub(in crate::motion) struct Ahead {
    /// The first tick at which nothing is known.
    until: u32,
    /// The ticks of steps that were made, of those to come, and behind them that one.
    ticks: [u32; PLACES],
    /// Where the next step stands, and where the steps end.
    next: usize,
    end: usize,
    /// When the first of them may come at the earliest.
    free: u32,
}

/// Steps being made, in order.
pub(in crate::motion) struct Steps<'a> {
    ticks: &'a [u32; PLACES],
    /// Where the next one stands.
    next: usize,
    /// When the next one comes; behind the last, from when on nothing is known.
    pub tick: u32,
}

impl Steps<'_> {
    /// The next one is made; there must be one.
    #[inline(always)]
    pub fn go_on(&mut self) {
        self.next += 1;
        self.tick = self.ticks[self.next % PLACES];
    }

    /// So many are made; there must be so many.
    #[inline(always)]
    pub fn go_on_by(&mut self, count: usize) {
        self.next += count;
        self.tick = self.ticks[self.next % PLACES];
    }

    /// The ticks that follow the next one's, whatever comes after the last step.
    #[inline(always)]
    pub fn following(&self) -> &[u32] {
        self.ticks.split_at((self.next + 1).min(PLACES)).1
    }

    /// Where the next one stands.
    pub const fn reached(&self) -> usize {
        self.next
    }
}

impl Ahead {
    /// Nothing, and nothing behind it.
    pub const NONE: Self = Self { until: 0, ticks: [0; PLACES], next: 0, end: 0, free: 0 };

    /// The same from a tick on.
    pub const fn at(now: u32) -> Self {
        Self { until: now, free: now, ..Self::NONE }
    }

    /// The tick at which the next step comes; if none is left, from which on nothing is known.
    pub const fn tick(&self) -> u32 {
        self.ticks[self.next % PLACES]
    }

    /// The tick from which on nothing is known.
    pub const fn until(&self) -> u32 {
        self.until
    }

    /// How many steps are left.
    pub const fn left(&self) -> usize {
        self.end - self.next
    }

    /// Its steps, to be made.
    pub fn steps(&self) -> Steps<'_> {
        Steps { ticks: &self.ticks, next: self.next, tick: self.tick() }
    }

    /// So many steps were made since it was filled.
    pub fn go_on_to(&mut self, reached: usize) {
        self.next = reached;
    }

    /// Drops the steps that are left. Nothing is known from a tick on.
    pub fn clear(&mut self, until: u32) {
        self.free = self.free();
        (self.next, self.end) = (0, 0);
        self.until = until;
        self.ticks[0] = until;
    }

    /// Drops the steps that are left, and begins anew at a tick.
    pub fn begin(&mut self, tick: u32) {
        self.clear(tick);
        if is_before(self.free, tick) {
            self.free = tick;
        }
    }

    /// Fills it with as many of the next `left` steps as come before a tick, if there are so many places. How many there
    /// are, and whether more may come before that tick.
    pub fn fill(&mut self, crossings: &mut Crossings, left: u32, ends: u32) -> (u32, bool) {
        self.clear(ends);
        let wanted = (left as usize).min(MOST);
        let Some(ticks) = self.ticks.get_mut(..wanted) else { return (0, false) };
        crossings.fill(ticks);
        if crossings.is_dense || ticks.first().is_some_and(|first| is_before(*first, self.free)) {
            let mut free = self.free;
            for tick in &mut *ticks {
                *tick = later(*tick, free);
                free = after(*tick);
            }
        }
        // Steps on the boundary between two pieces belong to the later one, where they meet those of other groups.
        let mut count = wanted;
        let mut last = ends;
        while let Some(tick) = count.checked_sub(1).and_then(|last| ticks.get(last)) {
            if is_before(*tick, ends) {
                last = *tick;
                break;
            }
            count -= 1;
        }
        let is_over = count < MOST || count as u32 == left;
        self.end = count;
        self.until = if is_over { ends } else { last.wrapping_add(1) };
        self.ticks[count % PLACES] = self.until;
        (count as u32, is_over)
    }

    /// When the next step may come at the earliest.
    fn free(&self) -> u32 {
        self.next.checked_sub(1).map_or(self.free, |last| after(self.ticks[last % PLACES]))
    }
}

/// The first tick at which there may be another pulse behind one.
const fn after(tick: u32) -> u32 {
    tick.wrapping_add(MIN_STEP_INTERVAL as u32)
}

/// Whether a tick comes before another; they wrap.
#[inline(always)]
pub(in crate::motion) const fn is_before(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

/// The earlier of two ticks.
#[inline(always)]
pub(in crate::motion) const fn earlier(a: u32, b: u32) -> u32 {
    if is_before(a, b) { a } else { b }
}

/// The later of two ticks.
const fn later(a: u32, b: u32) -> u32 {
    if is_before(a, b) { b } else { a }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn all(ahead: &Ahead) -> Vec<u32> {
        let mut steps = ahead.steps();
        let next = |_| {
            let tick = steps.tick;
            steps.go_on();
            tick
        };
        (0..=ahead.left()).map(next).collect()
    }

    #[test]
    fn steps_that_are_late_come_one_after_the_other() {
        let mut ahead = Ahead::NONE;
        let mut crossings = Crossings::at_once(1000 << 16);
        ahead.begin(1000);
        assert_eq!(ahead.fill(&mut crossings, 3, 5000), (3, true));
        assert_eq!(all(&ahead), [1000, 1017, 1034, 5000]);
        // Two are made, the third is given up: the next pulse keeps its distance from the second one.
        ahead.go_on_to(2);
        ahead.begin(1012);
        assert_eq!(ahead.fill(&mut Crossings::at_once(1012 << 16), 1, 5000), (1, true));
        assert_eq!(all(&ahead), [1034, 5000]);
    }

    #[test]
    fn steps_at_the_end_are_left_to_what_comes_behind() {
        let mut ahead = Ahead::NONE;
        ahead.begin(1000);
        assert_eq!(ahead.fill(&mut Crossings::at_once(1000 << 16), 9, 1051), (3, true));
        assert_eq!(all(&ahead), [1000, 1017, 1034, 1051]);
    }

    #[test]
    fn it_is_filled_again_where_it_ended() {
        let mut ahead = Ahead::NONE;
        let mut crossings = Crossings::at_once(0);
        let most = MOST as u32;
        assert_eq!(ahead.fill(&mut crossings, most + 1, 5000), (most, false));
        assert_eq!(ahead.until(), 17 * most - 16, "a tick behind the last");
        ahead.go_on_to(MOST);
        assert_eq!(ahead.fill(&mut crossings, 1, 5000), (1, true));
        assert_eq!(all(&ahead), [17 * most, 5000]);
    }
}
