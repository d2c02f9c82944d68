//! The stepper: plays step events on the pins, each at its tick.
//!
//! It runs in the step timer's interrupt at the highest priority. The event contains everything that it needs; it only
//! decides whether the time has come. Motion time runs while there are events. At each start after a rest it is
//! synchronised with real time, so a pause of the host never shows in the motion.
//!
//! Nearly every event is a plain one: in time, with steps and nothing else. [`Stepper::on_alarm`] plays it in
//! straight-line code. [`Stepper::play_closely`] handles all others.
//!
//! # States
//!
//! | state | condition | leads to |
//! |---|---|---|
//! | resting | `next` is RESTING | *waiting*, when an event of the epoch is in the queue (`resume` dates it) |
//! | waiting | an event in `next`, `due` ahead, alarm set | *due* at the alarm; *resting* if the epoch is over |
//! | due | `due` has come, at most MAX_LATE ago | played: next event *waiting* or *due*; without one *starved* |
//! | late | `due` is more than MAX_LATE ago | `lag` grows by it, and the event is *due*: all later ones move with it |
//! | starved | `next` is NONE | *due*, if the event has arrived by then; else *resting* |
//! | ended | an endstop that the event watches is pressed | *resting* until the next epoch: `ended` holds this one |
//!
//! An event without steps is skipped at its time (`skip_event`). After the last such event the Stepper is *resting*
//! without being *starved*. The generator uses such events to mark the end of a motion, and the time that passes while
//! it does not know the next step. The generator also counts rests in mid-motion (`StepGenerator::run`).

use super::queue::{PackedEvent, StepsOut};
use crate::port::{GroupSet, StepClock, StepPort, Wake};
use crate::status::Status;
use crate::units::Tick;

/// Events played in one interrupt, one right after the other: few enough to stay below 10 us at 1 us an event.
const BURST: u32 = 8;

/// After [`BURST`] events: 5 us for the other interrupts that wait.
const YIELD: u32 = 50;

/// An event later than this delays all following events: 10 us. Steps are late then, and none is lost.
const MAX_LATE: u32 = 100;

/// Time between the first event's arrival and its alarm: 20 us, in which the generator goes on making events.
const START_LEAD: u32 = 200;

/// Not a valid epoch.
const NO_EPOCH: u16 = 1 << 8;

/// Plays step events.
// In this order: the fields that every event needs are first, within reach of short instructions.
#[repr(C)]
pub struct Stepper<'m, P: StepPort, C: StepClock, W: Wake> {
    /// Due tick of the next event; at rest any value.
    due: Tick,
    /// Lag of motion time behind real time. It is between the two other fields, because the compiler would else store
    /// these as a pair, which takes longer. `next` and `status` would be such a pair too.
    lag: u32,
    /// The next event, which is still in the queue.
    next: PackedEvent,
    events: StepsOut<'m>,
    status: &'m Status,
    clock: C,
    wake: W,
    /// State of the direction lines.
    forward: GroupSet,
    /// An epoch with motion ended by an endstop, or [`NO_EPOCH`].
    ended: u16,
    /// Motion time up to the last special event.
    time: u64,
    port: P,
}

impl<'m, P: StepPort, C: StepClock, W: Wake> Stepper<'m, P, C, W> {
    /// The stepper at the end of the StepQueue.
    pub fn new(events: StepsOut<'m>, status: &'m Status, mut port: P, clock: C, wake: W) -> Self {
        port.dir(GroupSet::NONE);
        status.set_inputs(port.inputs());
        status.set_slow_groups(port.slow_groups());
        status.set_endstops(port.endstops());
        Self {
            due: Tick(0),
            next: PackedEvent::RESTING,
            lag: 0,
            events,
            status,
            port,
            clock,
            wake,
            time: 0,
            forward: GroupSet::NONE,
            ended: NO_EPOCH,
        }
    }

    /// Call it when the alarm rings and when it is pended. Bounded: plays one event, and following ones that are due
    /// right after it.
    #[inline(always)]
    pub fn on_alarm(&mut self) {
        if !self.is_plain() {
            return self.play_closely();
        }
        let (word, due) = (self.next, self.due);
        let tick = self.dated(due);
        // Updated before the edge: no reader can run until the interrupt returns, and it frees a register.
        self.status.event_played(due.0);
        self.port.rise_quick(word.steps(), tick);
        let is_alarm_set = self.next_event(due);
        self.port.fall_quick(word.steps());
        if !is_alarm_set {
            self.play_closely();
        }
    }

    /// Whether the next event is due, in time, and has nothing but steps.
    #[inline(always)]
    fn is_plain(&self) -> bool {
        self.next.is_plain(self.status.epoch_in_interrupt()) && self.clock.is_due(self.due, MAX_LATE)
    }

    /// Continues with the next event after one that was due at this time and has its step lines high; false if no alarm
    /// is set for the next one. The pulse lasts as long as this takes. The port ensures that this is enough.
    #[inline(always)]
    fn next_event(&mut self, due: Tick) -> bool {
        let (interval, next) = self.events.advance();
        let due = due.after(interval);
        (self.due, self.next) = (due, next);
        self.clock.alarm_again(due)
    }

    /// Plays the next event if it is valid, and following ones that are due right after it. After many of them it sets
    /// an early alarm for the next one.
    #[cold]
    #[inline(never)]
    fn play_closely(&mut self) {
        for _ in 0..BURST {
            if !self.is_ready() && !self.check_event() {
                return;
            }
            let word = self.next;
            let is_alarm_set = self.play();
            self.after_event(word);
            if is_alarm_set {
                return;
            }
        }
        self.yield_cpu();
    }

