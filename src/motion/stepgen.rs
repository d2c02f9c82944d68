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

use super::course::{Course, Tail};
use super::event::LONGEST_INTERVAL;
use super::moves::Entry;
use super::queue::{StepsIn, Word};
use super::track::Track;
use super::trajectory::{Place, SpanMemory, Trajectory};
use super::turn::{Next, Turn};
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
    /// The move in the course is being laid.
    Move,
    /// It is being braked, and this speed squared is left at its end.
    Brake(u64),
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
    course: Course,
    trajectory: Trajectory<'m>,
    tracks: [Track; MOST_GROUPS],
    /// Tick of the last event.
    last: u64,
    /// The Stepper's tick when the epoch began.
    base: u32,
    braking: Braking,
    /// How the last move ended, if not at rest.
    behind: Option<Tail>,
    /// Where the last move ended.
    place: Place,
    forward: GroupSet,
    watch: EndstopSet,
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
            course: Course::NONE,
            trajectory: Trajectory::new(spans),
            tracks: core::array::from_fn(Track::still),
            last: 0,
            base: status.tick(),
            braking: Braking::No,
            behind: None,
            place: Place::default(),
            forward: GroupSet::NONE,
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
        let enough = self.enough();
        let begin = self.events.made();
        loop {
            let made = self.events.made().wrapping_sub(begin);
            if made >= BATCH {
                break;
            }
            let room = self.events.room();
            if room == 0 || self.is_ahead(enough) {
                self.publish();
                if self.events.mark(self.events.len() / 2) {
                    return;
                }
                break;
            }
            if !self.advance((BATCH - made).min(room as u32), enough) {
                self.publish();
                self.events.mark(0);
                return;
            }
        }
        self.publish();
        self.pend.pend_generator();
    }

    /// Tells what is made.
    fn publish(&mut self) {
        self.status.set_events_made(self.events.made());
        // A stepper that rests at what it has done last needs to be told of more.
        if self.status.rested_at() == self.events.done() && !self.events.is_empty() {
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

    /// Some steps, a piece or an entry further; false if there is nothing to do.
    fn advance(&mut self, most: u32, enough: u32) -> bool {
        let now = self.last as u32;
        self.tracks.iter_mut().for_each(|track| track.rest_on(now));
        let turn = nearest(&self.tracks, now);
        match turn.next() {
            Next::Step => {
                self.step(turn, most, enough);
                true
            }
            Next::Change => self.lay_out(now, turn),
            Next::Nothing => self.rest(),
        }
    }

    /// Makes up to `most` events, and at least one, as long as there is nothing but steps and they are not far enough
    /// ahead. All groups that step in one tick step in one event.
    fn step(&mut self, mut turn: Turn, most: u32, enough: u32) {
        let begin = self.last as u32;
        let mut now = begin;
        let mut word = self.waiting();
        for _ in 0..most {
            let interval = turn.wait();
            now = now.wrapping_add(interval);
            word = word.still();
            while let Some(track) = self.tracks.get_mut(turn.group()) {
                word = word.step(turn.group(), track.is_forward());
                track.step();
                turn = nearest(&self.tracks, now);
                if turn.wait() != 0 || turn.next() != Next::Step {
                    break;
                }
            }
            debug_assert!(self.is_unstrained(word), "motors pull against each other");
            self.events.put(interval, word);
            if turn.next() != Next::Step || (now.wrapping_sub(enough) as i32) > 0 {
                break;
            }
        }
        self.forward = word.forward();
        self.last += u64::from(now.wrapping_sub(begin));
    }

    /// Lays out the next pieces of all groups that change in the tick of `turn`; false if that must wait. One round for
    /// all, for an axis that one group has followed further than its next piece is lost for the others.
    fn lay_out(&mut self, now: u32, turn: Turn) -> bool {
        for (number, group) in self.mechanism.iter().enumerate() {
            let Some(track) = self.tracks.get_mut(number) else { continue };
            if !track.turn(now).is_together(turn) || track.go_back() {
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
            if let Some(track) = self.tracks.get_mut(number) {
                track.go_on(group, &self.trajectory, time);
            }
        }
        true
    }

    /// Lets time pass; true when `time` is reached.
    fn pass_until(&mut self, time: u64) -> bool {
        let left = ((time + (1 << 15)) >> 16).saturating_sub(self.last);
        if left > 0 {
            self.wait(left.min(u64::from(LONGEST_INTERVAL)) as u32);
        }
        left <= u64::from(LONGEST_INTERVAL)
    }

    /// Whether the steps of an event leave no motor pulling against another of its group.
    fn is_unstrained(&self, word: Word) -> bool {
        let mechanism = self.mechanism;
        let (motors, forward) = (mechanism.motors(word.steps()), mechanism.forward_motors(word.forward()));
        mechanism.mechanism().is_unstrained(motors, forward)
    }

    /// Lets so much time pass in an event without steps.
    fn wait(&mut self, interval: u32) {
        self.last += u64::from(interval);
        self.events.put(interval, self.waiting());
    }

    /// An event without steps.
    fn waiting(&self) -> Word {
        Word::waiting(self.epoch, self.watch).stepping(GroupSet::NONE, self.forward)
    }
}

/// The turn that comes first.
#[inline(always)]
fn nearest(tracks: &[Track; MOST_GROUPS], now: u32) -> Turn {
    // Not `min`, which takes a call.
    tracks.iter().fold(Turn::LAST, |first, track| {
        let turn = track.turn(now);
        if turn < first { turn } else { first }
    })
}
