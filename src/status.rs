//! Status: what the contexts know of each other, beside the moves and step events in the queues.
//!
//! Single atomics, each with one writer: the one that its field names, or else the Console. `triggered` alone has two: the Stepper sets it, and the
//! Console clears it when it has begun another epoch and everybody is idle. A count that both sides keep says without a
//! race whether there is motion: none when as much was finished as was begun. Readers get copies, so what they read
//! together may be of different instants; where that matters the method says in which order it reads.

mod counted;
mod overload;
mod print_progress;

use crate::motors::{EndstopSet, GroupSet, MOST_GROUPS};
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering::Acquire, Ordering::Relaxed, Ordering::Release};
use counted::Counted;
use overload::Lateness;
pub use overload::{Late, Overload};
use print_progress::PrintProgress;

/// What the contexts know of each other.
#[repr(C)]
pub struct Status {
    /// Work of another epoch is discarded; written by the Console.
    epoch: AtomicU8,
    /// Endstops that ended the present epoch's motion; written by the Stepper, cleared with the epoch.
    triggered: AtomicU8,
    /// All endstop inputs as the Stepper last saw them.
    endstops: AtomicU8,
    /// The endstops that there are; written when the Stepper is made.
    inputs: AtomicU8,
    /// Groups whose step lines take longer; written when the Stepper is made.
    slow: AtomicU8,
    /// When the last event was due, by the step timer; written by the Stepper.
    due: AtomicU32,
    /// By how many ticks motion time lags the step timer; written by the Stepper.
    lag: AtomicU32,
    /// Entries of the MoveQueue finished; written by the StepGenerator.
    entries_done: AtomicU32,
    /// Events put into the StepQueue; written by the StepGenerator.
    events_made: AtomicU32,
    /// Events taken out of the StepQueue when motion last came to rest; written by the Stepper.
    rested: AtomicU32,
    /// How often the StepQueue ran dry in mid-motion; written by the Stepper.
    starved: AtomicU32,
    /// Events that came so late that time was stretched; written by the Stepper.
    late: Lateness,
    /// Spans that were made longer; written by the StepGenerator.
    squeezed: Lateness,
    /// Whether the Console waits for the host and has nothing else to do.
    awaiting_input: AtomicBool,
    /// Moves planned.
    moves: AtomicU32,
    /// Length of the path planned, in um, wrapping.
    path_um: AtomicU32,
    /// How often the host was so slow that the look-ahead had to let go of moves unfinished.
    underruns: AtomicU32,
    /// Moves planned and not yet begun, as of the Console's last turn.
    level: AtomicU32,
    /// One more than the fewest moves in the look-ahead while the stream ran; 0 if it never did. (A status of
    /// zeros costs no flash.)
    low_water: AtomicU32,
    /// Whether an emergency stop holds until M999 or a reset.
    halted: AtomicBool,
    /// What the print's own lines say of it.
    pub(crate) print_progress: PrintProgress,
    /// One more than the epoch whose motion is to come to rest along its path; 0 for none; written by the Console.
    brake: AtomicU32,
    /// One more than the epoch whose motion has come to rest; 0 for none; written by the StepGenerator.
    stopped: AtomicU32,
    /// Steps of the events put into the StepQueue; written by the StepGenerator.
    made: Counted,
}

impl Default for Status {
    fn default() -> Self {
        Self::new()
    }
}

