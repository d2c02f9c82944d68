//! The StepQueue: step events on their way from the StepGenerator to the Stepper.
//!
//! ```text
//!            done                         made
//!             v                            v
//! [ played ][ held ][ event ][ event ] ... [ end: 0, NONE ][ played ] ...     512 slots, a ring
//!             ^ the Stepper has looked at it, and it is still in the queue
//! ```
//!
//! A ring buffer with one writer, the generator, and one reader, the Stepper, on one core. The Stepper interrupts the
//! generator, never the other way round. So only the compiler could reorder stores in a harmful way, and a compiler
//! fence prevents this. (The processor's barrier `dmb` would take a tenth of a step.)
//!
//! A slot is two words: the interval since the previous event, and a [`PackedEvent`]. The slot after the newest event
//! holds [`PackedEvent::NONE`] with the interval 0. The Stepper treats it as an event that is due at once, and then
//! sees that there is none. So it need not compare counts to detect an empty queue. One bit of the event word means
//! that the event has more than steps; the generator sets it.
//!
//! The length is [`SLOTS`], a power of two and a multiple of `REGULAR` (`steps_in`). A change affects
//!
//! - `app::Memory`, which asserts its size;
//! - `stepgen`: a batch must fit in, and the generator makes events only `AHEAD` of time, so a longer queue never fills
//!   unless `AHEAD` grows too;
//! - the budget of RAM (`xtask/src/build/contents.rs`, docs/reference/boards.md);
//! - `memory.x`, which divides RAM between variables and stack.
//!
//! `take_back` and M114 look at every waiting event.
//!
//! # Which context writes which word when
//!
//! | word | owner and writer | when | who else reads it |
//! |---|---|---|---|
//! | slots from `made + 1` on | generator | while a run is filled | no context before the first event is stored |
//! | slot at the new end | generator | before the run is shown | Stepper, as "no event" |
//! | slot at `made`: interval | generator | before the first fence | Stepper, maybe while the word is still NONE |
//! | slot at `made`: event | generator | **last**, between two fences | Stepper: from now on it sees the run |
//! | REFILL of a waiting event | generator | any time; the Stepper may have read it before | Stepper |
//! | `done` | Stepper | when it lets go of an event | generator, Console |
//! | `made` | generator, in its own memory | after the second fence | others by `Status`, once published |
//!
//! The order matters in three places:
//!
//! 1. The end is stored before the event that leads to it. Otherwise the Stepper would play events of the previous turn
//!    of the ring.
//! 2. All following events of a run are stored before the first one, because the Stepper may play them all once it sees
//!    the first.
//! 3. The first event's interval is stored before its word. A Stepper that read the interval while the word was NONE
//!    looks at the event again when it is due (`Stepper::check_event`).
//!
//! `tests/queue_orders` runs these files on a memory of its own. The Stepper interrupts between any two stores, in
//! every order that the compiler may choose.
//!
//! # Words
//!
//! - **slot**: the place of an event. **word**: 32 bits, read and written in one piece.
//! - **plain event**: steps in directions that are set, in time, and nothing else. **special event**: any other.
//! - **run**: events that are shown at once. **mark**: the event at which the Stepper calls the generator.
//! - **fence**: `compiler_fence`, which keeps the compiler from moving stores across it.

mod event;
mod packed_event;
mod steps_in;

use super::atomic::{AtomicU32, Ordering::Relaxed};
use crate::motors::MOST_GROUPS;
use crate::port::GroupSet;
pub use event::{LONGEST_INTERVAL, StepEvent};
pub(super) use packed_event::PackedEvent;
use steps_in::REGULAR;
pub(super) use steps_in::StepTimes;
pub use steps_in::StepsIn;

/// Slots of the ring. One of them stays empty.
pub(in crate::motion) const SLOTS: usize = 512;
// Event numbers wrap at 2^32 where slots must continue in order. Every `REGULAR`th event is special and must use the
// same slots in each turn of the ring.
const _: () = assert!(SLOTS.is_power_of_two() && SLOTS.is_multiple_of(REGULAR as usize));

