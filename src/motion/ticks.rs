//! Ticks: comparison of 32-bit ticks of motion time, and the minimum distance of steps.
//!
//! Motion time counts ticks of 0.1 us and wraps after 429 s, so ticks are compared by their difference.

/// Minimum number of ticks between two pulses of a motor: 1.7 us. Motion at legal speeds is less dense (2 us); a motor
/// that reverses within half a step can come near it.
pub const MIN_STEP_INTERVAL: u64 = 17;

/// A group at rest is known to rest for this many ticks from now: 3 s, far longer than the longest span.
pub(in crate::motion) const FAR: u32 = 1 << 25;

/// Less than [`FAR`]: the end of a group's rest is checked only when it is this near. Where motors move for longer
/// without a step, time passes in events of this many ticks.
pub(in crate::motion) const NEAR: u32 = FAR / 2;

/// Whether a tick comes before another.
#[inline(always)]
pub(in crate::motion) const fn is_before(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

/// The earlier of two ticks.
#[inline(always)]
pub(in crate::motion) const fn earlier(a: u32, b: u32) -> u32 {
    if is_before(a, b) { a } else { b }
}

/// The later of two ticks.
pub(in crate::motion) const fn later(a: u32, b: u32) -> u32 {
    if is_before(a, b) { b } else { a }
}
