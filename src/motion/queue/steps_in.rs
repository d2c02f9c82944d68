//! The StepGenerator's end of the StepQueue.

use super::event::StepEvent;
use super::packed_event::PackedEvent;
use super::{SLOTS, StepQueue};
use crate::motion::atomic::{AtomicU32, Ordering::AcqRel, Ordering::Relaxed, compiler_fence};
use crate::motion::ticks::{NEAR, is_before};
use crate::motors::MOST_GROUPS;
use crate::port::GroupSet;

/// The first event of a run is special if its interval is this long, 0.4 s. All other events of the run are within
/// [`NEAR`] of its begin.
const LONG: u32 = 1 << 22;
/// One in this many events is special, for any interval. So all plain events between two special ones take less than
/// 429 s, after which a 32-bit tick wraps. The Stepper counts the upper bits of motion time at special events alone. A
/// run of one plain event takes less than [`LONG`], a longer one less than [`LONG`] and [`NEAR`], so runs of two are
/// the worst.
pub(super) const REGULAR: u32 = 256;
const _: () = assert!((LONG + NEAR) as u64 * (REGULAR as u64 / 2) < 1 << 32);

/// The Stepper sees a run of a quarter of the events that it has left, but at least this many. It must not run out of
/// events while the run is filled.
const SHORTEST_RUN: usize = 4;

/// Step times of a group, in order, as input of a [`Run`].
pub(in crate::motion) trait StepTimes {
    /// Tick of the next step.
    fn tick(&self) -> u32;
    /// Consumes this many steps; there must be as many.
    fn advance_by(&mut self, count: usize);
    /// The ticks after the next one, with any content after the last step.
    fn following(&self) -> &[u32];
}

/// Consecutive events with steps. The Stepper sees none of them before all are stored: the first one is stored last.
pub(in crate::motion) struct Run<'q> {
    /// Tick of the last event.
    now: u32,
    word: PackedEvent,
    /// Slots of the next events, and slots of the events after these.
    slots: &'q [[AtomicU32; 2]],
    next_slots: &'q [[AtomicU32; 2]],
}

impl Run<'_> {
    /// Whether the present slots are full.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.slots.is_empty()
    }

    /// Adds an event if there is a slot; its steps are those of [`PackedEvent::steps_of`].
    #[inline(always)]
    pub fn put(&mut self, tick: u32, steps: u32) {
        if let [[interval_slot, word_slot], following @ ..] = self.slots {
            interval_slot.store(tick.wrapping_sub(self.now), Relaxed);
            word_slot.store(self.word.0 | steps, Relaxed);
            self.now = tick;
            self.slots = following;
        }
    }

    /// Adds the next step of two groups at one tick, and the following steps up to a tick while both step together and
    /// there are slots.
    #[inline(always)]
    pub fn put_pairs(&mut self, [first, second]: [&mut impl StepTimes; 2], until: u32, word: u32) {
        let word = self.word.0 | word;
        let (mut now, mut tick, mut count) = (self.now, first.tick(), 0);
        for (([interval_slot, word_slot], after), other) in
            self.slots.iter().zip(first.following()).zip(second.following())
        {
            interval_slot.store(tick.wrapping_sub(now), Relaxed);
            word_slot.store(word, Relaxed);
            (now, tick) = (tick, *after);
            count += 1;
            // After the last step comes the first unknown tick, which is not before `until`, and ends this as well.
            if tick != *other || !is_before(tick, until) {
                break;
            }
        }
        self.now = now;
        self.slots = self.slots.get(count..).unwrap_or_default();
        first.advance_by(count);
        second.advance_by(count);
    }

    /// Adds the next step of a group, and the following steps up to a tick while there are slots.
    #[inline(always)]
    pub fn put_steps(&mut self, steps: &mut impl StepTimes, until: u32, word: u32) {
        loop {
            self.put(steps.tick(), word);
            steps.advance_by(1);
            if self.is_full() || !is_before(steps.tick(), until) {
                return;
            }
        }
    }
}

/// The StepGenerator's end.
pub struct StepsIn<'m> {
    queue: &'m StepQueue,
    /// Events ever put in, wrapping.
    made: u32,
    /// The previous event; initially NONE, which no event equals.
    previous: PackedEvent,
    /// Groups with steps that make an event special.
    slow: GroupSet,
    /// The event at which the Stepper calls for more.
    marked: u32,
}

impl<'m> StepsIn<'m> {
    pub(super) const fn new(queue: &'m StepQueue, made: u32) -> Self {
        Self { queue, made, previous: PackedEvent::NONE, slow: GroupSet::NONE, marked: made }
    }

    /// The first two groups, which make up a run. Steps of others come in between.
    const FIRST_TWO: u8 = 0b11;

