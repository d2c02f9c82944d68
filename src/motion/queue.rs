//! The StepQueue: step events on their way from the StepGenerator to the Stepper.
//!
//! A ring whose two ends have one owner each, on one core: the Stepper interrupts the generator, never the other way
//! round, so what keeps the compiler from changing an order is enough (`dmb` would take a tenth of a step). An event takes two words; the one after the newest is empty, so the
//! Stepper need not ask how many there are. What an event wants beyond steps is one bit of it, which is set when it is
//! made.

use super::event::StepEvent;
use crate::motors::MOST_GROUPS;
use crate::port::{EndstopSet, GroupSet};
use core::sync::atomic::{AtomicU32, Ordering::AcqRel, Ordering::Relaxed, compiler_fence};

/// Places in the ring, one of which stays empty.
const LENGTH: usize = 512;

/// An event this long, 0.4 s, is not a plain one; and neither is one of so many. Thus the plain ones between two others
/// take less than the 429 s at which a tick of 32 bits wraps.
const LONG: u32 = 1 << 22;
const REGULAR: u32 = 256;
const _: () = assert!(LONG as u64 * (REGULAR as u64) < 1 << 32);

/// Step events between StepGenerator and Stepper. Full: the generator waits. Empty: motion rests, or has
/// starved, which is counted. 511 events are 5 ms at 100,000 events a second.
#[repr(C)]
pub struct StepQueue {
    /// Events taken out, wrapping. In front, where the step interrupt reaches it with one load.
    done: AtomicU32,
    /// Interval and [`Word`] of each event.
    events: [[AtomicU32; 2]; LENGTH],
}

/// A bit for each group.
const GROUPS: u32 = (1 << MOST_GROUPS) - 1;

/// Where the endstops to be watched begin; there are four.
const WATCH_AT: usize = 2 * MOST_GROUPS;
const _: () = assert!(WATCH_AT + 4 <= 16 && EndstopSet::PROBE.0 == 8);

/// All of an event but its time: the groups in bits 0 to 9, steps above directions, then the endstops it watches in bits
/// 10 to 13, its epoch from bit 16 on, and what is special about it. 0 is no event.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Word(pub u32);

impl Word {
    /// No event.
    pub const NONE: Self = Self(0);
    /// What a Stepper without an event holds.
    pub const RESTING: Self = Self(1 << 26);
    /// There is more to it than steps in directions that are set already.
    const SPECIAL: u32 = 1 << 24;
    /// The generator is to make more.
    const REFILL: u32 = 1 << 25;

    /// What two plain events in a row have in common: directions, epoch, and that they are events.
    const SETTING: u32 = 0xFFFF_0000 | GROUPS;

    const STEPS: u32 = GROUPS << MOST_GROUPS;
    const WATCH: u32 = 0xF << WATCH_AT;

    /// An event of `epoch` that watches endstops, without steps.
    pub const fn waiting(epoch: u8, watch: EndstopSet) -> Self {
        Self((watch.0 as u32) << WATCH_AT & Self::WATCH | (epoch as u32) << 16)
    }

    /// The same with steps, in directions that stay with it.
    pub const fn stepping(self, steps: GroupSet, forward: GroupSet) -> Self {
        Self(
            self.0 & !(Self::STEPS | GROUPS)
                | (steps.0 as u32) << MOST_GROUPS & Self::STEPS
                | forward.0 as u32 & GROUPS,
        )
    }

    /// The same with a step of one more group.
    #[inline(always)]
    pub const fn step(self, group: usize, is_forward: bool) -> Self {
        Self(self.0 & !(1 << group) | 1 << (MOST_GROUPS + group) | (is_forward as u32) << group)
    }

    /// The same without steps.
    #[inline(always)]
    pub const fn still(self) -> Self {
        Self(self.0 & !Self::STEPS)
    }

    /// Whether this is an event of `epoch` with nothing special about it.
    #[inline(always)]
    pub const fn is_plain(self, epoch: u8) -> bool {
        self.0 >> 16 == epoch as u32
    }

    /// Whether there are steps, and no endstops to be watched.
    #[inline(always)]
    const fn has_only_steps(self) -> bool {
        self.0 & Self::STEPS != 0 && self.0 & Self::WATCH == 0
    }

    /// The same, to be looked at closely.
    pub const fn special(self) -> Self {
        Self(self.0 | Self::SPECIAL)
    }

    /// The groups that step and the groups whose coordinate grows, as [`Status`](crate::status::Status) counts them.
    #[inline(always)]
    pub const fn pattern(self) -> u16 {
        (self.0 & (Self::STEPS | GROUPS)) as u16
    }

    #[inline(always)]
    pub const fn steps(self) -> GroupSet {
        GroupSet((self.0 >> MOST_GROUPS & GROUPS) as u8)
    }

    pub const fn forward(self) -> GroupSet {
        GroupSet((self.0 & GROUPS) as u8)
    }

    pub const fn watch(self) -> EndstopSet {
        EndstopSet((self.0 >> WATCH_AT & 0xF) as u8)
    }

    pub const fn epoch(self) -> u8 {
        (self.0 >> 16) as u8
    }

    /// The same when the generator has been called.
    pub const fn filled(self) -> Self {
        Self(self.0 & !Self::REFILL)
    }

    pub const fn wants_refill(self) -> bool {
        self.0 & Self::REFILL != 0
    }
}

impl Default for StepQueue {
    fn default() -> Self {
        Self::new()
    }
}