impl Status {
    /// Everything at rest.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            epoch: AtomicU8::new(0),
            triggered: AtomicU8::new(0),
            endstops: AtomicU8::new(0),
            inputs: AtomicU8::new(0),
            slow: AtomicU8::new(0),
            due: AtomicU32::new(0),
            lag: AtomicU32::new(0),
            entries_done: AtomicU32::new(0),
            events_made: AtomicU32::new(0),
            rested: AtomicU32::new(0),
            starved: AtomicU32::new(0),
            late: Lateness::new(),
            squeezed: Lateness::new(),
            awaiting_input: AtomicBool::new(false),
            moves: AtomicU32::new(0),
            path_um: AtomicU32::new(0),
            underruns: AtomicU32::new(0),
            level: AtomicU32::new(0),
            low_water: AtomicU32::new(0),
            halted: AtomicBool::new(false),
            print_progress: PrintProgress::new(),
            brake: AtomicU32::new(0),
            stopped: AtomicU32::new(0),
            made: Counted::new(),
        }
    }

    /// Steps of all events put into the StepQueue and not taken back.
    pub(crate) fn steps_made(&self) -> [i32; MOST_GROUPS] {
        self.made.read()
    }

    /// So many more steps of each group are in the StepQueue. The StepGenerator is the only writer.
    pub(crate) fn add_steps_made(&self, steps: [i32; MOST_GROUPS]) {
        self.made.add(steps);
    }

    /// An event that was due at this tick of the step timer is played. The Stepper is the only writer.
    #[inline(always)]
    pub(crate) fn event_played(&self, due: u32) {
        self.due.store(due, Relaxed);
    }

    /// When the last event was due; for the Stepper.
    pub(crate) fn played_at(&self) -> u32 {
        self.due.load(Relaxed)
    }

    /// Motion time lags the step timer by so many ticks, and is what it was: the last event is now dated `due`.
    pub(crate) fn set_lag(&self, ticks: u32, due: u32) {
        self.lag.store(ticks, Relaxed);
        self.event_played(due);
    }

    /// The present epoch.
    #[must_use]
    pub fn epoch(&self) -> u8 {
        self.epoch.load(Acquire)
    }

    /// The same for the Stepper: nothing that another context has done is still under way while it runs.
    #[inline(always)]
    pub(crate) fn epoch_in_interrupt(&self) -> u8 {
        self.epoch.load(Relaxed)
    }

    /// Begins a new epoch: everything queued is to be discarded.
    pub(crate) fn next_epoch(&self) -> u8 {
        let epoch = self.epoch().wrapping_add(1);
        self.epoch.store(epoch, Release);
        epoch
    }

    /// Endstops that ended the motion of this epoch.
    #[must_use]
    pub fn triggered(&self) -> EndstopSet {
        EndstopSet(self.triggered.load(Acquire))
    }

    pub(crate) fn clear_triggered(&self) {
        self.triggered.store(0, Release);
    }

    /// For the Stepper, whom nobody sees half-way.
    pub(crate) fn set_triggered(&self, set: EndstopSet) {
        self.triggered.store(set.0, Relaxed);
    }

    /// Endstop inputs as last seen.
    #[must_use]
    pub fn endstops(&self) -> EndstopSet {
        EndstopSet(self.endstops.load(Relaxed))
    }

    pub(crate) fn set_endstops(&self, set: EndstopSet) {
        self.endstops.store(set.0, Relaxed);
    }

    /// The endstops that there are.
    #[must_use]
    pub fn inputs(&self) -> EndstopSet {
        EndstopSet(self.inputs.load(Relaxed))
    }

    pub(crate) fn set_inputs(&self, set: EndstopSet) {
        self.inputs.store(set.0, Relaxed);
    }

    /// Motion time executed, low 32 bits, in ticks.
    #[must_use]
    pub fn tick(&self) -> u32 {
        loop {
            let lag = self.lag.load(Acquire);
            let tick = self.due.load(Acquire).wrapping_sub(lag);
            if self.lag.load(Acquire) == lag {
                return tick;
            }
        }
    }

    /// Groups whose steps the Stepper looks at closely.
    pub(crate) fn slow_groups(&self) -> GroupSet {
        GroupSet(self.slow.load(Relaxed))
    }

    pub(crate) fn set_slow_groups(&self, groups: GroupSet) {
        self.slow.store(groups.0, Relaxed);
    }

    pub(crate) fn entry_done(&self) {
        self.entries_done.store(self.entries_done.load(Relaxed).wrapping_add(1), Release);
    }

    pub(crate) fn set_events_made(&self, made: u32) {
        self.events_made.store(made, Release);
    }

    /// Events put into the StepQueue, as of the last turn of the StepGenerator.
    pub(crate) fn events_made(&self) -> u32 {
        self.events_made.load(Acquire)
    }

    /// The Stepper, whom nobody sees half-way, has come to rest when so many events were taken out of the StepQueue.
    pub(crate) fn set_rested(&self, done: u32) {
        self.rested.store(done, Relaxed);
    }

    /// Events that the Stepper had taken when it last rested.
    pub(crate) fn rested_at(&self) -> u32 {
        self.rested.load(Acquire)
    }

    /// Whether all events made are done.
    fn has_rested(&self) -> bool {
        self.events_made.load(Acquire) == self.rested.load(Acquire)
    }

    /// Whether all `entries` that the Console ever queued have been stepped to their end.
    #[must_use]
    pub fn is_idle(&self, entries: u32) -> bool {
        // The order matters: once every entry is done, no event is added to those already made.
        self.entries_done.load(Acquire) == entries && self.has_rested()
    }

    /// What was too slow since the start.
    #[must_use]
    pub fn overload(&self) -> Overload {
        Overload {
            events: self.late.read(),
            spans: self.squeezed.read(),
            starved: self.starved.load(Relaxed),
            underruns: self.underruns.load(Relaxed),
        }
    }

    pub(crate) fn count_starved(&self) {
        self.starved.store(self.starved.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// An event came so many ticks late that all later ones are moved.
    pub(crate) fn count_late(&self, ticks: u32) {
        self.late.add(ticks);
    }

    /// A span was made longer by so many ticks.
    pub(crate) fn count_squeezed(&self, ticks: u32) {
        self.squeezed.add(ticks);
    }

    /// Whether the Console waits for the host and has nothing else to do.
    #[must_use]
    pub fn is_awaiting_input(&self) -> bool {
        self.awaiting_input.load(Relaxed)
    }

    pub(crate) fn set_awaiting_input(&self, waiting: bool) {
        self.awaiting_input.store(waiting, Relaxed);
    }

    /// Moves planned, and the length of their path in um (wrapping at 4295 m).
    #[must_use]
    pub fn planned(&self) -> (u32, u32) {
        (self.moves.load(Relaxed), self.path_um.load(Relaxed))
    }

    pub(crate) fn set_planned(&self, moves: u32, path_um: u32) {
        self.moves.store(moves, Relaxed);
        self.path_um.store(path_um, Relaxed);
    }

    pub(crate) fn count_underrun(&self) {
        self.underruns.store(self.underruns.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Moves planned and not yet begun.
    #[must_use]
    pub fn level(&self) -> u32 {
        self.level.load(Relaxed)
    }

    pub(crate) fn set_level(&self, moves: u32) {
        self.level.store(moves, Relaxed);
    }

    /// Fewest moves in the look-ahead while the stream ran.
    #[must_use]
    pub fn low_water(&self) -> Option<u32> {
        self.low_water.load(Relaxed).checked_sub(1)
    }

    pub(crate) fn note_level(&self, moves: u32) {
        if self.low_water().is_none_or(|least| moves < least) {
            self.low_water.store(moves.saturating_add(1), Relaxed);
        }
    }

    /// Whether an emergency stop holds.
    #[must_use]
    pub fn is_halted(&self) -> bool {
        self.halted.load(Relaxed)
    }

    pub(crate) fn set_halted(&self) {
        self.halted.store(true, Relaxed);
    }

    /// What the print's own lines say of it.
    #[must_use]
    pub const fn print_progress(&self) -> &PrintProgress {
        &self.print_progress
    }

    /// Has the motion of an epoch come to rest along its path; of none with `None`.
    pub(crate) fn set_brake(&self, epoch: Option<u8>) {
        self.brake.store(epoch.map_or(0, |epoch| u32::from(epoch) + 1), Release);
    }

    /// Whether the motion of this epoch is to come to rest.
    pub(crate) fn is_braking(&self, epoch: u8) -> bool {
        self.brake.load(Acquire) == u32::from(epoch) + 1
    }

    pub(crate) fn set_stopped(&self, epoch: Option<u8>) {
        self.stopped.store(epoch.map_or(0, |epoch| u32::from(epoch) + 1), Release);
    }

    /// Whether the motion of this epoch has come to rest, and all its steps are made.
    pub(crate) fn has_stopped(&self, epoch: u8) -> bool {
        self.stopped.load(Acquire) == u32::from(epoch) + 1 && self.has_rested()
    }
}
