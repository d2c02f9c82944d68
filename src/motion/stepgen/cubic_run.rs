//! Cubic runs: consecutive step times on one cubic, at three sums a step, in fixed point.

/// Fraction bits of a tick within a run, and the additional bits of twice-summed values. The change of a step's time is
/// less than 1,000 ticks in a smooth run that is not too long.
pub(super) const FINE: u32 = 14;
pub(super) const FINER: u32 = 6;

/// Makes a shift by [`FINER`] bits round.
pub(super) const HALF: i32 = 1 << (FINER - 1);

/// Consecutive step times: ticks from the whole tick `base` with a fraction of [`FINE`] bits, and their first, second
/// and third differences, the latter two with [`FINER`] more.
pub(super) struct CubicRun {
    pub base: u32,
    pub at: u32,
    pub pace: i32,
    pub bend: i32,
    pub jerk: i32,
}

impl CubicRun {
    /// A single step, or several in the same tick.
    #[inline(always)]
    pub fn at(base: u32, ticks: f32) -> Self {
        // Not `max`, for which the target has no instruction.
        let ticks = if ticks < 0.0 { 0.0 } else { ticks };
        let whole = ticks as u32;
        let at = fine(ticks - whole as f32).cast_unsigned();
        Self { base: base.wrapping_add(whole), at, pace: 0, bend: 0, jerk: 0 }
    }

    #[inline(always)]
    pub fn write(mut self, ticks: &mut [u32]) {
        // Two at a time: 6 instructions each instead of 10. Four need more registers than there are.
        let (pairs, remainder) = ticks.as_chunks_mut();
        for [first, second] in pairs {
            *first = self.next();
            *second = self.next();
        }
        for tick in remainder {
            *tick = self.next();
        }
    }

    #[inline(always)]
    fn next(&mut self) -> u32 {
        let tick = self.base.wrapping_add(self.at >> FINE);
        self.at = self.at.wrapping_add_signed(self.pace);
        self.pace = self.pace.wrapping_add(self.bend >> FINER);
        self.bend = self.bend.wrapping_add(self.jerk);
        tick
    }
}

/// With a fraction of [`FINE`] bits.
pub(super) fn fine(ticks: f32) -> i32 {
    (ticks * const { (1 << FINE) as f32 }) as i32
}

/// With [`FINER`] bits more.
pub(super) fn finer(ticks: f32) -> i32 {
    (ticks * const { (1 << (FINE + FINER)) as f32 }) as i32
}
