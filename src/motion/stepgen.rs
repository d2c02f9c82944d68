//! The step generator: from released moves to step events.
//!
//! Moves are laid out as a [`Trajectory`], which every motor group follows in pieces in which its position is a
//! quadratic in time. The next event is the earliest next step of any group, with all groups that step in the same
//! tick. A group's count is always the position rounded to the nearest step, a step being due where the position
//! crosses a half.
//!
//! Time is counted in ticks times 2^16 from the start of the epoch; only the instant of a step is rounded to a whole
//! tick.

mod brake;
mod supply;

use super::course::Course;
use super::event::{LONGEST_INTERVAL, StepEvent};
use super::moves::{Entry, Move};
use super::queue::StepsIn;
use super::track::{Next, Track};
use super::trajectory::{Place, SpanMemory, Trajectory};
use crate::kinematics::Groups;
use crate::motors::MOST_GROUPS;
use crate::port::{EndstopSet, GroupSet, Pend};
use crate::status::Status;
use brake::Braking;
use heapless::spsc::Consumer;
use supply::Supply;

/// Events made in one call of [`StepGenerator::run`]: about a third of a millisecond on a Cortex-M4, after which the
/// interrupts of the same priority get their turn.
const BATCH: u32 = 64;

/// What is being done.
enum Task {
    Nothing,
    /// A move is being laid.
    Move(Course),
    /// A move that is being braked, and the speed squared that is left at its end.
    Brake(Course, u64),
    /// Nothing is left to be laid before the motors have come to rest; whether that ends an entry.
    Settling(bool),
    /// Time without motion, up to then.
    Dwell(u64),
}

/// Turns moves into step events.
pub struct StepGenerator<'m, W: Pend> {
    moves: Consumer<'m, Entry>,
    events: StepsIn<'m>,
    status: &'m Status,
    mechanism: &'m Groups,
    pend: W,
    epoch: u8,
    task: Task,
    trajectory: Trajectory<'m>,
    tracks: [Track; MOST_GROUPS],
    /// Tick of the last event.
    last: u64,
    /// The Stepper's tick when the epoch began.
    base: u32,
    braking: Braking,
    /// The last move, if it did not end at rest.
    behind: Option<Move>,
    /// Where the last move ended.
    place: Place,
    forward: GroupSet,
    watch: EndstopSet,
    /// Events made.
    made: u32,
    /// The Stepper had none left when one was made.
    is_news: bool,
}

