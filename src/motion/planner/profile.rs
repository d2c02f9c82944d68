//! Trapezoids: times from distance, acceleration and the speeds at both ends.
//!
//! Three phases: accelerate from the entry speed to the peak, cruise, decelerate to the exit speed. Where the distance
//! is too short for the nominal speed, the peak is where the two ramps meet: `peak^2 = (entry^2 + exit^2) / 2 + a L`.
//! With a minimum cruise ratio r the ramps have only `(1 - r) L` to meet in, and the move cruises between them. So a
//! row of short moves does not alternate between accelerating and braking (Klipper's minimum_cruise_ratio). A move that
//! must accelerate or brake all along, because the next corner is that much faster or slower, still does. A move that
//! is entered above its nominal speed brakes to it first.

use crate::motion::moves::{LONG_TIME, Move, WHOLE};
use crate::motion::number::{acceleration, feed_speed, length_of, long_time, mm, root, square};
use crate::port::EndstopSet;
use crate::settings::ranges::ADVANCE;
use crate::units::{Feed, Length, MmPerSec, MmPerSec2, Ratio, Seconds, SpeedSq, Steps, SubTicks, TICKS_PER_SECOND};

/// Time over `level` at a nominal speed. It may be long, so every bit counts. One step of Newton's method refines the
/// single-precision value, to 2^-16 of a tick in three minutes and to a thousandth of a tick in hours.
fn cruise_time(level: Length, nominal: Feed) -> SubTicks {
    let guess = long_time(mm(level) / feed_speed(nominal) * const { TICKS_PER_SECOND as f32 }).0;
    let nominal = nominal.to_bits();
    // 32 fractional bits of the length and 4 more, over 20 of the feed, are the 16 of a time. Both products may wrap;
    // their difference fits 63 bits.
    let product =
        level.0.wrapping_mul(const { (TICKS_PER_SECOND as u64) << (Feed::FRAC_NBITS - MmPerSec::FRAC_NBITS) });
    let remainder = product.wrapping_sub(guess.wrapping_mul(nominal.into())).cast_signed();
    let remainder = ((remainder >> 32) as i32) as f32 * 4_294_967_296.0 + (remainder as u32) as f32;
    SubTicks(guess.saturating_add_signed(i64::from((remainder / nominal as f32) as i32)))
}

/// The part of a length that only ramps may take up, given the part of it that is to be a cruise.
#[must_use]
pub(in crate::motion) fn max_ramp_length(length: Length, cruise: Ratio) -> Length {
    length.ratio(Ratio::ONE.saturating_sub(cruise))
}

/// The advance and the endstops of a move in one word. In two, a move in the window would take 8 bytes more.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct AdvanceAndWatch(u32);

/// Bits of the endstops, which are the lowest.
const WATCH_BITS: u32 = 4;
const _: () = assert!(EndstopSet::ALL.0 >> WATCH_BITS == 0 && ADVANCE.most.to_bits() <= u32::MAX >> WATCH_BITS);

impl AdvanceAndWatch {
    /// None of them.
    const NONE: Self = Self(0);

    /// The advance that its filament needs, and the endstops that end it early.
    #[inline(always)]
    pub const fn new(advance: Seconds, watch: EndstopSet) -> Self {
        Self(advance.to_bits() << WATCH_BITS | watch.and(EndstopSet::ALL).0 as u32)
    }

    /// The advance that its filament needs.
    #[inline(always)]
    pub const fn advance(self) -> Seconds {
        Seconds::from_bits(self.0 >> WATCH_BITS)
    }

    /// Endstops that end it early.
    #[inline(always)]
    pub const fn watch(self) -> EndstopSet {
        EndstopSet(self.0 as u8).and(EndstopSet::ALL)
    }
}

/// The parts of a trapezoid.
#[derive(Clone, Copy, Debug)]
pub(in crate::motion) struct MoveSpec {
    /// Its length.
    pub length: Length,
    /// The part of it for accelerating and braking, if entry and exit allow it.
    pub max_ramp_length: Length,
    /// Acceleration of the ramps.
    pub acceleration: MmPerSec2,
    /// Speed not to be exceeded.
    pub nominal: Feed,
    /// The fastest that axes and motors let it be.
    pub max_speed: Feed,
    /// Where it ends, in steps of x, y, z and e.
    pub end: [Steps; 4],
    /// Its advance and its endstops.
    pub own: AdvanceAndWatch,
}

