//! A clock that is set by hand, and a `Wake` without effect.

use corehbot::port::{StepClock, Wake};
use corehbot::units::Tick;
use std::cell::Cell;

/// The clock's time, and its alarm.
#[derive(Default)]
pub struct Clock {
    pub now: Cell<u32>,
    pub alarm: Cell<Option<u32>>,
}

pub struct Timer<'c>(pub &'c Clock);

impl StepClock for Timer<'_> {
    fn now(&self) -> Tick {
        Tick(self.0.now.get())
    }

    fn alarm(&mut self, at: Tick) -> bool {
        self.0.alarm.set(Some(at.0));
        self.now().is_before(at)
    }

    fn silence(&mut self) {
        self.0.alarm.set(None);
    }
}

#[derive(Clone, Copy)]
pub struct NoWake;

impl Wake for NoWake {
    fn wake_generator(&self) {}
    fn wake_stepper(&self) {}
}