impl<'m, W: Pend> StepGenerator<'m, W> {
    /// The generator between the two queues, for these groups of motors, which remembers the trajectory in `spans`. It learns where the machine stands from the first
    /// [`Work::Position`](super::moves::Work::Position).
    pub fn new(
        moves: Consumer<'m, Entry>,
        events: StepsIn<'m>,
        spans: &'m mut SpanMemory,
        status: &'m Status,
        mechanism: &'m Groups,
        pend: W,
    ) -> Self {
        Self {
            moves,
            events,
            status,
            mechanism,
            pend,
            epoch: status.epoch(),
            task: Task::Nothing,
            trajectory: Trajectory::new(spans),
            tracks: core::array::from_fn(|_| Track::still()),
            last: 0,
            base: status.tick(),
            braking: Braking::No,
            behind: None,
            place: Place::default(),
            forward: GroupSet::NONE,
            made: status.events_made(),
            is_news: false,
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
        let (mut room, enough) = (self.events.room(), self.enough());
        let end = self.made.wrapping_add(BATCH);
        while self.made != end {
            if room == 0 || self.is_ahead(enough) {
                self.publish();
                if self.events.mark(self.events.len() / 2) {
                    return;
                }
                break;
            }
            let made = self.made;
            if !self.advance() {
                self.publish();
                self.events.mark(0);
                return;
            }
            room -= self.made.wrapping_sub(made) as usize;
        }
        self.publish();
        self.pend.pend_generator();
    }

    /// Tells what is made.
    fn publish(&mut self) {
        self.status.set_events_made(self.made);
        if core::mem::take(&mut self.is_news) {
            self.pend.pend_stepper();
        }
    }

    /// Whether an endstop has ended this epoch's motion. The Stepper would discard whatever is left of it, and
    /// until it has, nobody below us would run: over a second for a long move of Z.
    fn has_met_endstop(&self) -> bool {
        !self.status.triggered().is_empty()
    }

    /// Drops the task of an epoch that is over.
    fn begin_epoch(&mut self) {
        self.epoch = self.status.epoch();
        let is_under_way = !matches!(self.task, Task::Nothing | Task::Settling(false));
        self.task = Task::Nothing;
        if is_under_way {
            self.status.entry_done();
        }
        self.last = 0;
        self.base = self.status.tick();
        self.braking = Braking::No;
        self.behind = None;
        self.status.set_stopped(None);
        for track in &mut self.tracks {
            track.stop();
        }
    }

    /// One event, piece or entry further; false if there is nothing to do.
    fn advance(&mut self) -> bool {
        let last = self.last as u32;
        let (mut nearest, mut is_moving) = (u32::MAX, false);
        for track in &self.tracks {
            if track.next != Next::Nothing {
                is_moving = true;
                nearest = nearest.min(track.due.wrapping_sub(last));
            }
        }
        if !is_moving {
            return self.rest();
        }
        let due = last.wrapping_add(nearest);
        let (mut steps, mut changes) = (0, 0);
        for (i, track) in self.tracks.iter().enumerate() {
            if track.due == due {
                match track.next {
                    Next::Nothing => {}
                    Next::Step => steps |= 1 << i,
                    Next::Change => changes |= 1 << i,
                }
            }
        }
        if changes != 0 {
            return self.lay_out(changes);
        }
        if nearest > LONGEST_INTERVAL {
            self.emit(LONGEST_INTERVAL, GroupSet::NONE);
            return true;
        }
        for (i, track) in self.tracks.iter_mut().enumerate() {
            if steps & 1 << i != 0 {
                let bit = if track.is_forward { 1 << i } else { 0 };
                self.forward.0 = self.forward.0 & !(1 << i) | bit;
                track.step();
            }
        }
        self.emit(nearest, GroupSet(steps));
        true
    }

    /// Lays out the next pieces of some groups; false if that must wait.
    fn lay_out(&mut self, groups: u8) -> bool {
        for (i, group) in self.mechanism.iter().enumerate().filter(|(i, _)| groups & 1 << i != 0) {
            let Some(track) = self.tracks.get_mut(i) else { continue };
            if track.go_back() {
                continue;
            }
            let time = track.end.time;
            while !Track::is_known(group, &mut self.trajectory, time) {
                match self.lay_more() {
                    Supply::Laid => {}
                    Supply::Rests => break,
                    Supply::Starved => return false,
                }
            }
            if let Some(track) = self.tracks.get_mut(i) {
                track.go_on(group, &self.trajectory, time);
            }
        }
        true
    }

    /// Lets time pass; true when `time` is reached.
    fn pass_until(&mut self, time: u64) -> bool {
        let left = ((time + (1 << 15)) >> 16).saturating_sub(self.last);
        if left > 0 {
            self.emit(left.min(u64::from(LONGEST_INTERVAL)) as u32, GroupSet::NONE);
        }
        left <= u64::from(LONGEST_INTERVAL)
    }

    fn emit(&mut self, interval: u32, steps: GroupSet) {
        let mechanism = self.mechanism;
        let (motors, forward) = (mechanism.motors(steps), mechanism.forward_motors(self.forward));
        debug_assert!(mechanism.mechanism().is_unstrained(motors, forward), "motors pull against each other");
        self.last += u64::from(interval);
        let event = StepEvent { interval, steps, forward: self.forward, epoch: self.epoch, watch: self.watch };
        if self.events.enqueue(event).is_ok() {
            self.made = self.made.wrapping_add(1);
            // Only a stepper that has run out of events needs to be told.
            self.is_news |= self.events.len() <= 1;
        }
    }
}
