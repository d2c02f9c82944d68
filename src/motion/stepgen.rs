//! The step generator: from released moves to step events.
//!
//! A move is taken phase by phase. In each phase every motor group has a [`Path`], and the next event is
//! the earliest next step of any group, with all groups that step in the same tick. A group's count is
//! always the position rounded to the nearest step, a step being due where the position crosses a half.
//!
//! Time is counted in ticks times 2^16 from the start of the epoch, so a phase begins where the one before
//! ended to within 2^-17 of a tick; only the instant of a step is rounded to a whole tick.

mod brake;

use super::event::{LONGEST_INTERVAL, StepEvent};
use super::moves::{Entry, Move, Work};
use super::track::{Phase, Track, phases, point};
use crate::kinematics::{GROUPS, count_at, is_unstrained};
use crate::port::{EndstopSet, MotorSet, Pend};
use crate::status::Status;
use crate::units::Steps;
use brake::{Braking, Moment};
use heapless::spsc::{Consumer, Producer};

/// Two pulses of a motor are at least this many ticks apart: 1 us, ten times what the driver asks for
/// (TMC2209 datasheet rev 1.09, section 13.1: STEP high and low 100 ns each). Motion at legal speeds is at
/// most half as dense; a motor that reverses within half a step can come near it.
pub const MIN_STEP_INTERVAL: u64 = 10;

/// Events made in one call of [`StepGenerator::run`]: about a third of a millisecond on a Cortex-M4, after which the
/// interrupts of the same priority get their turn.
const BATCH: usize = 64;

/// What is being done.
#[derive(Clone, Copy)]
enum Task {
    Nothing,
    /// A move, from where, and which phase comes next.
    Move(Move, [Steps; 4], usize),
    /// Time without motion.
    Dwell,
    /// A move that is being braked: where it ends then, and the speed squared that is left there.
    Brake([Steps; 4], u64),
}

/// Turns moves into step events.
pub struct StepGenerator<'m, W: Pend> {
    moves: Consumer<'m, Entry>,
    events: Producer<'m, StepEvent>,
    status: &'m Status,
    pend: W,
    epoch: u8,
    task: Task,
    tracks: [Track; GROUPS.len()],
    /// End of the present phase, in ticks times 2^16.
    end: u64,
    /// Tick of the last event.
    last: u64,
    /// The Stepper's tick when the epoch began.
    base: u32,
    braking: Braking,
    /// The last move, if it did not end at rest.
    behind: Option<Move>,
    /// Where the last move ended.
    position: [Steps; 4],
    forward: MotorSet,
    watch: EndstopSet,
}

impl<'m, W: Pend> StepGenerator<'m, W> {
    /// The generator between the two queues. It learns where the machine stands from the first
    /// [`Work::Position`].
    pub fn new(moves: Consumer<'m, Entry>, events: Producer<'m, StepEvent>, status: &'m Status, pend: W) -> Self {
        Self {
            moves,
            events,
            status,
            pend,
            epoch: status.epoch(),
            task: Task::Nothing,
            tracks: [Track::still(); GROUPS.len()],
            end: 0,
            last: 0,
            base: status.tick(),
            braking: Braking::No,
            behind: None,
            position: [Steps::ZERO; 4],
            forward: MotorSet::NONE,
            watch: EndstopSet::NONE,
        }
    }

    /// Makes step events until they reach far enough ahead, nothing is left to do, or a bounded amount of work is
    /// done; in the last case it pends itself. Call it whenever either queue may have moved.
    pub fn run(&mut self) {
        if self.status.epoch() != self.epoch || self.has_met_endstop() {
            self.begin_epoch();
        }
        if self.braking == Braking::No && self.status.is_braking(self.epoch) {
            self.begin_brake();
        }
        for _ in 0..BATCH {
            if !self.events.ready() || self.is_ahead() {
                if self.status.set_refill(self.status.events_waiting() / 2) {
                    return;
                }
                break;
            }
            if !self.advance() {
                self.status.set_refill(0);
                return;
            }
        }
        self.pend.pend_generator();
    }

    /// Whether an endstop has ended this epoch's motion. The Stepper would discard whatever is left of it, and
    /// until it has, nobody below us would run: over a second for a long move of Z.
    fn has_met_endstop(&self) -> bool {
        !self.status.triggered().is_empty()
    }

    /// Drops the task of an epoch that is over.
    fn begin_epoch(&mut self) {
        self.epoch = self.status.epoch();
        if !matches!(self.task, Task::Nothing) {
            self.task = Task::Nothing;
            self.status.entry_done();
        }
        self.end = 0;
        self.last = 0;
        self.base = self.status.tick();
        self.braking = Braking::No;
        self.behind = None;
        self.status.set_stopped(None);
        for track in &mut self.tracks {
            track.next = None;
            track.free = 0;
        }
    }

