//! The stepper: plays step events on the pins, each at its tick.
//!
//! It runs in the step timer's interrupt at the highest priority. Everything it needs stands in the event;
//! it decides nothing but whether the moment has come. Motion time runs while there are events: at each
//! start after a rest, real time is taken anew, so a pause of the host never shows in the motion.
//!
//! Nearly every event is a plain one, which comes in time and has nothing but steps; [`Stepper::on_alarm`] plays it in
//! a straight line. Whatever else there may be is [`Stepper::examine`]'s.

use super::queue::{StepsOut, Word};
use crate::port::{GroupSet, Pend, StepClock, StepPort};
use crate::status::Status;
use crate::units::Tick;

/// Events discarded in one interrupt, or played in interrupts one right after the other: few enough to stay below 10 us at 1 us an event, so that the
/// timer is looked at again in time.
const BURST: u32 = 8;

/// Behind that: 5 us for the others that wait. Discarding a full queue would otherwise keep them
/// waiting for a third of a millisecond.
const BREATH: u32 = 50;

/// An event that comes later than this moves all that follow: 10 us, half of the closest spacing at the
/// greatest speed of one motor. Steps are late then, but never too close to each other, and none is lost.
const GRACE: u32 = 100;

/// Between the first event's arrival and its alarm: 20 us, in which the generator makes a handful of events
/// (some 600 instructions each in QEMU) before the first one is due.
const LEAD: u32 = 200;

/// Plays step events.
// In this order: what every event needs is in front, within reach of short instructions.
#[repr(C)]
pub struct Stepper<'m, P: StepPort, C: StepClock, W: Pend> {
    /// When the event that comes next is due; at rest anything.
    due: Tick,
    /// That event, which is still in the queue.
    next: Word,
    /// How far motion time is behind real time.
    behind: u32,
    status: &'m Status,
    events: StepsOut<'m>,
    clock: C,
    pend: W,
    /// Direction lines as they are.
    forward: GroupSet,
    /// An epoch whose motion an endstop has ended.
    ended: Option<u8>,
    /// Events in a row that were due at once, and how many were done then.
    hurried: u32,
    hurried_to: u32,
    /// Motion time up to the last event that was looked at closely.
    time: u64,
    port: P,
}

impl<'m, P: StepPort, C: StepClock, W: Pend> Stepper<'m, P, C, W> {
    /// The stepper at the end of the StepQueue.
    pub fn new(events: StepsOut<'m>, status: &'m Status, mut port: P, clock: C, pend: W) -> Self {
        port.dir(GroupSet::NONE);
        status.set_inputs(port.inputs());
        status.set_endstops(port.endstops());
        Self {
            due: Tick(0),
            next: Word::RESTING,
            behind: 0,
            events,
            status,
            port,
            clock,
            pend,
            time: 0,
            forward: GroupSet::NONE,
            ended: None,
            hurried: 0,
            hurried_to: 0,
        }
    }

    /// Call it when the alarm rings and when it is pended. Bounded: plays one event, or discards a few.
    #[inline(always)]
    pub fn on_alarm(&mut self) {
        let is_plain = self.next.is_plain(self.status.epoch_in_interrupt());
        if (!is_plain || self.clock.now().since(self.due) > GRACE) && !self.examine() {
            return;
        }
        let (word, due) = (self.next, self.due);
        let tick = due.since(Tick(self.behind));
        self.port.rise(word.steps(), self.extended(tick));
        // The pulse is as long as what follows takes, and the port sees to it that this is enough.
        self.status.step_done(word.pattern(), tick);
        let (interval, next) = self.events.advance();
        let due = due.after(interval);
        (self.due, self.next) = (due, next);
        let rings = self.clock.alarm_again(due);
        self.port.fall(word.steps());
        if !rings || next == Word::NONE {
            self.go_on_at_once();
        }
    }

