//! The step generator: from released moves to step events. It runs in an interrupt below the Stepper's.
//!
//! ```text
//! MoveQueue -> entries -> alignment -> current_move -> trajectory           what the axes do
//!                 ^ brake replaces what is left of the move                      |
//!        +-------------------------------+------------------------------+       v
//!  group_stepper 0: a piece        group_stepper 1: a piece         ...         what each group does
//!    step_time_solver              step_time_solver                             when it crosses a half step
//!    step_time_buffer 12 19 26     step_time_buffer 12 20 28                    ticks of the next steps
//!        +---------------+---------------+
//!                      merge -> StepQueue                                       events in order of time
//! ```
//!
//! Moves are laid as a [`Trajectory`]. Every motor group follows it in pieces in which its position is a quadratic in
//! time. A group's count is always the position rounded to the nearest step, so a step is due where the position
//! crosses a half. Each group's next steps are solved some at a time within its piece. Then the steps of all groups are
//! merged to events, up to where a group must solve more.
//!
//! Time is counted in ticks times 2^16 from the start of the epoch; only the instant of a step is rounded to a whole
//! tick.
//!
//! # Words
//!
//! - **group**: motors that step together. **piece**: the time in which a group's position is one quadratic. It ends at
//!   the next change of a tap of one of its axes, or at a reversal.
//! - **step time**: the tick of a step. **step threshold**: the position between two counts, where a step is due.
//! - **slow end**: the end of a piece with the lower speed; all step times are computed from there.
//! - **cubic run**: consecutive step times that lie on one cubic. **run** (of events): events that the Stepper sees all
//!   at once.
//! - **task**: the generator's present job: a move, a sweep, a brake, a dwell, or waiting until the motors are
//!   at rest.
//! - **to publish**: to show the other contexts how many events and steps are made.

mod alignment;
mod brake;
mod cubic_run;
mod current_move;
mod entries;
mod group_stepper;
mod merge;
mod step_time_buffer;
mod step_time_solver;
mod sweeping;
mod z_count;

use crate::fault::{Cause, Fault};
use crate::kinematics::{Groupings, Groups};
use crate::motion::queue::{LONGEST_INTERVAL, PackedEvent, SLOTS, StepsIn};
use crate::motion::surface::SurfaceFrame;
use crate::motion::ticks::{NEAR, earlier};
use crate::motion::trajectory::{AXES, Position, SpanMemory, Trajectory};
use crate::motion::work::Entry;
use crate::motors::MOST_GROUPS;
use crate::port::{EndstopSet, GroupSet, Wake};
use crate::status::Status;
use crate::surface::Heights;
use crate::units::SpeedSq;
use crate::units::SubTicks;
use alignment::Alignment;
use brake::Braking;
use current_move::{CurrentMove, LastPhase};
use entries::LayResult;
use group_stepper::GroupStepper;
use heapless::spsc::Consumer;
use merge::TURN_AHEAD;
use sweeping::Sweeping;
use z_count::ZCount;

/// Events made in one call of [`StepGenerator::run`]: about 10,000 instructions, 0.1 ms at 125 million a second. Then
/// interrupts of the same priority get their turn.
const BATCH: u32 = 128;

/// In motion, events are made only this far ahead of time, in ticks: 10 ms. Made events can no longer be braked, so
/// M410 takes this long to begin slowing down. A full queue of 511 events lasts for 10 ms at 51,000 events a second; a
/// longer one never fills unless this grows too.
const AHEAD: u32 = 100_000;

/// Events made ahead at least, however long they take.
const LEAST_AHEAD: usize = 4;

/// While the generator does not know the next step, it makes an event without steps at this interval, in ticks: 10 ms.
/// The Console releases moves by the Stepper's time, 50 ms ahead. Without such events it would learn the time only
/// after the last known step, which is too late below 20 steps a second. [`LEAST_AHEAD`] such events last for less than
/// the 50 ms.
const PASSING: u32 = 100_000;

/// With less room the queue counts as full. A generator that fills every slot as it gets free would never pause.
const LEAST_ROOM: usize = 32;
// A batch fits into a queue that does not count as full.
const _: () = assert!(BATCH as usize + LEAST_ROOM < SLOTS);

/// One in this many calls checks the taps of an axis. This is less than a thousandth of the generator's work, and all
/// axes are checked several times a second while motors turn.
const SCRUB: u8 = 8;

/// The generator's present job.
enum Task {
    Nothing,
    /// The current move is being laid.
    Move,
    /// The sweep is being laid.
    Sweep,
    /// The current move is being braked, with this speed squared left at its end.
    Brake(SpeedSq),
    /// All work is laid, and the motors come to rest; whether that ends an entry.
    ComingToRest(bool),
    /// Time without motion, until this time.
    Dwell(SubTicks),
}

