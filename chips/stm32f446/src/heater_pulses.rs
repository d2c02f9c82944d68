//! The heaters' pulses as numbers: the end of the next control period, and where in it each heater goes on.
//!
//! The timer counts up once and stops. An output is low until the count reaches its compare value, high from there to
//! the end, and low again when the counter stands at 0. So all pulses end together, at the end of the period, and the
//! interrupt of that instant begins the next one.
//!
//! The interrupt reaches the timer with a delay, in which the generator's context may have run. The next count is
//! shorter by that delay, so the control period averages 20 ms and each pulse has the length of its duty. The exception
//! is a duty of the full period: then the heater loses the delay.
//!
//! The clock is the core's cycle counter, which wraps.

/// A control period, in counts of the timer at 90 MHz (APB1 timer clock, RM0390, 6.2): 20 ms.
pub const PERIOD: u32 = 1_800_000;

/// Cycles of the core in a count.
const CYCLES: u32 = 2;

/// Mode of two channels (RM0390, TIM2 to TIM5, CCMR1 and CCMR2): PWM mode 2 (OCxM 111), compare values that take effect
/// with the next period (OCxPE).
pub const PULSES: u32 = 0x7878;

/// A compare value that no count reaches, so there is no pulse. RM0390, TIM2 to TIM5, PWM mode: with a compare value
/// above the reload value, PWM mode 2 holds the output inactive.
pub const NEVER: u32 = u32::MAX;

/// Counts of the timer in a count of a timer of 16 bits: a period has 60,000 of these.
pub const NARROW: u32 = 30;
const _: () = assert!(PERIOD / NARROW < NEVER_NARROW as u32);

/// [`NEVER`] for a timer of 16 bits.
pub const NEVER_NARROW: u16 = u16::MAX;

/// Longest pulse, in counts. The heater goes off no later than this after the order to go on.
pub const LONGEST: u32 = PERIOD - 1;

/// A period that is older has not ended by itself, in cycles of the core: 22 ms.
pub const LATEST: u32 = (PERIOD + PERIOD / 10) * CYCLES;

/// The instants at which control periods end.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    /// When the present period was to begin, in cycles.
    begin: u32,
}

impl Grid {
    /// A first period that begins now.
    #[must_use]
    pub const fn new(now: u32) -> Self {
        Self { begin: now.wrapping_sub(PERIOD * CYCLES) }
    }

    /// Begins the next period at `now`, and returns its counts, at least half of them. A call that is later than that,
    /// or early, starts a new grid. This happens after a halt by a debugger, which stops the cycle counter and not the
    /// timer.
    pub const fn next(&mut self, now: u32) -> u32 {
        let due = self.begin.wrapping_add(PERIOD * CYCLES);
        let late = now.wrapping_sub(due);
        let (begin, late) = if late <= PERIOD * CYCLES / 2 { (due, late) } else { (now, 0) };
        self.begin = begin;
        PERIOD - late / CYCLES
    }
}

/// The compare value for a duty of 1/65,535 of [`PERIOD`] in a period of `counts` counts. It is never 0: an output with
/// 0 would be high while the counter stands.
#[must_use]
pub const fn compare(duty: u16, counts: u32) -> u32 {
    if duty == 0 {
        return NEVER;
    }
    let on = (duty as u64 * PERIOD as u64 / 65_535) as u32;
    if on >= counts { 1 } else { counts - on }
}

/// The counts of a timer of 16 bits in `counts`, which are a [`PERIOD`] at most: none too many.
#[must_use]
pub const fn narrow_counts(counts: u32) -> u16 {
    (counts / NARROW) as u16
}

/// [`compare`] for a timer of 16 bits, with its own counts.
#[must_use]
pub const fn narrow_compare(duty: u16, counts: u16) -> u16 {
    if duty == 0 {
        return NEVER_NARROW;
    }
    let on = (duty as u32 * (PERIOD / NARROW) / 65_535) as u16;
    if on >= counts { 1 } else { counts - on }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// How long the output is high, in counts: from the compare value up to the last count.
    fn high(compare: u32, counts: u32) -> u32 {
        assert!(compare > 0, "high while the counter stands");
        counts.saturating_sub(compare)
    }

    #[test]
    fn no_duty_is_no_pulse_and_all_of_it_leaves_one_count() {
        assert_eq!(high(compare(0, PERIOD), PERIOD), 0);
        assert_eq!(high(compare(u16::MAX, PERIOD), PERIOD), LONGEST);
        assert_eq!(high(compare(32_768, PERIOD), PERIOD), 900_013);
        assert_eq!(high(compare(1, PERIOD), PERIOD), 27);
    }

    #[test]
    fn a_timer_of_16_bits_has_the_same_period_in_larger_counts() {
        let all = narrow_counts(PERIOD);
        assert_eq!((all, narrow_counts(PERIOD - 1)), (60_000, 59_999));
        let high = |duty| all.saturating_sub(narrow_compare(duty, all));
        assert_eq!([0, 1, 2, 32_768, u16::MAX].map(high), [0, 0, 1, 30_000, 59_999]);
    }

    #[test]
    fn the_grid_does_not_drift() {
        let mut grid = Grid::new(u32::MAX - 5);
        let mut now = u32::MAX - 5;
        let begin = now;
        for period in 0..10_000_u32 {
            // Some interrupts get through at once, some late.
            let late = [0, 7, 900, 40_000][period as usize % 4];
            now = begin.wrapping_add(period.wrapping_mul(PERIOD * CYCLES)).wrapping_add(late * CYCLES);
            assert_eq!(grid.next(now), PERIOD - late);
        }
        assert_ne!(now, begin);
    }

    #[test]
    fn who_is_far_too_late_or_too_early_begins_anew() {
        for off in [PERIOD * CYCLES, PERIOD * CYCLES / 2 + 1, 0_u32.wrapping_sub(1), 1 << 31] {
            let mut grid = Grid::new(1000);
            assert_eq!(grid.next(1000), PERIOD);
            let now = (1000 + PERIOD * CYCLES).wrapping_add(off);
            assert_eq!(grid.next(now), PERIOD, "{off}");
            assert_eq!(grid.next(now.wrapping_add(PERIOD * CYCLES + 20)), PERIOD - 10);
        }
    }

    proptest! {
        #[test]
        fn a_pulse_is_as_long_as_its_duty_and_never_longer_than_the_period(duty: u16, late in 0..=PERIOD / 2) {
            let counts = PERIOD - late;
            let on = high(compare(duty, counts), counts);
            let wanted = (u64::from(duty) * u64::from(PERIOD) / 65_535) as u32;
            prop_assert_eq!(on, wanted.min(counts - 1));
            prop_assert!(on <= LONGEST);
        }

        #[test]
        fn so_it_is_on_a_timer_of_16_bits(duty: u16, late in 0..=PERIOD / 2) {
            let counts = narrow_counts(PERIOD - late);
            prop_assert!(u32::from(counts) * NARROW <= PERIOD - late);
            let compare = narrow_compare(duty, counts);
            prop_assert!(compare > 0);
            let wanted = (u64::from(duty) * 60_000 / 65_535) as u16;
            prop_assert_eq!(counts.saturating_sub(compare), wanted.min(counts - 1));
        }
    }
}
