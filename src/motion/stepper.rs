//! The stepper: plays step events on the pins, each at its tick.
//!
//! It runs in the step timer's interrupt at the highest priority. Everything it needs stands in the event;
//! it decides nothing but whether the moment has come. Motion time runs while there are events: at each
//! start after a rest, real time is taken anew, so a pause of the host never shows in the motion.

use super::event::StepEvent;
use crate::kinematics::{forward_motors, motors};
use crate::port::{GroupSet, Pend, StepClock, StepPort};
use crate::status::Status;
use crate::units::Tick;
use heapless::spsc::Consumer;

/// Events played or discarded in one interrupt: few enough to stay below 10 us at 1 us an event, so that the
/// timer is looked at again in time.
const BURST: usize = 8;

/// Between two such interrupts: 5 us for the others that wait. Discarding a full queue would otherwise keep them
/// waiting for a third of a millisecond.
const BREATH: u32 = 50;

/// An event that comes later than this moves all that follow: 10 us, half of the closest spacing at the
/// greatest speed of one motor. Steps are late then, but never too close to each other, and none is lost.
const GRACE: u32 = 100;

/// Between the first event's arrival and its alarm: 20 us, in which the generator makes a handful of events
/// (some 600 instructions each in QEMU) before the first one is due.
const LEAD: u32 = 200;

/// Plays step events.
pub struct Stepper<'m, P: StepPort, C: StepClock, W: Pend> {
    events: Consumer<'m, StepEvent>,
    status: &'m Status,
    port: P,
    clock: C,
    pend: W,
    /// The event that comes next, and when.
    next: Option<(StepEvent, Tick)>,
    /// When the last event was due, if motion has not rested since.
    running: Option<Tick>,
    /// Motion time.
    tick: u64,
    /// Direction lines as they are.
    forward: GroupSet,
    /// An epoch whose motion an endstop has ended.
    ended: Option<u8>,
}

impl<'m, P: StepPort, C: StepClock, W: Pend> Stepper<'m, P, C, W> {
    /// The stepper at the end of the StepQueue.
    pub fn new(events: Consumer<'m, StepEvent>, status: &'m Status, mut port: P, clock: C, pend: W) -> Self {
        port.dir(forward_motors(GroupSet::NONE));
        status.set_inputs(port.inputs());
        status.set_endstops(port.endstops());
        Self {
            events,
            status,
            port,
            clock,
            pend,
            next: None,
            running: None,
            tick: 0,
            forward: GroupSet::NONE,
            ended: None,
        }
    }

    /// Call it when the alarm rings and when it is pended. Bounded: plays or discards at most a few events.
    pub fn on_alarm(&mut self) {
        let tick = self.tick as u32;
        match self.play_due() {
            Some(at) => self.clock.alarm(at),
            None => self.clock.silence(),
        }
        // Where nothing was due somebody wants to know.
        if self.tick as u32 == tick {
            self.status.set_endstops(self.port.endstops());
        }
    }

    /// Plays what is due, and says when to come again.
    fn play_due(&mut self) -> Option<Tick> {
        // Nobody who could begin another epoch runs until we are done.
        let epoch = self.status.epoch();
        if self.ended.is_some_and(|ended| ended != epoch) {
            self.ended = None;
        }
        for _ in 0..BURST {
            if self.next.is_none() {
                self.fetch();
            }
            let (event, due) = self.next?;
            if event.epoch != epoch || self.ended.is_some() {
                self.discard();
                continue;
            }
            let now = self.clock.now();
            if now.is_before(due) {
                return Some(due);
            }
            if !event.watch.is_empty() {
                let pressed = self.port.endstops().and(event.watch);
                if !pressed.is_empty() {
                    self.status.set_triggered(pressed);
                    self.ended = Some(epoch);
                    self.discard();
                    continue;
                }
            }
            self.play(event);
            let late = now.since(due);
            self.running = Some(if late > GRACE {
                self.status.count_stretched();
                now
            } else {
                due
            });
        }
        Some(self.clock.now().after(BREATH))
    }

    /// Takes the next event from the queue and dates it.
    fn fetch(&mut self) {
        let Some(event) = self.events.dequeue() else {
            self.running = None;
            return;
        };
        if self.status.is_refill_due() {
            self.pend.pend_generator();
        }
        let due = match self.running {
            Some(last) => last.after(event.interval),
            None => self.clock.now().after(event.interval.max(LEAD)),
        };
        self.next = Some((event, due));
    }

    fn discard(&mut self) {
        self.next = None;
        self.running = None;
        self.status.event_done(self.tick as u32);
    }

    fn play(&mut self, event: StepEvent) {
        self.next = None;
        self.tick += u64::from(event.interval);
        if !event.steps.is_empty() {
            if event.forward != self.forward {
                self.forward = event.forward;
                self.port.dir(forward_motors(event.forward));
            }
            let motors = motors(event.steps);
            self.port.rise(motors, self.tick);
            // The pulse is as long as the counting takes, and the port sees to it that this is enough.
            self.status.count_steps(event.steps, event.forward);
            self.port.fall(motors);
            if !self.events.ready() {
                self.status.count_starved();
            }
        }
        self.status.event_done(self.tick as u32);
    }

    /// Motion time so far, in ticks.
    pub const fn tick(&self) -> u64 {
        self.tick
    }
}