/// Turns moves into step events.
pub struct StepGenerator<'m> {
    moves: Consumer<'m, Entry>,
    events: StepsIn<'m>,
    status: &'m Status,
    groupings: &'m Groupings,
    /// The grouping in use.
    mechanism: &'m Groups,
    epoch: u8,
    task: Task,
    current_move: CurrentMove,
    sweeping: Sweeping,
    alignment: Alignment,
    trajectory: Trajectory<'m>,
    group_steppers: [GroupStepper; MOST_GROUPS],
    /// Their counts at the last publication.
    published: [i32; MOST_GROUPS],
    /// Tick of the last event.
    last_tick: u64,
    /// The Stepper's tick at the begin of the epoch.
    base_tick: u32,
    braking: Braking,
    /// End of the last move, if not at rest.
    last_phase: Option<LastPhase>,
    /// Position at the end of the last move.
    position: Position,
    z_count: ZCount,
    forward: GroupSet,
    watch: EndstopSet,
    /// Calls so far, wrapping.
    calls: u8,
    /// The events made lead into motion.
    is_under_way: bool,
    /// If so, the number of the next event at the begin of the present call. A Stepper that rests there has starved.
    dry_at: Option<u32>,
}

impl<'m> StepGenerator<'m> {
    /// The generator between the two queues, for these groupings of motors. The first one is in use at start. `spans`
    /// holds the trajectory. The Stepper exists already. The first
    /// [`Work::Position`](crate::motion::work::Work::Position) tells it the machine's position.
    pub fn new(
        moves: Consumer<'m, Entry>,
        mut events: StepsIn<'m>,
        spans: &'m mut SpanMemory,
        status: &'m Status,
        groupings: &'m Groupings,
    ) -> Self {
        let mechanism = &groupings.tool;
        events.set_slow_groups(status.slow_groups());
        Self {
            moves,
            events,
            status,
            groupings,
            mechanism,
            epoch: status.epoch(),
            task: Task::Nothing,
            current_move: CurrentMove::NONE,
            sweeping: Sweeping::NONE,
            alignment: Alignment::new(mechanism),
            trajectory: Trajectory::new(spans),
            group_steppers: [GroupStepper::STILL; MOST_GROUPS],
            published: [0; MOST_GROUPS],
            last_tick: 0,
            base_tick: status.tick(),
            braking: Braking::No,
            last_phase: None,
            position: Position::default(),
            z_count: ZCount::new(),
            forward: GroupSet::NONE,
            watch: EndstopSet::NONE,
            calls: 0,
            is_under_way: false,
            dry_at: None,
        }
    }

    /// Makes step events until they reach far enough ahead, no work is left, or a bounded amount of work is done. In
    /// the last case it pends itself. Call it whenever either queue may have changed.
    ///
    /// Returns whether the Console may have waited for this call. That is so if an entry of the MoveQueue was taken or
    /// is done, or if no event was made, as at the end of the motion. Most calls in a long move only make more events.
    ///
    /// A crate takes its loops, from here to the steps of a group, into a function of its own. So the level at which
    /// that crate is optimised holds for them, whatever the level of this one.
    #[inline(always)]
    pub fn run(&mut self, wake: &dyn Wake) -> bool {
        self.status.heat().beat_of_generator();
        self.scrub();
        let before = (self.moves.len(), self.status.entries_done());
        let made = self.events.made();
        let is_more_to_do = self.make_events();
        // A Stepper that rests after the last event needs a call when there are more.
        let rested = self.status.rested_at();
        if rested == self.events.done() && !self.events.is_empty() {
            if self.dry_at.take() == Some(rested) {
                self.status.count_starved();
            }
            wake.wake_stepper();
        }
        if is_more_to_do {
            wake.wake_generator();
        }
        self.events.made() == made || (self.moves.len(), self.status.entries_done()) != before
    }

    /// The surface that z follows, if any; for a simulator, which shows it.
    #[must_use]
    pub fn surface(&self) -> Option<(&SurfaceFrame, &Heights)> {
        self.trajectory.surface()
    }

    /// The endstops that end the present move; for a simulator.
    #[must_use]
    pub const fn watched(&self) -> EndstopSet {
        self.watch
    }