    /// Bits that a step of a group in a run adds to its event, beyond the first two groups.
    pub(in crate::motion) const fn step_of(&self, group: usize) -> u32 {
        let is_slow = self.slow.0 >> group & 1 != 0;
        PackedEvent::steps_of(group) | if is_slow { PackedEvent::SPECIAL } else { 0 }
    }

    /// Whether an event would set directions that the previous ones did not.
    pub(in crate::motion) const fn turns_with(&self, word: PackedEvent) -> bool {
        !word.goes_as(self.previous)
    }

    /// Makes events with steps of these groups special.
    pub fn set_slow_groups(&mut self, groups: GroupSet) {
        self.slow = groups;
    }

    /// Puts an event in.
    ///
    /// # Errors
    /// The event, if there is no room.
    #[inline]
    pub fn enqueue(&mut self, event: StepEvent) -> Result<(), StepEvent> {
        if self.len() >= SLOTS - 1 {
            return Err(event);
        }
        let StepEvent { interval, steps, forward, epoch, watch } = event;
        self.put(interval, PackedEvent::waiting(epoch, watch).stepping(steps, forward));
        Ok(())
    }

    /// Puts an event in where there is room.
    pub(in crate::motion) fn put(&mut self, interval: u32, word: PackedEvent) {
        self.publish(interval, word, 1);
    }

    /// Adds up to `most` events, for which there must be room, while `fill` supplies them for a [`Run`]. `fill` says
    /// whether there may be more. The events are like `setting` except for their steps. `now` is the tick of the
    /// previous event, and afterwards of the last one.
    #[inline(always)]
    pub(in crate::motion) fn put_runs(
        &mut self,
        setting: PackedEvent,
        most: u32,
        now: &mut u32,
        mut fill: impl FnMut(&mut Run) -> bool,
    ) {
        let is_special = setting.has_watch() || self.slow.0 & Self::FIRST_TWO != 0;
        let word = if is_special { setting.special() } else { setting };
        // Kept here until the run is whole: the store of the first event shows all of them.
        let first = [[AtomicU32::new(0), AtomicU32::new(0)]];
        let mut left = most as usize;
        let mut has_more = true;
        while has_more && left > 0 {
            // Events after the first are plain if possible, so a run ends before one that may not be.
            let longest = (self.len() / 4).max(SHORTEST_RUN);
            let begin = self.made as usize % SLOTS;
            // Up to the next multiple of REGULAR, where an event must be special. The ring ends at one, so a run never
            // wraps.
            let slots = self.queue.events.get(begin + 1..begin - begin % REGULAR as usize + REGULAR as usize);
            let slots = slots.unwrap_or_default();
            // Less the first, which is not in its slot. Both are at least 1.
            let slots = slots.get(..left.min(longest) - 1).unwrap_or(slots);
            let mut run = Run { now: *now, word, slots: &first, next_slots: slots };
            while has_more && !run.is_full() {
                has_more = fill(&mut run);
                if has_more {
                    run.slots = core::mem::take(&mut run.next_slots);
                }
            }
            *now = run.now;
            let made = 1 + slots.len() - run.slots.len() - run.next_slots.len();
            // No step was left: an empty run shows nothing.
            if made == 0 {
                return;
            }
            let [[interval, first]] = &first;
            self.publish(
                interval.load(Relaxed),
                PackedEvent(setting.0 | first.load(Relaxed) & PackedEvent::STEPS),
                made as u32,
            );
            left -= made;
        }
    }

    /// Shows the Stepper `count` events. All but the first are in their slots already.
    #[inline(always)]
    fn publish(&mut self, interval: u32, word: PackedEvent, count: u32) {
        // A direction taken back with an epoch is set again in the next one.
        let is_plain = word.has_only_steps(self.slow)
            && (word.0 ^ self.previous.0) & PackedEvent::SETTING == 0
            && interval < LONG
            && !self.made.is_multiple_of(REGULAR);
        self.previous = word;
        let word = if is_plain { word } else { word.special() };
        // All slots from here on belong to the generator until the store of the first event. A Stepper that sees this
        // event must find its interval, the other events, and the end of the queue after them.
        let end = self.made.wrapping_add(count);
        self.queue.end_at(end);
        let [interval_slot, word_slot] = self.queue.slot(self.made);
        interval_slot.store(interval, Relaxed);
        compiler_fence(AcqRel);
        word_slot.store(word.0, Relaxed);
        compiler_fence(AcqRel);
        self.made = end;
    }

    /// Takes back all events that the Stepper has not played and returns their steps per group. The Stepper will not
    /// play the held event either, because its epoch or its motion is over.
    pub fn take_back(&mut self) -> [i32; MOST_GROUPS] {
        let steps = self.queue.waiting(self.made);
        self.made = self.done();
        self.marked = self.made;
        // Its direction may not have reached the pins.
        self.previous = PackedEvent::NONE;
        self.queue.end_at(self.made);
        steps
    }