    /// One event, phase or entry further; false if there is nothing to do.
    fn advance(&mut self) -> bool {
        let due = self.tracks.iter().filter_map(|t| t.next).map(|(tick, _)| tick).min();
        if let Some(tick) = due.filter(|tick| *tick < self.end_of_steps()) {
            self.step(tick);
            return true;
        }
        match self.task {
            Task::Nothing => self.next_entry(),
            Task::Dwell => {
                if self.rest() {
                    self.finish();
                }
                true
            }
            Task::Move(m, from, phase) => {
                match phases(&m).get(phase) {
                    Some(p) => {
                        self.begin_phase(&m, from, p, phase);
                        self.task = Task::Move(m, from, phase + 1);
                    }
                    None => {
                        self.position = m.end;
                        self.behind = (!m.rests).then_some(m);
                        // At a standstill an event marks the end of the motion, so that time is whole there.
                        if !m.rests || self.rest() {
                            self.finish();
                        }
                    }
                }
                true
            }
            Task::Brake(end, rest) => {
                self.position = end;
                self.finish();
                self.go_on_with(rest);
                true
            }
        }
    }

    /// The first tick whose steps do not belong to the present phase. Steps on the boundary between two
    /// phases belong to the later one, where they meet those of the other groups in one event; at a
    /// standstill there is no later one.
    fn end_of_steps(&self) -> u64 {
        let end = (self.end + (1 << 15)) >> 16;
        match self.task {
            Task::Move(m, _, phase) if m.rests && phases(&m).get(phase).is_none() => end + 1,
            _ => end,
        }
    }

    fn finish(&mut self) {
        self.task = Task::Nothing;
        self.status.entry_done();
    }

    fn next_entry(&mut self) -> bool {
        let Some(entry) = self.moves.dequeue() else {
            return false;
        };
        if entry.epoch != self.epoch || self.has_met_endstop() || self.braking == Braking::Done {
            self.status.entry_done();
            return true;
        }
        match entry.work {
            Work::Move(m) => {
                self.watch = m.watch;
                self.task = Task::Move(m, self.position, 0);
                if let Braking::Slowing(square) = self.braking {
                    self.brake(&m, self.position, Moment { done: 0, square });
                }
            }
            Work::Dwell(time) => {
                self.end += time;
                self.watch = EndstopSet::NONE;
                self.task = Task::Dwell;
            }
            Work::Position(position) => {
                self.position = position;
                for (track, group) in self.tracks.iter_mut().zip(&GROUPS) {
                    track.count = count_at(group.coordinate(position));
                    track.next = None;
                }
                self.status.entry_done();
            }
        }
        true
    }

    fn begin_phase(&mut self, m: &Move, from: [Steps; 4], phase: &Phase, index: usize) {
        let begin = self.end;
        self.end += phase.time;
        for (track, group) in self.tracks.iter_mut().zip(&GROUPS) {
            let (first, last) = (group.coordinate(from), group.coordinate(m.end));
            // A phase begins where the one before it ended, to the last bit.
            let start = if index == 0 { first } else { track.path.end() };
            track.lay(start, point(first, last, phase.end), phase, begin);
        }
    }

    /// Emits the event at `tick`.
    fn step(&mut self, tick: u64) {
        if !self.pass_time(tick) {
            return;
        }
        let begin = self.end - self.tracks[0].path.time();
        let mut steps = MotorSet::NONE;
        for (track, group) in self.tracks.iter_mut().zip(&GROUPS) {
            let Some((_, ahead)) = track.next.filter(|(due, _)| *due == tick) else {
                continue;
            };
            steps = steps.with(group.with).with(group.against);
            let (forward, backward) = if ahead { (group.with, group.against) } else { (group.against, group.with) };
            self.forward = self.forward.without(backward).with(forward);
            track.count = track.count.wrapping_add(if ahead { 1 } else { -1 });
            track.free = tick + MIN_STEP_INTERVAL;
            track.plan_next(begin);
        }
        debug_assert!(is_unstrained(steps, self.forward), "the belt is strained at tick {tick}");
        self.emit(tick, steps);
    }

    /// Lets time pass up to the end of the present task; true when that is reached.
    fn rest(&mut self) -> bool {
        let tick = (self.end + (1 << 15)) >> 16;
        if tick > self.last {
            if !self.pass_time(tick) {
                return false;
            }
            self.emit(tick, MotorSet::NONE);
        }
        true
    }

    /// Cuts a pause that no single event can span; true when the rest of it fits.
    fn pass_time(&mut self, tick: u64) -> bool {
        let fits = tick.saturating_sub(self.last) <= u64::from(LONGEST_INTERVAL);
        if !fits {
            self.emit(self.last + u64::from(LONGEST_INTERVAL), MotorSet::NONE);
        }
        fits
    }

    fn emit(&mut self, tick: u64, steps: MotorSet) {
        // The last step of a phase may be rounded beyond its end, the first of the next is not before it.
        let interval = tick.saturating_sub(self.last) as u32;
        self.last = self.last.max(tick);
        let event = StepEvent { interval, steps, forward: self.forward, epoch: self.epoch, watch: self.watch };
        if self.events.enqueue(event).is_ok() {
            self.status.event_made();
            // Only a stepper that has run out of events needs to be told.
            if self.events.len() <= 1 {
                self.pend.pend_stepper();
            }
        }
    }
}