impl MoveSpec {
    /// None.
    pub const NONE: Self = Self {
        length: Length::ZERO,
        max_ramp_length: Length::ZERO,
        acceleration: MmPerSec2::ZERO,
        nominal: Feed::ZERO,
        max_speed: Feed::ZERO,
        end: [Steps::ZERO; 4],
        own: AdvanceAndWatch::NONE,
    };
}

/// The move over a distance with these entry and exit speeds squared, in raw bits of 2^-32 mm2/s2, and its exit speed
/// in mm/s; the entry speed is known. They must be possible: `|exit_sq - entry_sq| <= SpeedSq::gained(a, length)`
/// except for rounding.
#[must_use]
#[inline(always)]
pub(in crate::motion) fn profile(
    spec: &MoveSpec,
    (entry_sq, entry_speed): (SpeedSq, f32),
    exit_sq: SpeedSq,
) -> (Move, f32) {
    let MoveSpec { length, max_ramp_length, acceleration: a, nominal, end, own, .. } = *spec;
    let watch = own.watch();
    let nominal_sq = SpeedSq::of(nominal.into());
    // Halves first: the gain of a long move is the greatest number, and a sum with it would overflow.
    let meet_sq = SpeedSq(entry_sq.0 / 2 + exit_sq.0 / 2 + SpeedSq::gained(a, max_ramp_length).0 / 2);
    let brakes_first = entry_sq > nominal_sq;
    // At least 1: times below divide by the peak. It is no slower than the entry, unless the move brakes to its nominal
    // speed.
    let least_sq = if brakes_first { SpeedSq(1) } else { entry_sq.max(SpeedSq(1)) };
    // The exit overrules both: the next move was promised to begin with it.
    let peak_sq = nominal_sq.min(meet_sq).max(exit_sq).max(least_sq);
    let size = mm(length);
    let twice_a = acceleration(a) * 2.0;
    // The next move gets this very number as its entry speed, so no rounding differs at the corner.
    let exit_speed = if exit_sq == entry_sq { entry_speed } else { root(square(exit_sq)) };
    // In the middle of a long ramp the peak is one of the ends, and its root known.
    let peak_speed = match peak_sq {
        _ if peak_sq == exit_sq => exit_speed,
        _ if peak_sq == entry_sq => entry_speed,
        _ => root(square(peak_sq)),
    };
    let rise = Ramp::new(peak_sq.abs_diff(entry_sq), twice_a, entry_speed, peak_speed);
    let fall = Ramp::new(peak_sq.wrapping_sub(exit_sq), twice_a, exit_speed, peak_speed);
    // In integers, because a cruise may be long.
    let level = length.saturating_sub(length_of(rise.length)).saturating_sub(length_of(fall.length));
    let scale = const { WHOLE as f32 } / size;
    // Two ramps that fill the move may be too long by their rounding. They must not overlap.
    let accelerated = ((rise.length * scale) as u32).min(WHOLE);
    let cruised = (WHOLE - ((fall.length * scale) as u32).min(WHOLE)).max(accelerated);
    // The rounding remainder of a move that only ramps fill is no cruise: it would have time, but no length.
    let cruise = match level {
        _ if cruised == accelerated => SubTicks::ZERO,
        // Only a cruise at the nominal speed can be long. A move that does not reach it is short, and single precision
        // will do.
        _ if peak_sq == nominal_sq => cruise_time(level, nominal),
        _ => long_time(mm(level) / peak_speed * const { TICKS_PER_SECOND as f32 }),
    };
    let times = match [rise.time, cruise, fall.time] {
        long if cruise >= LONG_TIME => evened(long, (rise.length * scale, fall.length * scale)),
        times => times,
    };
    let planned = Move {
        end,
        accelerated,
        cruised,
        entry_share: rise.share,
        exit_share: fall.share,
        accelerate: times[0],
        cruise: times[1],
        decelerate: times[2],
        length,
        acceleration: a,
        advance: Steps::ZERO,
        brakes_first,
        rests: exit_sq == SpeedSq::ZERO,
        watch,
    };
    (planned, exit_speed)
}

