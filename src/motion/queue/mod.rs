//! The StepQueue: step events on their way from the StepGenerator to the Stepper.
//!
//! ```text
//!            done                         made
//!             v                            v
//! [ played ][ held ][ event ][ event ] ... [ end: 0, NONE ][ played ] ...     512 slots, a ring
//!             ^ the Stepper has looked at it, and it is still in the queue
//! ```
//!
//! A ring buffer with one writer, the generator, and one reader, the Stepper, on one core. The Stepper interrupts the generator,
//! never the other way round, so the order of stores need only be kept from the compiler, by a compiler fence. (The
//! processor's barrier `dmb` would take a tenth of a step.)
//!
//! A slot is two words: the interval since the event before, and a [`PackedEvent`]. The slot after the newest event holds
//! [`PackedEvent::NONE`] with the interval 0. The Stepper takes that like an event which is due at once, and sees then
//! that there is none, so it need not compare counts to know whether the queue is empty. One bit of an event's word says
//! that the event wants more than steps; the generator sets it when it makes the event.
//!
//! Its length is [`SLOTS`], a power of two and a multiple of `REGULAR` (`steps_in`). Who changes it is led to `app::Memory`, which
//! asserts its size, to `stepgen`, whose batch must fit in and which makes events `AHEAD` of time and no farther (a longer queue never
//! fills unless that grows too), to the budget of RAM (`xtask/src/build/contents.rs`, docs/boards.md) and to `memory.x`, which divides
//! RAM between variables and stack. `take_back` and M114 look at every event that waits.
//!
//! # Who writes which word when
//!
//! | word | owner, who writes it | when | who else reads it |
//! |---|---|---|---|
//! | slots from `made + 1` on | generator | while a run is filled | nobody before the store of the first event |
//! | slot at the new end | generator | before the run is shown | Stepper, as "no event" |
//! | slot at `made`: interval | generator | before the first fence | Stepper; it may read the new interval while the event word still says NONE |
//! | slot at `made`: event | generator | **last**, between two fences | Stepper: from now on it sees the run |
//! | REFILL of a waiting event | generator | any time; the Stepper may have read it before | Stepper |
//! | `done` | Stepper | when it lets go of an event | generator, Console |
//! | `made` | generator, in its own memory | after the second fence | others by `Status`, when published |
//!
//! The order matters in three places. The end is stored before the event that leads to it, or the Stepper would run into what
//! stands there from the previous turn of the ring. All following events of a run are stored before the first one, for the
//! Stepper that sees the first may play them all. And the first one's interval is stored before its event; a Stepper that has
//! taken the interval of the slot while the event was NONE looks at the event again when it is due (`Stepper::check_event`).
//!
//! `tests/queue_orders` has these files on a memory of its own, in which the Stepper comes in at every point between two
//! stores, in every order that the compiler may give them.
//!
//! # Words
//!
//! - **slot**: where an event is stored. **word**: 32 bits, which are read and written in one piece.
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

/// Slots of the ring, one of which stays empty.
pub(in crate::motion) const SLOTS: usize = 512;
// The numbers of events wrap at 2^32, where slots must go on in order; and every so many events one is not plain, which
// must fall on the same slots in each turn of the ring.
const _: () = assert!(SLOTS.is_power_of_two() && SLOTS.is_multiple_of(REGULAR as usize));

/// Step events between StepGenerator and Stepper. As good as full: the generator waits. Empty: motion rests, or has
/// starved, which the generator counts. A full queue lasts for 5 ms at 100,000 events a second.
#[repr(C)]
pub struct StepQueue {
    /// Events taken out, wrapping. In front, where the step interrupt reaches it with one load.
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
        // More than there is room for: the generator has made some since, and whoever asks looks again.
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

    /// There are no events from here on.
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
    /// The queue itself, for what counts the steps that wait in it.
    pub(super) const fn queue(&self) -> &'m StepQueue {
        self.queue
    }

    /// The event that comes next, which stays where it is: its interval, and the word that is [`PackedEvent::NONE`] if there
    /// is none.
    #[inline(always)]
    pub(super) fn peek(&self) -> (u32, PackedEvent) {
        Self::numbered(self.queue, self.queue.done.load(Relaxed))
    }

    /// Lets go of the event that came next, and looks at the one that follows.
    #[inline(always)]
    pub(super) fn advance(&mut self) -> (u32, PackedEvent) {
        let queue = self.queue;
        // `done` is the Stepper's own: nobody else writes it.
        let done = queue.done.load(Relaxed).wrapping_add(1);
        queue.done.store(done, Relaxed);
        Self::numbered(queue, done)
    }

    #[inline(always)]
    fn numbered(queue: &StepQueue, number: u32) -> (u32, PackedEvent) {
        let [interval, word] = queue.slot(number);
        // The generator is the owner. In any order, for it is interrupted and does nothing in between.
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