impl StepQueue {
    /// An empty queue.
    #[must_use]
    pub const fn new() -> Self {
        Self { events: [const { [const { AtomicU32::new(0) }; 2] }; LENGTH], done: AtomicU32::new(0) }
    }

    /// Its two ends.
    pub fn split(&mut self) -> (StepsIn<'_>, StepsOut<'_>) {
        let made = self.done.load(Relaxed);
        let queue = &*self;
        (StepsIn { queue, made, before: Word(1 << 31), marked: made }, StepsOut { queue })
    }

    #[inline(always)]
    fn place(&self, number: u32) -> &[AtomicU32; 2] {
        &self.events[number as usize % LENGTH]
    }
}

/// The StepGenerator's end.
pub struct StepsIn<'m> {
    queue: &'m StepQueue,
    /// Events ever put in, wrapping.
    made: u32,
    /// The event before; at first none, which none is like.
    before: Word,
    /// The event at which the Stepper asks for more.
    marked: u32,
}

impl StepsIn<'_> {
    /// Puts an event in.
    ///
    /// # Errors
    /// The event, if there is no room.
    #[inline]
    pub fn enqueue(&mut self, event: StepEvent) -> Result<(), StepEvent> {
        if self.len() >= LENGTH - 1 {
            return Err(event);
        }
        let StepEvent { interval, steps, forward, epoch, watch } = event;
        self.put(interval, Word::waiting(epoch, watch).stepping(steps, forward));
        Ok(())
    }

    /// Puts an event in where there is room.
    #[inline(always)]
    pub(super) fn put(&mut self, interval: u32, word: Word) {
        // A direction that is lost with an epoch is set anew in the next.
        let is_plain = word.has_only_steps()
            && (word.0 ^ self.before.0) & Word::SETTING == 0
            && interval < LONG
            && !self.made.is_multiple_of(REGULAR);
        self.before = word;
        let word = if is_plain { word } else { word.special() };
        // Whoever sees the event must find its end of the queue behind it.
        self.queue.place(self.made.wrapping_add(1))[1].store(0, Relaxed);
        let [time, place] = self.queue.place(self.made);
        time.store(interval, Relaxed);
        compiler_fence(AcqRel);
        place.store(word.0, Relaxed);
        compiler_fence(AcqRel);
        self.made = self.made.wrapping_add(1);
    }

    /// Events ever put in, wrapping.
    pub(super) const fn made(&self) -> u32 {
        self.made
    }

    /// Events ever taken out, wrapping.
    pub(super) fn done(&self) -> u32 {
        self.queue.done.load(Relaxed)
    }

    /// Events in the queue, the one in the Stepper's hands among them.
    #[must_use]
    pub fn len(&self) -> usize {
        self.made.wrapping_sub(self.queue.done.load(Relaxed)) as usize
    }

    /// Whether the Stepper has none left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Events that there is room for.
    #[must_use]
    pub fn room(&self) -> usize {
        LENGTH - 1 - self.len()
    }

    /// Has the generator called when no more than `left` events are left; false if that is so already, or if there is
    /// nothing to call it for, with 0.
    pub(super) fn mark(&mut self, left: usize) -> bool {
        let is_waiting = |queue: &StepQueue, number: u32| {
            number.wrapping_sub(queue.done.load(Relaxed)).wrapping_sub(1) < LENGTH as u32 - 1
        };
        let number = self.made.wrapping_sub(left as u32);
        if self.marked != number {
            let before = &self.queue.place(self.marked)[1];
            if is_waiting(self.queue, self.marked) {
                before.store(before.load(Relaxed) & !Word::REFILL, Relaxed);
            }
        }
        if left == 0 {
            return false;
        }
        let word = &self.queue.place(number)[1];
        word.store(word.load(Relaxed) | Word::SPECIAL | Word::REFILL, Relaxed);
        compiler_fence(AcqRel);
        self.marked = number;
        // The Stepper has looked at the event it holds before.
        is_waiting(self.queue, number)
    }
}

/// The Stepper's end.
pub struct StepsOut<'m> {
    queue: &'m StepQueue,
}

impl StepsOut<'_> {
    /// The event that comes next, which stays where it is: its interval, and the word that is [`Word::NONE`] if there
    /// is none.
    #[inline(always)]
    pub(super) fn peek(&self) -> (u32, Word) {
        Self::numbered(self.queue, self.queue.done.load(Relaxed))
    }

    /// Lets go of the event that came next, and looks at the one behind.
    #[inline(always)]
    pub(super) fn advance(&mut self) -> (u32, Word) {
        let queue = self.queue;
        let done = queue.done.load(Relaxed).wrapping_add(1);
        queue.done.store(done, Relaxed);
        Self::numbered(queue, done)
    }

    #[inline(always)]
    fn numbered(queue: &StepQueue, number: u32) -> (u32, Word) {
        let [interval, word] = queue.place(number);
        // In any order, for the generator does nothing in between.
        (interval.load(Relaxed), Word(word.load(Relaxed)))
    }

    /// Events taken out so far, wrapping.
    pub(super) fn done(&self) -> u32 {
        self.queue.done.load(Relaxed)
    }

    /// Takes an event out.
    pub fn dequeue(&mut self) -> Option<StepEvent> {
        let (interval, word) = self.peek();
        if word == Word::NONE {
            return None;
        }
        self.advance();
        let (steps, forward, epoch, watch) = (word.steps(), word.forward(), word.epoch(), word.watch());
        Some(StepEvent { interval, steps, forward, epoch, watch })
    }
}
