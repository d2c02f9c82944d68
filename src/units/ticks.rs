//! Time in ticks, the one count of every platform.

/// The one tick of every platform: 0.1 us. An STM32F446 counts it exactly, in 18 cycles of 180 MHz.
pub const TICKS_PER_SECOND: u32 = 10_000_000;

/// Motion time, or a length of it, in ticks times 2^16; 64 bits, so it never wraps. Only the step event itself is
/// rounded to a whole tick.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
#[repr(transparent)]
pub struct SubTicks(pub u64);

impl SubTicks {
    /// No time.
    pub const ZERO: Self = Self(0);
    /// Never.
    pub const MAX: Self = Self(u64::MAX);

    /// This many whole ticks.
    #[must_use]
    #[inline(always)]
    pub const fn of_ticks(ticks: u64) -> Self {
        Self(ticks << 16)
    }

    /// Whole ticks, cut off.
    #[must_use]
    #[inline(always)]
    pub const fn whole_ticks(self) -> u64 {
        self.0 >> 16
    }

    /// The tick nearest to it.
    #[must_use]
    #[inline(always)]
    pub const fn nearest_tick(self) -> u64 {
        self.0.saturating_add(1 << 15) >> 16
    }

    /// The difference, at least none.
    #[must_use]
    #[inline(always)]
    pub const fn saturating_sub(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }
}

impl core::ops::Add for SubTicks {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl core::ops::AddAssign for SubTicks {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl core::ops::Sub for SubTicks {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

/// Ticks in a millisecond.
pub const TICKS_PER_MS: u32 = TICKS_PER_SECOND / 1000;

/// A point of real time on the step timer's 32-bit counter; it wraps after 429 s.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Tick(pub u32);

impl Tick {
    /// The tick `span` later.
    #[must_use]
    pub const fn after(self, span: u32) -> Self {
        Self(self.0.wrapping_add(span))
    }

    /// Whether this tick comes before `other`; right for distances below 214 s.
    #[must_use]
    pub const fn is_before(self, other: Self) -> bool {
        (self.0.wrapping_sub(other.0) as i32) < 0
    }

    /// Ticks from `earlier` to this one, across a wrap.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u32 {
        self.0.wrapping_sub(earlier.0)
    }
}

/// A point of real time for the Console, in ticks since start; 64 bits, so it never wraps.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub struct Instant(pub u64);

impl Instant {
    /// The instant `ms` milliseconds later.
    #[must_use]
    pub const fn after_ms(self, ms: u32) -> Self {
        Self(self.0.saturating_add(ms as u64 * TICKS_PER_MS as u64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_compare_across_the_wrap() {
        let before = Tick(u32::MAX - 5);
        let after = before.after(10);
        assert_eq!(after, Tick(4));
        assert!(before.is_before(after));
        assert!(!after.is_before(before));
        assert_eq!(after.since(before), 10);
    }
}
