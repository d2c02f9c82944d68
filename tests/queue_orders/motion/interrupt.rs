//! The step interrupt's use of the queue, as in `motion::stepper`.

use super::explore::choose;
use super::queue::{PackedEvent, StepsOut};
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// The played events: motion time, groups, and whether it called the generator.
pub type Played = Rc<RefCell<Vec<(u32, u8, bool)>>>;

/// The Stepper: the event that comes next, when it is due in motion time, and the epoch that counts.
pub struct Interrupt {
    events: StepsOut<'static>,
    next: PackedEvent,
    due: u32,
    /// When the last event was due.
    played_at: u32,
    epoch: Rc<Cell<u8>>,
    played: Played,
}

impl Interrupt {
    pub fn new(events: StepsOut<'static>, epoch: Rc<Cell<u8>>, played: Played) -> Self {
        Self { events, next: PackedEvent::RESTING, due: 0, played_at: 0, epoch, played }
    }

    /// Plays one event, or two that are due.
    pub fn run_some(&mut self) {
        for _ in 0..=choose(2) {
            self.run();
        }
    }

    /// Plays all that there are.
    pub fn run_all(&mut self) {
        while self.run() {}
    }

    /// Plays an event; false if there is none.
    fn run(&mut self) -> bool {
        if self.next == PackedEvent::NONE {
            self.next = self.events.peek().1;
        }
        if self.next == PackedEvent::NONE || !self.next.is_of(self.epoch.get().into()) {
            // At rest; the next event starts from here again.
            let (interval, word) = self.events.peek();
            if !word.is_of(self.epoch.get().into()) {
                self.next = PackedEvent::RESTING;
                return false;
            }
            (self.next, self.due) = (word, self.played_at.wrapping_add(interval));
        }
        self.played.borrow_mut().push((self.due, self.next.steps().0, self.next.wants_refill()));
        self.played_at = self.due;
        let (interval, word) = self.events.advance();
        (self.next, self.due) = (word, self.due.wrapping_add(interval));
        if interval == 0 && word == PackedEvent::NONE {
            // Due at once, so the same interrupt finds no event.
            self.next = PackedEvent::RESTING;
        }
        true
    }
}
