//! The stepper: plays step events on the pins, each at its tick.
//!
//! It runs in the step timer's interrupt at the highest priority. Everything it needs stands in the event;
//! it decides nothing but whether the moment has come. Motion time runs while there are events: at each
//! start after a rest, real time is taken again, so a pause of the host never shows in the motion.
//!
//! Nearly every event is a plain one, which comes in time and has nothing but steps; [`Stepper::on_alarm`] plays it in
//! a straight line. Whatever else there may be is [`Stepper::play_closely`]'s.
//!
//! # States
//!
//! | state | what says so | leads to |
//! |---|---|---|
//! | resting | `next` is RESTING | *waiting*, when an event of the epoch is in the queue (`resume` dates it) |
//! | waiting | an event in `next`, `due` ahead, alarm set | *due*, when the alarm rings; *resting*, when the epoch is over |
//! | due | `due` has come, at most MAX_LATE ago | played: *waiting* or *due* with the next event, *starved* without one |
//! | late | `due` is more than MAX_LATE ago | `lag` grows by so much, and the event is *due*: all that follow move with it |
//! | starved | `next` is NONE | *due*, if the event has come meanwhile; else *resting* |
//! | ended | an endstop that the event watches is pressed | *resting* until the next epoch: `ended` holds this one |
//!
//! An event without steps is passed over where it would be played (`skip_event`); after the last such event the Stepper is
//! *resting* without being *starved*: the generator marks the end of a motion so, and the time that passes while it does
//! not know the next step. Whether a rest was one in mid-motion it knows as well, and counts (`StepGenerator::run`).

use super::queue::{PackedEvent, StepsOut};
use crate::port::{GroupSet, Pend, StepClock, StepPort};
use crate::status::Status;
use crate::units::Tick;

/// Events played in one interrupt, one right after the other: few enough to stay below 10 us at 1 us an event.
const BURST: u32 = 8;

/// After [`BURST`] events: 5 us for the other interrupts that wait.
const YIELD: u32 = 50;

/// An event that comes later than this moves all that follow: 10 us. Steps are late then, and none is lost.
const MAX_LATE: u32 = 100;

/// Between the first event's arrival and its alarm: 20 us, in which the generator goes on making events.
const START_LEAD: u32 = 200;

/// None of the epochs.
const NO_EPOCH: u16 = 1 << 8;

/// Plays step events.
// In this order: what every event needs is in front, within reach of short instructions.
#[repr(C)]
pub struct Stepper<'m, P: StepPort, C: StepClock, W: Pend> {
    /// When the event that comes next is due; at rest anything.
    due: Tick,
    /// By how much motion time lags real time. (Between the other two, which the compiler would else store as a pair; that
    /// takes longer, and so would next event and status.)
    lag: u32,
    /// The event that comes next, which is still in the queue.
    next: PackedEvent,
    events: StepsOut<'m>,
    status: &'m Status,
    clock: C,
    pend: W,
    /// Direction lines as they are.
    forward: GroupSet,
    /// An epoch whose motion an endstop has ended, or [`NO_EPOCH`].
    ended: u16,
    /// Motion time up to the last event that was looked at closely.
    time: u64,
    port: P,
}

impl<'m, P: StepPort, C: StepClock, W: Pend> Stepper<'m, P, C, W> {
    /// The stepper at the end of the StepQueue.
    pub fn new(events: StepsOut<'m>, status: &'m Status, mut port: P, clock: C, pend: W) -> Self {
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
            pend,
            time: 0,
            forward: GroupSet::NONE,
            ended: NO_EPOCH,
        }
    }

    /// Call it when the alarm rings and when it is pended. Bounded: plays one event, and those that are due right after
    /// it.
    #[inline(always)]
    pub fn on_alarm(&mut self) {
        if !self.is_plain() {
            return self.play_closely();
        }
        let (word, due) = (self.next, self.due);
        let tick = self.dated(due);
        // Nobody looks before the step is made, and then the status need not be remembered any longer.
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

    /// Goes on to the next event, from one that was due then and whose step lines are high; false if no alarm is set for the
    /// next one. The pulse is as long as this takes, and the port sees to it that this is enough.
    #[inline(always)]
    fn next_event(&mut self, due: Tick) -> bool {
        let (interval, next) = self.events.advance();
        let due = due.after(interval);
        (self.due, self.next) = (due, next);
        self.clock.alarm_again(due)
    }

    /// Plays the next event if that is to be played, and those that are due right after it; the next one soon if these
    /// were many.
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

    /// What is left to do when an event has been played.
    fn after_event(&mut self, event: PackedEvent) {
        self.time = self.tick();
        if event.wants_refill() {
            self.pend.pend_generator();
        }
    }

    /// Plays the next event, whatever its groups; false if no alarm is set for the one that follows.
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

    /// Looks closely at an event that is not plain, or not in time: true if it is to be played. Takes the Stepper through the
    /// states of the table above.
    #[inline(never)]
    fn check_event(&mut self) -> bool {
        // Nobody who could begin another epoch runs until we are done.
        let mut epoch = u16::from(self.status.epoch_in_interrupt());
        if self.ended == epoch {
            epoch = NO_EPOCH;
        } else {
            self.ended = NO_EPOCH;
        }
        if self.next == PackedEvent::NONE {
            // It may have been on its way, with its time already there.
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
            if late.cast_signed() < 0 && self.clock.alarm(self.due) {
                return self.report_endstops();
            }
            if !self.next.watch().is_empty() {
                let pressed = self.port.endstops().and(self.next.watch());
                if !pressed.is_empty() {
                    self.status.set_triggered(pressed);
                    (self.ended, epoch) = (epoch, NO_EPOCH);
                    self.next = PackedEvent::RESTING;
                    self.pend.pend_generator();
                    continue;
                }
            }
            if late.cast_signed() > MAX_LATE.cast_signed() {
                self.status.count_late(late);
                self.due = self.due.after(late);
                self.set_lag(self.lag.wrapping_add(late), self.due);
            }
            if self.next.forward() != self.forward {
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
    /// those of an epoch that is over, or whose motion an endstop has ended, and all events in the queue are of one epoch.
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

    /// Motion time lags real time by so much, and was, or will be, up to date at `due`.
    fn set_lag(&mut self, ticks: u32, due: Tick) {
        self.lag = ticks;
        self.status.set_lag(ticks, due.0);
    }

    /// Nothing is due, but somebody may want to know of the endstops. False, for there is nothing to play.
    fn report_endstops(&mut self) -> bool {
        self.status.set_endstops(self.port.endstops());
        self.status.count_look();
        false
    }

    /// Passes over an event without steps.
    fn skip_event(&mut self) {
        self.status.event_played(self.due.0);
        self.after_event(self.next);
        let (interval, next) = self.events.advance();
        self.next = if next == PackedEvent::NONE { PackedEvent::RESTING } else { next };
        self.due = self.due.after(interval);
    }

    /// Has the port take another coupling, and sets the direction lines anew. At rest.
    pub fn recouple(&mut self, change: impl FnOnce(&mut P)) {
        change(&mut self.port);
        self.port.dir(self.forward);
    }

    /// What hardware does for it.
    pub const fn port(&mut self) -> &mut P {
        &mut self.port
    }

    /// Leaves the processor to the others for a while.
    #[inline(never)]
    fn yield_cpu(&mut self) {
        if !self.clock.alarm(self.clock.now().after(YIELD)) {
            self.pend.pend_stepper();
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
