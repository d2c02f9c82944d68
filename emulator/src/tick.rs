//! The unit of time of the step timer.

/// A tick of the step timer.
pub const NS_PER_TICK: u64 = 100;