/// The times of a long move's phases, matched to the fractions of its distance at which the phases end. These fractions
/// are cut to whole ones, given the fractions of both ramps; the missing parts of the ramps are cruised.
#[cold]
#[inline(never)]
fn evened([rise, cruise, fall]: [SubTicks; 3], (accelerated, decelerated): (f32, f32)) -> [SubTicks; 3] {
    // The time of a fraction of one at the speed of the cruise, in ticks times 2^16.
    let ramps = u64::from(accelerated as u32) + u64::from(decelerated as u32);
    let level = u64::from(WHOLE).saturating_sub(ramps).max(1);
    let one = u32::try_from(cruise.0 / level).unwrap_or(u32::MAX) as f32;
    let lacking = |fraction: f32| SubTicks(u64::from(((fraction - (fraction as u32) as f32) * one) as u32));
    let (begin, end) = (lacking(accelerated).min(rise), lacking(decelerated).min(fall));
    [rise - begin, cruise + begin + end, fall - end]
}

/// A phase in which the speed changes.
struct Ramp {
    /// In mm.
    length: f32,
    /// In ticks times 2^16.
    time: SubTicks,
    /// The part of it that its lower speed alone would cover in its time, scaled by [`WHOLE`].
    share: u32,
}

impl Ramp {
    /// One on which the squared speed changes by `change`, given twice the acceleration and the speeds at both ends.
    /// Its time is its length over the mean of the two, in which nothing cancels; the difference of two roots would.
    /// Neither does it in its share: of two speeds that are nearly the same it is one less their difference.
    #[inline(always)]
    fn new(change: SpeedSq, twice_a: f32, end: f32, peak: f32) -> Self {
        let sum = end + peak;
        let slow = if end < peak { end } else { peak };
        let gain = square(change);
        let share = if slow * 3.0 <= sum {
            ((slow + slow) / sum * const { WHOLE as f32 }) as u32
        } else {
            // One less (fast - slow) / sum, which is gain / sum^2.
            WHOLE.saturating_sub((gain / (sum * sum) * const { WHOLE as f32 }) as u32)
        };
        if change == SpeedSq::ZERO {
            return Self { length: 0.0, time: SubTicks::ZERO, share };
        }
        let length = gain / twice_a;
        Self { length, time: long_time(length / sum * const { 2.0 * TICKS_PER_SECOND as f32 }), share }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;

    fn sq(v: f64) -> SpeedSq {
        SpeedSq((v * v * 2f64.powi(32)) as u64)
    }

    fn seconds(t: SubTicks) -> f64 {
        t.0 as f64 / 65536.0 / 1e7
    }

    fn run(length: f64, a: f64, entry: f64, nominal: f64, exit: f64) -> Move {
        cruising(0.0, length, a, entry, nominal, exit)
    }

    fn cruising(ratio: f64, length: f64, a: f64, entry: f64, nominal: f64, exit: f64) -> Move {
        let length = Length::of(Mm::from_num(length));
        let spec = MoveSpec {
            length,
            max_ramp_length: max_ramp_length(length, Ratio::from_num(ratio)),
            acceleration: MmPerSec2::from_num(a),
            nominal: Feed::from_num(nominal),
            ..MoveSpec::NONE
        };
        let (planned, exit_speed) = profile(&spec, (sq(entry), entry as f32), sq(exit));
        assert!((f64::from(exit_speed) - exit).abs() <= 1e-7 * exit);
        planned
    }

    #[test]
    fn a_long_move_cruises() {
        let m = run(60.0, 3000.0, 0.0, 100.0, 0.0);
        assert!((seconds(m.accelerate) - 1.0 / 30.0).abs() < 1e-8);
        assert!((seconds(m.cruise) - (60.0 - 100.0 / 30.0) / 100.0).abs() < 1e-7);
        assert_eq!(m.entry_share, 0);
        assert!(m.rests);
    }

    /// Reproducer: shares of 24 bits made this ramp one of 758.9 mm/s2.
    #[test]
    fn a_ramp_between_nearly_equal_speeds_has_its_acceleration() {
        for change in [0.0005, 0.0127, 0.3, 40.0, 290.0] {
            let m = run(100.0, 757.0, 300.0, 300.0, 300.0 - change);
            let part = 1.0 - f64::from(m.exit_share) / f64::from(WHOLE);
            let found = 2.0 * part * (300.0 - change / 2.0) / seconds(m.decelerate);
            // Except for the last of the share's 31 bits.
            let tolerance = 1e-5 + 1.0 / (part * f64::from(WHOLE));
            assert!((found / 757.0 - 1.0).abs() < tolerance, "{change} mm/s: {found}");
        }
    }

    #[test]
    fn a_cruise_is_right_to_the_tick_however_long() {
        for (length, nominal) in [(468.0, 0.5), (4000.0, 0.25), (300.0, 33.5), (20.0, 20.0), (2.0, 255.0)] {
            let m = run(length, 3000.0, nominal, nominal, nominal);
            let error = m.cruise.0 as f64 / 65536.0 - length / nominal * 1e7;
            assert!(error.abs() < 0.01, "{length} mm at {nominal} mm/s: off by {error} ticks");
        }
    }

    #[test]
    fn a_short_move_peaks_where_the_ramps_meet() {
        let m = run(1.0, 1000.0, 10.0, 300.0, 20.0);
        let peak = (250.0f64 + 1000.0).sqrt();
        assert!((seconds(m.accelerate) - (peak - 10.0) / 1000.0).abs() < 1e-7);
        assert!((seconds(m.decelerate) - (peak - 20.0) / 1000.0).abs() < 1e-7);
        assert!(seconds(m.cruise) < 1e-6);
        assert!(!m.rests);
    }

    #[test]
    fn a_short_move_cruises_over_its_ratio() {
        for (ratio, length, entry, exit) in [(0.5, 1.0, 0.0, 0.0), (0.5, 2.0, 10.0, 20.0), (0.9, 5.0, 30.0, 0.0)] {
            let m = cruising(ratio, length, 1000.0, entry, 300.0, exit);
            let level = f64::from(m.cruised - m.accelerated) / f64::from(WHOLE);
            assert!((level - ratio).abs() < 1e-4, "{level} of {ratio}");
            let peak = ((entry * entry + exit * exit) / 2.0 + 1000.0 * (1.0 - ratio) * length).sqrt();
            assert!((seconds(m.cruise) * peak / (ratio * length) - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn a_ratio_changes_no_move_that_cruises_as_long_or_ramps_all_along() {
        for (length, entry, exit) in
            [(60.0, 0.0, 0.0), (20.0, 0.0, 100.0), (1.5, 0.0, 3000f64.sqrt()), (1.5, 3000f64.sqrt(), 0.0)]
        {
            let moves = [0.0, 0.5].map(|ratio| cruising(ratio, length, 1000.0, entry, 100.0, exit));
            assert_eq!(moves[0], moves[1], "{length} {entry} {exit}");
        }
    }

    #[test]
    fn a_move_at_one_speed_only_cruises() {
        let m = run(5.0, 1000.0, 50.0, 50.0, 50.0);
        assert_eq!((m.accelerate, m.decelerate), (SubTicks::ZERO, SubTicks::ZERO));
        assert_eq!((m.accelerated, m.cruised), (0, WHOLE));
        assert!((seconds(m.cruise) - 0.1).abs() < 1e-7);
    }

    #[test]
    fn a_move_entered_too_fast_brakes_first() {
        let m = run(20.0, 1000.0, 100.0, 50.0, 20.0);
        assert!(m.brakes_first);
        assert!((seconds(m.accelerate) - 0.05).abs() < 1e-7);
        let (first, last) = ((10_000.0 - 2500.0) / 2000.0, (2500.0 - 400.0) / 2000.0);
        assert!((seconds(m.cruise) - (20.0 - first - last) / 50.0).abs() < 1e-7);
        assert!((f64::from(m.accelerated) / f64::from(WHOLE) - first / 20.0).abs() < 1e-8);
        // With no room for its nominal speed it brakes all the way.
        let m = run(2.0, 1000.0, 100.0, 50.0, 6000f64.sqrt());
        assert!((seconds(m.accelerate) - (100.0 - 6000f64.sqrt()) / 1000.0).abs() < 1e-7);
        assert!(seconds(m.cruise + m.decelerate) < 1e-6);
    }
}