    /// Looks closely at an event that is not plain, or not in time. True if it is to be played.
    #[cold]
    #[inline(never)]
    fn examine(&mut self) -> bool {
        // Nobody who could begin another epoch runs until we are done.
        let epoch = self.status.epoch();
        if self.ended.is_some_and(|ended| ended != epoch) {
            self.ended = None;
        }
        self.time = self.tick();
        for _ in 0..BURST {
            if self.next == Word::RESTING && !self.begin() {
                self.rest();
                return false;
            }
            if self.next.wants_refill() {
                self.next = self.next.filled();
                self.pend.pend_generator();
            }
            if self.next.epoch() != epoch || self.ended.is_some() {
                self.discard();
                continue;
            }
            let late = self.clock.now().since(self.due);
            if late.cast_signed() < 0 && self.clock.alarm(self.due) {
                self.look_at_endstops();
                return false;
            }
            let watch = self.next.watch();
            if !watch.is_empty() {
                let pressed = self.port.endstops().and(watch);
                if !pressed.is_empty() {
                    self.status.set_triggered(pressed);
                    self.ended = Some(epoch);
                    self.discard();
                    continue;
                }
            }
            if late.cast_signed() > GRACE.cast_signed() {
                self.status.count_late(late);
                self.due = self.due.after(late);
                self.behind = self.behind.wrapping_add(late);
            }
            if !self.next.steps().is_empty() {
                if self.next.forward() != self.forward {
                    self.forward = self.next.forward();
                    self.port.dir(self.forward);
                }
                return true;
            }
            self.go_on();
        }
        self.breathe();
        false
    }

    /// Takes up the first event after a rest and dates it; false if there is none.
    fn begin(&mut self) -> bool {
        let (interval, next) = self.events.peek();
        if next == Word::NONE {
            return false;
        }
        self.next = if self.ended.is_some() { next.special() } else { next };
        self.due = self.clock.now().after(interval.max(LEAD));
        self.behind = self.due.0.wrapping_sub(self.time as u32).wrapping_sub(interval);
        true
    }

    /// Nothing is left to do.
    #[inline(never)]
    fn rest(&mut self) {
        self.status.set_rested(self.events.done());
        self.clock.silence();
        self.look_at_endstops();
    }

    /// Where nothing was due somebody wants to know.
    fn look_at_endstops(&mut self) {
        self.status.set_endstops(self.port.endstops());
    }

    /// Drops the event that comes next. Motion time stands still.
    fn discard(&mut self) {
        self.next = Word::RESTING;
        self.events.advance();
    }

    /// Passes over an event without steps.
    fn go_on(&mut self) {
        self.status.time_passed(self.due.since(Tick(self.behind)));
        let (interval, next) = self.events.advance();
        self.next = if next == Word::NONE { Word::RESTING } else { next };
        self.due = self.due.after(interval);
    }

    /// No alarm brings the next event: it is due already and comes at once, or soon if there were many like it; or there
    /// is none, the queue has run dry in mid-motion.
    #[cold]
    #[inline(never)]
    fn go_on_at_once(&mut self) {
        if self.next == Word::NONE {
            self.next = Word::RESTING;
            self.status.count_starved();
            return self.rest();
        }
        let done = self.events.done();
        self.hurried = if self.hurried_to == done.wrapping_sub(1) { self.hurried + 1 } else { 1 };
        self.hurried_to = done;
        if self.hurried < BURST {
            self.pend.pend_stepper();
        } else {
            self.hurried = 0;
            self.breathe();
        }
    }

    /// Leaves the processor to the others for a while.
    #[inline(never)]
    fn breathe(&mut self) {
        if !self.clock.alarm(self.clock.now().after(BREATH)) {
            self.pend.pend_stepper();
        }
    }

    /// Motion time so far, in ticks.
    pub fn tick(&self) -> u64 {
        self.extended(self.status.tick())
    }

    /// Motion time with all its bits.
    #[inline(always)]
    const fn extended(&self, tick: u32) -> u64 {
        self.time.wrapping_add(tick.wrapping_sub(self.time as u32) as u64)
    }
}