    /// The position that each group has, in steps, less the steps that it has made: a new name for a position is no
    /// step. It is for a simulator, and holds in motion.
    #[must_use]
    pub fn origin(&self) -> [i32; MOST_GROUPS] {
        let made = self.status.steps_made();
        core::array::from_fn(|group| match (self.published.get(group), made.get(group)) {
            (Some(position), Some(made)) => position.wrapping_sub(*made),
            _ => 0,
        })
    }

    /// Entries of the MoveQueue that are done or dropped, wrapping, so the number of the present one. If that is a move
    /// on its planned path, the Stepper's tick, wrapping, at which this path began. It is for a simulator.
    #[must_use]
    pub fn under_way(&self) -> (u32, Option<u32>) {
        let is_move = matches!(self.task, Task::Move | Task::ComingToRest(true)) && self.braking == Braking::No;
        let begin = is_move.then(|| {
            let begin = self.trajectory.end().time.saturating_sub(self.current_move.laid_time());
            self.base_tick.wrapping_add(begin.whole_ticks() as u32)
        });
        (self.status.entries_done(), begin)
    }

    /// Checks the taps of an axis, which no other context can see, in one of [`SCRUB`] calls: all axes in turn.
    fn scrub(&mut self) {
        self.calls = self.calls.wrapping_add(1);
        if self.calls.is_multiple_of(SCRUB) && !self.trajectory.is_whole(usize::from(self.calls / SCRUB) % AXES) {
            self.status.fault().set(Fault::plain(Cause::SettingsDamaged));
        }
    }

    /// Makes as many events as one call may; whether there is more to do at once.
    #[inline(always)]
    fn make_events(&mut self) -> bool {
        // First, because a brake or an offset of the epoch before means nothing in the next one.
        if self.status.epoch() != self.epoch || self.has_met_endstop() {
            self.begin_epoch();
        }
        if self.braking == Braking::No && self.status.is_braking(self.epoch) && !self.has_met_endstop() {
            self.begin_brake();
        }
        if self.status.z_offset().ordered() != self.z_count.ordered && self.braking == Braking::No {
            self.shift_z(false);
        }
        self.note_replay();
        // Once a call: the Stepper plays on meanwhile, and a limit that moves with it would never be reached.
        let enough = self.far_enough();
        let begin = self.events.made();
        self.dry_at = Some(begin).filter(|_| self.is_under_way);
        loop {
            let made = self.events.made().wrapping_sub(begin);
            if made >= BATCH {
                self.publish();
                return true;
            }
            let room = self.events.room();
            if room < LEAST_ROOM || self.is_ahead(enough) {
                self.publish();
                // The Stepper calls at half of what waits, and the other half is for coming late. If it is there
                // already, there is more to do at once.
                return !self.events.mark(self.events.len() / 2);
            }
            if !self.advance((BATCH - made).min(room as u32), enough) {
                self.publish();
                // Nothing can be made before work comes, and then the Console calls.
                self.events.mark(0);
                return false;
            }
        }
    }

    /// The tick up to which events are made.
    fn far_enough(&self) -> u32 {
        self.status.tick().wrapping_sub(self.base_tick).wrapping_add(AHEAD)
    }

    /// Whether the events made reach far enough and are not too few.
    fn is_ahead(&self, enough: u32) -> bool {
        (self.last_tick as u32).wrapping_sub(enough) as i32 > 0 && self.events.len() >= LEAST_AHEAD
    }

    /// Publishes the events and steps made.
    fn publish(&mut self) {
        for group in 0..MOST_GROUPS {
            let count = self.group_steppers[group].count();
            let before = core::mem::replace(&mut self.published[group], count);
            self.status.add_steps_made(group, count.wrapping_sub(before));
        }
        self.status.set_events_made(self.events.made());
        self.tell_z_offset();
    }

    /// Whether an endstop has ended this epoch's motion: the Stepper plays none of its remaining events.
    fn has_met_endstop(&self) -> bool {
        !self.status.triggered().is_empty()
    }

    /// Drops the task of a finished epoch and all its events that are not played.
    fn begin_epoch(&mut self) {
        self.epoch = self.status.epoch();
        self.drop_z_offset(self.played());
        let unplayed = self.events.take_back();
        for (group, steps) in unplayed.into_iter().enumerate() {
            self.status.add_steps_made(group, steps.wrapping_neg());
        }
        let is_under_way = !matches!(self.task, Task::Nothing | Task::ComingToRest(false));
        self.task = Task::Nothing;
        if is_under_way {
            self.status.entry_done();
        }
        self.last_tick = 0;
        self.base_tick = self.status.tick();
        self.braking = Braking::No;
        self.last_phase = None;
        self.is_under_way = false;
        self.status.set_stopped(None);
        for stepper in &mut self.group_steppers {
            stepper.stop(0);
        }
    }