    /// Events ever put in, wrapping.
    pub(in crate::motion) const fn made(&self) -> u32 {
        self.made
    }

    /// Events ever taken out, wrapping.
    pub(in crate::motion) fn done(&self) -> u32 {
        self.queue.done.load(Relaxed)
    }

    /// Events in the queue, including the one that the Stepper holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.made.wrapping_sub(self.queue.done.load(Relaxed)) as usize
    }

    /// Whether no event is left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Room for events.
    #[must_use]
    pub fn room(&self) -> usize {
        SLOTS - 1 - self.len()
    }

    /// Makes the Stepper call the generator at `left` remaining events. Returns false if there are no more than that
    /// already, or if `left` is 0.
    pub(in crate::motion) fn mark(&mut self, left: usize) -> bool {
        let is_waiting = |queue: &StepQueue, number: u32| {
            // Less one, because the event numbered `done` is held and was looked at. One that is played wraps to a
            // great number.
            number.wrapping_sub(queue.done.load(Relaxed)).wrapping_sub(1) < SLOTS as u32 - 1
        };
        let number = self.made.wrapping_sub(left as u32);
        if self.marked != number {
            let before = &self.queue.slot(self.marked)[1];
            // The generator owns a waiting word; the Stepper only reads it.
            if is_waiting(self.queue, self.marked) {
                before.store(before.load(Relaxed) & !PackedEvent::REFILL, Relaxed);
            }
        }
        if left == 0 {
            return false;
        }
        let word = &self.queue.slot(number)[1];
        word.store(word.load(Relaxed) | PackedEvent::SPECIAL | PackedEvent::REFILL, Relaxed);
        compiler_fence(AcqRel);
        self.marked = number;
        // The Stepper has already looked at the event that it holds.
        is_waiting(self.queue, number)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::port::EndstopSet;
    use std::vec::Vec;

    #[test]
    fn a_full_queue_gives_the_event_back() {
        let mut queue = StepQueue::new();
        let (mut events_in, mut events_out) = queue.split();
        let event =
            |interval| StepEvent { interval, steps: GroupSet(1), forward: GroupSet(1), epoch: 0, watch: EndstopSet(2) };
        let all = || (0..SLOTS as u32 - 1).map(event);
        assert!(all().all(|event| events_in.enqueue(event).is_ok()));
        assert_eq!(events_in.enqueue(event(0)), Err(event(0)));
        assert!(all().eq(core::iter::from_fn(|| events_out.dequeue())));
        assert!(events_in.is_empty());
    }

    #[test]
    fn a_run_is_shown_when_it_is_whole_and_nothing_follows_it() {
        let mut queue = StepQueue::new();
        for word in queue.events.iter().skip(1).flatten() {
            word.store(7, Relaxed);
        }
        let (mut events_in, mut events_out) = queue.split();
        let setting = PackedEvent::waiting(3, EndstopSet::NONE).stepping(GroupSet::NONE, GroupSet(1));
        let (mut now, mut made, mut done, mut longest) = (1000, 0, 0, 0);
        while done < 3 * SLOTS as u32 {
            let most = (events_in.room() as u32).min(100);
            let queue = events_out.queue;
            let mut run = Vec::new();
            events_in.put_runs(setting, most, &mut now, |slots| {
                while !slots.is_full() {
                    // The Stepper stops at the empty slot, wherever it is.
                    let shown =
                        (0..SLOTS as u32).find(|i| queue.slot(done + i)[1].load(Relaxed) == PackedEvent::NONE.0);
                    let first = done + shown.unwrap_or(u32::MAX);
                    assert!((made - run.len() as u32..=made).contains(&first), "{first} of {made}");
                    assert_eq!(queue.slot(first)[0].load(Relaxed), 0);
                    let most = ((first - done) as usize / 4).max(SHORTEST_RUN);
                    longest = longest.max(made + 1 - first);
                    assert!(((made - first) as usize) < most, "more than a quarter of what is shown");
                    slots.put(1000 + 50 * (made + 1), PackedEvent::steps_of(0));
                    run.push(made);
                    made += 1;
                }
                true
            });
            assert_eq!((events_in.made(), now), (made, 1000 + 50 * made));
            let end = queue.slot(made).each_ref().map(|word| word.load(Relaxed));
            assert_eq!(end, [0, PackedEvent::NONE.0], "nothing follows the last");
            for _ in 0..made - done {
                let (interval, word) = events_out.peek();
                let is_special = done == 0 || done.is_multiple_of(REGULAR);
                assert_eq!((interval, word.is_plain(3)), (50, !is_special), "event {done}");
                assert_eq!((word.steps(), word.forward()), (GroupSet(1), GroupSet(1)));
                events_out.advance();
                done += 1;
            }
        }
        assert_eq!(longest, 20, "a quarter of what is shown");
    }
}
