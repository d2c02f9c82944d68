//! Squares of speeds.

use super::{Length, MmPerSec, MmPerSec2};

/// The square of a speed, in 2^-32 mm2/s2: the square of a raw [`MmPerSec`]. Ramps and corners are laws of the square,
/// and a square cannot be taken for the speed itself.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
#[repr(transparent)]
pub struct SpeedSq(pub u64);

impl SpeedSq {
    /// At rest.
    pub const ZERO: Self = Self(0);
    /// No limit.
    pub const MAX: Self = Self(u64::MAX);

    /// The square of a speed.
    #[must_use]
    #[inline(always)]
    pub const fn of(speed: MmPerSec) -> Self {
        Self(speed.to_bits() as u64 * speed.to_bits() as u64)
    }

    /// The gain at an acceleration over a length: 2 a L, at most [`MAX`](Self::MAX).
    #[must_use]
    #[inline(always)]
    pub const fn gained(a: MmPerSec2, Length(length): Length) -> Self {
        // Acceleration has 8 fractional bits, so 2 a L is a product shifted by 7. Two halves avoid its upper 64 bits.
        let a = a.to_bits() as u64;
        let (high, low) = (a * (length >> 32), (a * (length & 0xFFFF_FFFF)) >> 7);
        if high >> 38 != 0 { Self::MAX } else { Self((high << 25).saturating_add(low)) }
    }

    /// The sum, at most [`MAX`](Self::MAX).
    #[must_use]
    #[inline(always)]
    pub const fn saturating_add(self, gain: Self) -> Self {
        Self(self.0.saturating_add(gain.0))
    }

    /// The difference, at least 0.
    #[must_use]
    #[inline(always)]
    pub const fn saturating_sub(self, loss: Self) -> Self {
        Self(self.0.saturating_sub(loss.0))
    }

    /// The sum, which wraps.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_add(self, gain: Self) -> Self {
        Self(self.0.wrapping_add(gain.0))
    }

    /// The difference of two sums that have wrapped.
    #[must_use]
    #[inline(always)]
    pub const fn wrapping_sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }

    /// The absolute difference.
    #[must_use]
    #[inline(always)]
    pub const fn abs_diff(self, other: Self) -> Self {
        Self(self.0.abs_diff(other.0))
    }
}