/// Step events between StepGenerator and Stepper. Nearly full: the generator waits. Empty: motion is at rest or has
/// starved, which the generator counts. A full queue lasts for 5 ms at 100,000 events a second.
#[repr(C)]
pub struct StepQueue {
    /// Events taken out, wrapping. First field, so that the step interrupt reaches it with one load.
    done: AtomicU32,
    /// Interval and [`PackedEvent`] of each event.
    events: [[AtomicU32; 2]; SLOTS],
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
        Self { events: [const { [const { AtomicU32::new(0) }; 2] }; SLOTS], done: AtomicU32::new(0) }
    }

    /// Its two ends.
    pub fn split(&mut self) -> (StepsIn<'_>, StepsOut<'_>) {
        let made = self.done.load(Relaxed);
        let queue = &*self;
        queue.end_at(made);
        (StepsIn::new(queue, made), StepsOut { queue })
    }

    /// Steps of each group in the events from the one that the Stepper holds up to the one numbered `made`, signed.
    pub(super) fn waiting(&self, made: u32) -> [i32; MOST_GROUPS] {
        let mut steps = [0i32; MOST_GROUPS];
        let done = self.done.load(Relaxed);
        // More than there is room for: the generator has made events since `made` was read, and the caller looks again.
        let count = Some(made.wrapping_sub(done)).filter(|count| *count < SLOTS as u32).unwrap_or(0);
        for number in 0..count {
            let word = PackedEvent(self.slot(done.wrapping_add(number))[1].load(Relaxed));
            for (group, steps) in steps.iter_mut().enumerate() {
                let is_in = |set: GroupSet| i32::from(set.0 >> group & 1);
                *steps += is_in(word.steps()) * (2 * is_in(word.forward()) - 1);
            }
        }
        steps
    }

    /// Marks the end of the events.
    #[inline(always)]
    fn end_at(&self, number: u32) {
        let [interval, word] = self.slot(number);
        interval.store(0, Relaxed);
        word.store(PackedEvent::NONE.0, Relaxed);
    }

    #[inline(always)]
    fn slot(&self, number: u32) -> &[AtomicU32; 2] {
        &self.events[number as usize % SLOTS]
    }
}

/// The Stepper's end.
pub struct StepsOut<'m> {
    queue: &'m StepQueue,
}

impl<'m> StepsOut<'m> {
    /// The queue itself, for counting the steps that wait in it.
    pub(super) const fn queue(&self) -> &'m StepQueue {
        self.queue
    }

    /// The next event, which stays in the queue: its interval, and its word, [`PackedEvent::NONE`] if there is none.
    #[inline(always)]
    pub(super) fn peek(&self) -> (u32, PackedEvent) {
        Self::numbered(self.queue, self.queue.done.load(Relaxed))
    }

    /// Releases the next event and looks at the following one.
    #[inline(always)]
    pub(super) fn advance(&mut self) -> (u32, PackedEvent) {
        let queue = self.queue;
        // Only the Stepper writes `done`.
        let done = queue.done.load(Relaxed).wrapping_add(1);
        queue.done.store(done, Relaxed);
        Self::numbered(queue, done)
    }

    #[inline(always)]
    fn numbered(queue: &StepQueue, number: u32) -> (u32, PackedEvent) {
        let [interval, word] = queue.slot(number);
        // Owned by the generator. Any order is right, because the generator is interrupted and makes no progress in
        // between.
        (interval.load(Relaxed), PackedEvent(word.load(Relaxed)))
    }

    /// Events taken out so far, wrapping.
    pub(super) fn done(&self) -> u32 {
        self.queue.done.load(Relaxed)
    }

    /// Takes an event out.
    pub fn dequeue(&mut self) -> Option<StepEvent> {
        let (interval, word) = self.peek();
        if word == PackedEvent::NONE {
            return None;
        }
        self.advance();
        let (steps, forward, epoch, watch) = (word.steps(), word.forward(), word.epoch(), word.watch());
        Some(StepEvent { interval, steps, forward, epoch, watch })
    }
}
