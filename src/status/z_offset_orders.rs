//! The live offset of z: ordered by the Console, made by the StepGenerator. Both count steps since the start.

use core::sync::atomic::{AtomicI32, AtomicU8, AtomicU32, Ordering::Acquire, Ordering::Relaxed, Ordering::Release};

/// Orders for the offset, and how far they are carried out.
#[derive(Debug)]
pub struct ZOffsetOrders {
    /// Written by the Console; by the StepGenerator for a change that is made again.
    ordered: AtomicI32,
    /// Limits of a change, as bits of numbers: steps a tick, steps a tick squared; written by the Console.
    speed: AtomicU32,
    acceleration: AtomicU32,
    /// The ticks between which moves are slow in z; written by the Console.
    quiet_from: AtomicU32,
    quiet_until: AtomicU32,
    /// Written by the StepGenerator when a change has ended.
    reached: AtomicI32,
    /// The epoch for which `reached` counts; written by the StepGenerator.
    epoch: AtomicU8,
    /// Tick at which the last change began, and its steps; written by the StepGenerator.
    begun: AtomicU32,
    by: AtomicI32,
    /// Changes begun.
    changes: AtomicU32,
    /// A change to make again: its tick, and its steps or 0.
    again_at: AtomicU32,
    again_by: AtomicI32,
}

impl ZOffsetOrders {
    pub(super) const fn new() -> Self {
        Self {
            ordered: AtomicI32::new(0),
            speed: AtomicU32::new(0),
            acceleration: AtomicU32::new(0),
            quiet_from: AtomicU32::new(0),
            quiet_until: AtomicU32::new(0),
            reached: AtomicI32::new(0),
            epoch: AtomicU8::new(0),
            begun: AtomicU32::new(0),
            by: AtomicI32::new(0),
            changes: AtomicU32::new(0),
            again_at: AtomicU32::new(0),
            again_by: AtomicI32::new(0),
        }
    }

    /// Steps ordered since the start, wrapping.
    #[inline(always)]
    pub(crate) fn ordered(&self) -> i32 {
        self.ordered.load(Acquire)
    }

    /// The limits of a change: steps a tick, steps a tick squared.
    pub(crate) fn limits(&self) -> [f32; 2] {
        [&self.speed, &self.acceleration].map(|bits| f32::from_bits(bits.load(Relaxed)))
    }

    /// Orders so many steps more.
    pub(crate) fn order(&self, steps: i32, limits: [f32; 2]) {
        self.set_limits(limits);
        self.ordered.fetch_add(steps, Release);
    }

    fn set_limits(&self, [speed, acceleration]: [f32; 2]) {
        self.speed.store(speed.to_bits(), Relaxed);
        self.acceleration.store(acceleration.to_bits(), Relaxed);
    }

    /// Has a change made again that [`last_change`](Self::last_change) told of, at the same tick: so the same program
    /// makes the same steps without the host that shifted z. `tick` is at most 200 s ahead.
    pub fn replay(&self, tick: u32, steps: i32, limits: [f32; 2]) {
        self.set_limits(limits);
        self.again_at.store(tick, Relaxed);
        self.again_by.store(steps, Release);
    }

    /// Whether a change is to be made again, and has not begun.
    #[must_use]
    pub fn is_replaying(&self) -> bool {
        self.again_by.load(Acquire) != 0
    }

    /// The tick of a change that is to be made again.
    pub(crate) fn replay_tick(&self) -> Option<u32> {
        self.is_replaying().then(|| self.again_at.load(Relaxed))
    }

    /// The change that is made again is ordered.
    pub(crate) fn order_replay(&self) {
        self.ordered.fetch_add(self.again_by.swap(0, Relaxed), Release);
    }

    /// The ticks between which moves are slow in z.
    pub(crate) fn quiet(&self) -> [u32; 2] {
        [self.quiet_from.load(Acquire), self.quiet_until.load(Acquire)]
    }

    /// Sets them. The generator may read the new begin with the old end, which is earlier than the new one.
    pub(crate) fn set_quiet(&self, from: u32, until: u32) {
        self.quiet_from.store(from, Release);
        self.quiet_until.store(until, Release);
    }

    /// Steps made since the start, wrapping.
    pub(crate) fn reached(&self) -> i32 {
        self.reached.load(Acquire)
    }

    pub(crate) fn set_reached(&self, steps: i32) {
        self.reached.store(steps, Release);
    }

    /// Whether `reached` counts for an epoch.
    pub(crate) fn is_of(&self, epoch: u8) -> bool {
        self.epoch.load(Acquire) == epoch
    }

    pub(crate) fn set_epoch(&self, epoch: u8) {
        self.epoch.store(epoch, Release);
    }

    /// Changes begun since the start, the tick at which the last one began, its steps and its limits.
    #[must_use]
    pub fn last_change(&self) -> (u32, u32, i32, [f32; 2]) {
        (self.changes.load(Acquire), self.begun.load(Relaxed), self.by.load(Relaxed), self.limits())
    }

    /// A change begins: an input that a trace does not have from its commands.
    pub(crate) fn note_change(&self, tick: u32, steps: i32) {
        self.begun.store(tick, Relaxed);
        self.by.store(steps, Relaxed);
        self.changes.store(self.changes.load(Relaxed).wrapping_add(1), Release);
    }
}
