//! The Console's end of the motion: fills the MoveQueue and tracks how much of it is left.

use super::moves::Move;
use super::step_counts::StepCounts;
use super::work::{Entry, Work};
use super::z_limits::ZLimits;
use crate::motors::MOST_GROUPS;
use crate::port::Wake;
use crate::settings::AxisSettings;
use crate::status::Status;
use crate::units::{Steps, SubTicks, TICKS_PER_SECOND};
use heapless::spsc::Producer;

/// Longer than any delay of the trajectory: a second.
const LONG_AGO: SubTicks = SubTicks::of_ticks(TICKS_PER_SECOND as u64);

/// Follows the entries of the MoveQueue, as a simulator does.
pub trait QueueObserver: Sync {
    /// An entry that is about to be queued.
    fn sees(&self, entry: &Entry);
}

/// The Console's end of the MoveQueue.
pub struct Link<'m, W: Wake> {
    queue: Producer<'m, Entry>,
    status: &'m Status,
    counts: StepCounts<'m>,
    wake: W,
    /// Sees each entry before it is queued. Only a simulator has one.
    observer: Option<&'m dyn QueueObserver>,
    epoch: u8,
    /// Entries ever queued, wrapping.
    entries: u32,
    /// Motion time queued and not yet seen to be stepped, in ticks times 2^16.
    left: SubTicks,
    /// The same up to the end of the last move that is fast in z.
    fast_left: SubTicks,
    /// Motion time since that end, at most [`LONG_AGO`].
    calm: SubTicks,
    /// The Stepper's tick at the last look.
    seen: u32,
    /// Z at the end of the last move.
    z: Steps,
    /// The offset of z was ever changed.
    has_shifted: bool,
}

impl<'m, W: Wake> Link<'m, W> {
    /// A link with the end `queue` of the MoveQueue.
    pub fn new(queue: Producer<'m, Entry>, status: &'m Status, counts: StepCounts<'m>, wake: W) -> Self {
        Self {
            queue,
            status,
            counts,
            wake,
            observer: None,
            epoch: status.epoch(),
            entries: 0,
            left: SubTicks::ZERO,
            fast_left: SubTicks::ZERO,
            calm: LONG_AGO,
            seen: status.tick(),
            z: Steps::ZERO,
            has_shifted: false,
        }
    }

    /// From now on this one sees each entry before it is queued.
    pub fn observe(&mut self, observer: &'m dyn QueueObserver) {
        self.observer = Some(observer);
    }