    /// Whether the next event is due, in time, and has nothing but steps, as far as that matters before it is played.
    #[inline(always)]
    fn is_ready(&self) -> bool {
        self.next.is_step_of(self.status.epoch_in_interrupt(), self.forward)
            && self.clock.now().since(self.due) <= MAX_LATE
    }

    /// Work after an event has been played.
    fn after_event(&mut self, event: PackedEvent) {
        self.time = self.tick();
        if event.wants_refill() {
            self.wake.wake_generator();
        }
    }

    /// Plays the next event, with any groups; false if no alarm is set for the following one.
    #[inline(always)]
    fn play(&mut self) -> bool {
        let (word, due) = (self.next, self.due);
        let tick = self.dated(due);
        self.status.event_played(due.0);
        self.port.rise(word.steps(), tick);
        let is_alarm_set = self.next_event(due);
        self.port.fall(word.steps());
        is_alarm_set
    }

    /// Handles an event that is not plain or not in time: true if it is to be played. Takes the Stepper through the
    /// states of the table above.
    #[inline(never)]
    fn check_event(&mut self) -> bool {
        // No context that could begin another epoch runs until this returns.
        let mut epoch = u16::from(self.status.epoch_in_interrupt());
        if self.ended == epoch {
            epoch = NO_EPOCH;
        } else {
            self.ended = NO_EPOCH;
        }
        if self.next == PackedEvent::NONE {
            // It may have been in the middle of being stored, with only its time in place.
            self.next = self.events.peek().1;
            if self.next == PackedEvent::NONE {
                self.next = PackedEvent::RESTING;
            }
        }
        if !self.next.is_of(epoch) {
            self.next = PackedEvent::RESTING;
        }
        for _ in 0..BURST {
            if self.next == PackedEvent::RESTING && !self.resume(epoch) {
                self.status.set_rested(self.events.done());
                self.clock.silence();
                return self.report_endstops();
            }
            let late = self.clock.now().since(self.due);
            // An alarm that cannot be set has passed in between: then the event is due.
            if late.cast_signed() < 0 && self.clock.alarm(self.due) {
                return self.report_endstops();
            }
            if !self.next.watch().is_empty() {
                // Only when an event is due, so that every platform stops at the same one however often it looks.
                let pressed = self.port.endstops().and(self.next.watch());
                if !pressed.is_empty() {
                    self.status.set_triggered(pressed);
                    (self.ended, epoch) = (epoch, NO_EPOCH);
                    // No event is of NO_EPOCH, so the next turn of this loop finds none and rests.
                    self.next = PackedEvent::RESTING;
                    self.wake.wake_generator();
                    continue;
                }
            }
            // The later events move with it: played at their own times, they would follow too close for the motors.
            if late.cast_signed() > MAX_LATE.cast_signed() {
                self.status.count_late(late);
                self.due = self.due.after(late);
                self.set_lag(self.lag.wrapping_add(late), self.due);
            }
            if self.next.forward() != self.forward {
                // Ahead of the steps, by the set-up time of `StepPort::dir`. The generator adds an event for this where
                // there is time.
                self.forward = self.next.forward();
                self.port.dir(self.forward);
            }
            if !self.next.steps().is_empty() {
                return true;
            }
            self.skip_event();
        }
        self.yield_cpu();
        false
    }

    /// Takes up the first event after a rest and dates it; false if there is none of `epoch`. The generator takes back
    /// the events of an epoch that is over or was ended by an endstop, and all events in the queue are of one epoch.
    fn resume(&mut self, epoch: u16) -> bool {
        let (interval, next) = self.events.peek();
        if !next.is_of(epoch) {
            return false;
        }
        self.next = next;
        self.due = self.clock.now().after(interval.max(START_LEAD));
        let begun = self.due.0.wrapping_sub(interval);
        let stood = self.status.played_at().wrapping_sub(self.lag);
        self.set_lag(begun.wrapping_sub(stood), Tick(begun));
        true
    }

    /// Sets the lag of motion time, which is exact at `due`.
    fn set_lag(&mut self, ticks: u32, due: Tick) {
        self.lag = ticks;
        self.status.set_lag(ticks, due.0);
    }

    /// Nothing is due, but another context may need the endstops. Returns false: there is nothing to play.
    fn report_endstops(&mut self) -> bool {
        self.status.set_endstops(self.port.endstops());
        self.status.count_look();
        false
    }

    /// Skips an event without steps.
    fn skip_event(&mut self) {
        self.status.event_played(self.due.0);
        self.after_event(self.next);
        let (interval, next) = self.events.advance();
        self.next = if next == PackedEvent::NONE { PackedEvent::RESTING } else { next };
        self.due = self.due.after(interval);
    }

    /// Changes the port's coupling and sets the direction lines again. At rest.
    pub fn recouple(&mut self, change: impl FnOnce(&mut P)) {
        change(&mut self.port);
        self.status.set_slow_groups(self.port.slow_groups());
        self.port.dir(self.forward);
    }

    /// The hardware.
    pub const fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Leaves the processor to other contexts for a while.
    #[inline(never)]
    fn yield_cpu(&mut self) {
        if !self.clock.alarm(self.clock.now().after(YIELD)) {
            self.wake.wake_stepper();
        }
    }

    /// Motion time so far, in ticks.
    pub fn tick(&self) -> u64 {
        self.dated(Tick(self.status.played_at()))
    }

    /// Motion time at a tick of the step timer, with all its bits.
    #[inline(always)]
    fn dated(&self, due: Tick) -> u64 {
        self.extended(due.since(Tick(self.lag)))
    }

    /// Motion time with all its bits.
    #[inline(always)]
    const fn extended(&self, tick: u32) -> u64 {
        self.time.wrapping_add(tick.wrapping_sub(self.time as u32) as u64)
    }
}