    /// Advances by some steps, a piece or an entry; false if there is nothing to do.
    #[inline(always)]
    fn advance(&mut self, most: u32, enough: u32) -> bool {
        let now = self.last_tick as u32;
        // The steps of all groups are known up to here.
        let mut until = now.wrapping_add(NEAR);
        if let Some(due) = self.z_count.replay {
            until = earlier(until, due);
        }
        for stepper in &mut self.group_steppers {
            stepper.refill(now);
            until = earlier(until, stepper.step_times.known_until());
        }
        if self.merge(until, most, enough) {
            self.is_under_way = true;
            return true;
        }
        if self.z_count.replay == Some(until) && self.replay_shift(until) {
            return true;
        }
        // So slow that the next piece is too far from the last event.
        if until == now.wrapping_add(NEAR)
            && self.group_steppers.iter().any(|stepper| stepper.end.time != SubTicks::MAX)
        {
            self.wait(NEAR);
            return true;
        }
        if self.group_steppers.iter().any(|stepper| stepper.piece_ends_at(until)) {
            self.lay_out(until) || self.bide(until)
        } else {
            self.go_on_from_rest()
        }
    }

    /// Lets a part of the time pass up to a piece that is not known yet; false close before it. Directions can still be
    /// set ahead of a step at its begin.
    fn bide(&mut self, until: u32) -> bool {
        let left = until.wrapping_sub(self.last_tick as u32).saturating_sub(2 * TURN_AHEAD);
        if left > 0 {
            self.wait(left.min(PASSING));
        }
        left > 0
    }

    /// Lays out the next pieces of all groups that change at a tick; false if that must wait. All in one go: when one
    /// group has followed an axis into its next piece, the others can no longer see the end of the present one.
    fn lay_out(&mut self, tick: u32) -> bool {
        for (number, group) in self.mechanism.iter().enumerate() {
            let Some(stepper) = self.group_steppers.get_mut(number) else { continue };
            if !stepper.piece_ends_at(tick) {
                continue;
            }
            if stepper.begin_return() {
                self.turn(number);
                continue;
            }
            let time = stepper.end.time;
            while !GroupStepper::is_known(group, &mut self.trajectory, time) {
                match self.lay_more() {
                    LayResult::Laid => {}
                    // Nothing follows, so the axes rest where they are, and that is all that a group needs to know.
                    LayResult::AtRest => break,
                    LayResult::Starved => return false,
                }
            }
            if let Some(stepper) = self.group_steppers.get_mut(number) {
                stepper.begin_next_piece(group, &self.trajectory, time);
                self.turn(number);
            }
        }
        true
    }

    /// Sets the present direction of a group's steps.
    fn turn(&mut self, number: usize) {
        if let Some(is_forward) = self.group_steppers.get(number).and_then(GroupStepper::direction) {
            let group = 1 << number;
            self.forward.0 = if is_forward { self.forward.0 | group } else { self.forward.0 & !group };
        }
    }

    /// A tick after the last event that is played, so that its step is made. Without events that wait it is the last
    /// one of all: the machine may have rested for longer than ticks can tell.
    fn played(&self) -> SubTicks {
        let ahead = (self.last_tick as u32).wrapping_sub(self.status.tick().wrapping_sub(self.base_tick));
        let ahead = if self.events.is_empty() { 0 } else { ahead };
        SubTicks::of_ticks(self.last_tick.saturating_sub(ahead.into()) + 1)
    }

    /// A tick after the last event, so that its step is made, and not before the begin of any motor's piece.
    fn next_instant(&self) -> SubTicks {
        let begun = self.group_steppers.iter().map(|stepper| stepper.start).max().unwrap_or_default();
        SubTicks::of_ticks(self.last_tick + 1).max(begun)
    }

    /// Lets time pass; true when `time` is reached.
    fn pass_until(&mut self, time: SubTicks) -> bool {
        let left = time.nearest_tick().saturating_sub(self.last_tick);
        if left > 0 {
            self.wait(left.min(u64::from(LONGEST_INTERVAL)) as u32);
        }
        left <= u64::from(LONGEST_INTERVAL)
    }

    /// Lets this much time pass in an event without steps.
    fn wait(&mut self, interval: u32) {
        self.last_tick += u64::from(interval);
        self.events.put(interval, self.waiting());
    }

    /// An event without steps.
    #[inline(always)]
    fn waiting(&self) -> PackedEvent {
        PackedEvent::waiting(self.epoch, self.watch).stepping(GroupSet::NONE, self.forward)
    }
}

#[cfg(test)]
mod tests;
