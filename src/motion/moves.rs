//! Moves: released by the planner, stepped by the generator. A released move never changes.

use crate::port::EndstopSet;
use crate::units::{Length, MmPerSec2, Steps, SubTicks};

/// One in the fixed point of fractions of a move.
pub const WHOLE: u32 = 1 << 31;

/// From this time on, the 31 bits of a move's fraction are too few: 27 s, in ticks times 2^16.
pub(in crate::motion) const LONG_TIME: SubTicks = SubTicks(1 << 44);

/// A straight move with a trapezoid of speed: its distance has three phases, each with its time.
///
/// Fractions are scaled by [`WHOLE`], 2^31.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Move {
    /// Its end, in steps of x, y, z and e.
    pub end: [Steps; 4],
    /// Fraction of the path covered when the change from the entry speed ends.
    pub accelerated: u32,
    /// Fraction of the path covered when the deceleration begins.
    pub cruised: u32,
    /// Part of the first phase that the lower of its two speeds alone would cover in its time.
    pub entry_share: u32,
    /// Part of the decelerating phase that its exit speed alone would cover in its time.
    pub exit_share: u32,
    /// Time of the first phase, which accelerates unless the move [brakes first](Self::brakes_first).
    pub accelerate: SubTicks,
    /// Time of the cruising phase.
    pub cruise: SubTicks,
    /// Time of the decelerating phase.
    pub decelerate: SubTicks,
    /// Length of its path; of the filament if the tool does not move.
    pub length: Length,
    /// Acceleration of its ramps, also for braking that was not planned.
    pub acceleration: MmPerSec2,
    /// Pressure that its filament needs: filament length times advance, in steps times seconds.
    pub advance: Steps,
    /// Whether its entry speed is above its nominal one, because an override lowered the nominal speed during the
    /// motion.
    pub brakes_first: bool,
    /// Whether motion ends with it: no following move was known when it was released.
    pub rests: bool,
    /// Endstops that end it early.
    pub watch: EndstopSet,
}

impl Move {
    /// No distance and no time.
    pub(in crate::motion) const NONE: Self = Self {
        end: [Steps::ZERO; 4],
        accelerated: 0,
        cruised: 0,
        entry_share: 0,
        exit_share: 0,
        accelerate: SubTicks::ZERO,
        cruise: SubTicks::ZERO,
        decelerate: SubTicks::ZERO,
        length: Length::ZERO,
        acceleration: MmPerSec2::ZERO,
        advance: Steps::ZERO,
        brakes_first: false,
        rests: true,
        watch: EndstopSet::NONE,
    };

    /// Its duration, in ticks times 2^16.
    #[must_use]
    pub const fn time(&self) -> SubTicks {
        SubTicks(self.accelerate.0 + self.cruise.0 + self.decelerate.0)
    }
}
