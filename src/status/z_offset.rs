//! The live offset of z: ordered by the Console, made by the StepGenerator. Both count steps since the start.

use core::sync::atomic::{AtomicI32, AtomicU8, AtomicU32, Ordering::Acquire, Ordering::Relaxed, Ordering::Release};

/// Orders for the offset, and how far they are carried out.
#[derive(Debug)]
pub struct ZOffset {
    /// Written by the Console.
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
}

impl ZOffset {
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
    pub(crate) fn order(&self, steps: i32, [speed, acceleration]: [f32; 2]) {
        self.speed.store(speed.to_bits(), Relaxed);
        self.acceleration.store(acceleration.to_bits(), Relaxed);
        self.ordered.store(self.ordered.load(Relaxed).wrapping_add(steps), Release);
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

    /// Changes begun since the start, the tick at which the last one began, and its steps.
    #[must_use]
    pub fn last_change(&self) -> (u32, u32, i32) {
        (self.changes.load(Acquire), self.begun.load(Relaxed), self.by.load(Relaxed))
    }

    /// A change begins: an input that a trace does not have from its commands.
    pub(crate) fn note_change(&self, tick: u32, steps: i32) {
        self.begun.store(tick, Relaxed);
        self.by.store(steps, Relaxed);
        self.changes.store(self.changes.load(Relaxed).wrapping_add(1), Release);
    }
}