    /// The state shared between the contexts.
    pub const fn status(&self) -> &'m Status {
        self.status
    }

    /// Signed steps that each group of motors has made.
    pub fn counts(&self) -> [i32; MOST_GROUPS] {
        self.counts.read()
    }

    /// Whether the queue has room for another entry.
    pub fn has_room(&self) -> bool {
        self.queue.ready()
    }

    /// Entries in the queue.
    pub fn level(&self) -> usize {
        self.queue.len()
    }

    /// Whether every queued entry has been stepped.
    pub fn is_idle(&self) -> bool {
        self.status.is_idle(self.entries)
    }

    /// Whether nothing was ever queued.
    pub const fn is_fresh(&self) -> bool {
        self.entries == 0
    }

    /// Entries ever queued, wrapping.
    pub const fn entries(&self) -> u32 {
        self.entries
    }

    /// Entries whose steps are all made, or that were dropped, wrapping.
    pub fn entries_done(&self) -> u32 {
        self.status.entries_done()
    }

    /// Makes the Stepper read the endstops, which it otherwise does only during motion.
    pub fn look_at_endstops(&self) {
        self.wake.wake_stepper();
    }

    /// Queues work; the caller has checked [`has_room`](Self::has_room).
    pub fn send(&mut self, work: Work) {
        if let Work::Position([_, _, z, _]) = work {
            self.z = z;
        }
        let time = match &work {
            Work::Move(m) => m.time(),
            Work::Dwell(time) => *time,
            Work::Regroup(_)
            | Work::Position(_)
            | Work::Sweep(_)
            | Work::Follow(..)
            | Work::Stiffen(..)
            | Work::Surface(_)
            | Work::Heights(..) => SubTicks::ZERO,
        };
        let entry = Entry { epoch: self.epoch, work };
        if let Some(observer) = self.observer {
            observer.sees(&entry);
        }
        if self.queue.enqueue(entry).is_ok() {
            self.entries = self.entries.wrapping_add(1);
            self.left += time;
            self.wake.wake_generator();
        }
    }

    /// Queues a move, with the limits of z.
    pub fn send_move(&mut self, m: Move, z: &AxisSettings) {
        let [_, _, end, _] = m.end;
        let way = end.wrapping_sub(core::mem::replace(&mut self.z, end));
        self.send(Work::Move(m));
        if way != Steps::ZERO && ZLimits::half_of(z).may_be_exceeded_by(&m, way) {
            // The last fast move in z: quiet begins where it ends.
            (self.fast_left, self.calm) = (self.left, SubTicks::ZERO);
        }
    }

    /// Orders a change of z's offset by so many steps.
    pub fn shift_z(&mut self, steps: i32, z: &AxisSettings) {
        let ZLimits { speed, acceleration } = ZLimits::half_of(z);
        self.has_shifted = true;
        self.status.z_offset().order(steps, [speed, acceleration]);
        self.help_shift();
    }

    /// Steps of z's offset since the start, up to its last change that has ended; wrapping.
    pub fn shifted_z(&self) -> i32 {
        self.status.z_offset().reached()
    }

    /// Whether an ordered offset of z is not reached.
    pub fn is_shifting(&self) -> bool {
        self.has_shifted && self.status.z_offset().ordered() != self.status.z_offset().reached()
    }

    /// Whether it is, upwards.
    pub fn is_raising(&self) -> bool {
        let z = self.status.z_offset();
        self.has_shifted && z.ordered().wrapping_sub(z.reached()) > 0
    }

    /// Tells the generator how long moves are slow in z. Call it in every turn while z [is
    /// shifting](Self::is_shifting).
    pub fn help_shift(&mut self) {
        let [fast, calm, all] = [self.fast_left, self.calm, self.left].map(|time| time.whole_ticks() as u32);
        let now = self.seen;
        self.status.z_offset().set_quiet(now.wrapping_add(fast).wrapping_sub(calm), now.wrapping_add(all));
        self.wake.wake_generator();
    }

    /// Motion time queued and not yet stepped, in ticks. Call it at least every 429 s.
    pub fn left(&mut self) -> u64 {
        let tick = self.status.tick();
        let done = SubTicks::of_ticks(tick.wrapping_sub(self.seen).into());
        self.seen = tick;
        if self.is_idle() {
            self.come_to_rest();
        } else {
            self.calm = (self.calm + done.saturating_sub(self.fast_left)).min(LONG_AGO);
            (self.left, self.fast_left) = (self.left.saturating_sub(done), self.fast_left.saturating_sub(done));
        }
        self.left.whole_ticks()
    }

    /// Nothing is queued.
    const fn come_to_rest(&mut self) {
        (self.left, self.fast_left, self.calm) = (SubTicks::ZERO, SubTicks::ZERO, LONG_AGO);
    }

    /// Brings the motion to rest along its path, as fast as its accelerations allow. The queue still takes work: the
    /// path may lead into moves that are not queued yet.
    pub fn brake(&mut self) {
        self.status.set_brake(Some(self.epoch));
        self.wake.wake_generator();
    }

    /// Whether the motion is at rest, and stays so without an [`abort`](Self::abort).
    pub fn has_stopped(&self) -> bool {
        self.status.has_stopped(self.epoch) || self.is_idle()
    }

    /// Drops all queued work and every step not yet made. Then the link is idle.
    pub fn abort(&mut self) {
        self.status.set_brake(None);
        self.epoch = self.status.next_epoch();
        self.wake.wake_generator();
        self.wake.wake_stepper();
    }

    /// Whether nothing is left of the motion after an abort.
    pub fn is_dropped(&self) -> bool {
        self.is_idle() && (!self.has_shifted || self.status.z_offset().is_of(self.epoch))
    }

    /// After an abort, with the link idle: resets queued time and triggered endstops.
    pub fn restart(&mut self) {
        self.status.clear_triggered();
        self.come_to_rest();
        self.seen = self.status.tick();
    }
}
