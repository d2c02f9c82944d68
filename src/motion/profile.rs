//! Trapezoids: from distance, acceleration and the speeds at both ends to times.
//!
//! Three phases: accelerate from the entry speed to the peak, cruise, decelerate to the exit speed. Where
//! the distance is too short for the nominal speed, the peak is where the two ramps meet:
//! `peak^2 = (entry^2 + exit^2) / 2 + a L`. With a minimum cruise ratio r the ramps have only `(1 - r) L` to meet in, and
//! the move cruises between them, so that a row of short moves does not fall from accelerating into braking in each of
//! them (Klipper's minimum_cruise_ratio). A move that must accelerate or brake all along, because the next corner is that
//! much faster or slower, still does. A move that is entered above its nominal speed brakes to it first.

use super::geometry::acceleration;
use super::moves::{Move, WHOLE};
use super::number::{from_bits, root_of, to_bits};
use crate::port::EndstopSet;
use crate::units::{MmPerSec2, Ratio, Steps, TICKS_PER_SECOND, mul_div};

/// The speeds of a move, squared, in raw bits of 2^-32 mm2/s2.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Speeds {
    /// At its begin.
    pub entry: u64,
    /// Not to be exceeded.
    pub nominal: u64,
    /// At its end.
    pub exit: u64,
}

/// Speed squared gained over `length` (raw `Mm` bits): 2 a L, saturating.
#[must_use]
pub const fn gain(a: MmPerSec2, length: u64) -> u64 {
    // Acceleration has 8 fractional bits, so 2 a L is a product shifted by 7; in two halves, to save its upper 64 bits.
    let a = a.to_bits() as u64;
    let (high, low) = (a * (length >> 32), (a * (length & 0xFFFF_FFFF)) >> 7);
    if high >> 38 != 0 { u64::MAX } else { (high << 25).saturating_add(low) }
}

/// The speed of a given square, in 2^-32 mm/s. The square is scaled up first, so that the root has 31
/// significant bits however slow the move is: at 200 mm/s2 the 2^-16 mm/s of `MmPerSec` are a tick.
pub(super) fn speed(square: u64) -> u64 {
    let shift = square.leading_zeros() & !1;
    if square == 0 { 0 } else { (u64::from(root_of(square << shift)) << 16) >> (shift / 2) }
}

/// Time in ticks times 2^16 to change the speed by `change` (2^-32 mm/s).
fn ramp_time(change: u64, a: MmPerSec2) -> u64 {
    let ticks = from_bits(change) / acceleration(a) * const { TICKS_PER_SECOND as f32 };
    to_bits(ticks) >> 16
}

/// Time in ticks times 2^16 over `length` at a nominal speed, which has 16 fractional bits. It may be long, so every bit
/// counts.
fn cruise_time(length: u64, speed: u64) -> u64 {
    if length == 0 { 0 } else { mul_div(length, u64::from(TICKS_PER_SECOND), (speed >> 16).max(1)) }
}

/// The same at any speed, for a cruise between two ramps that do not reach the nominal speed.
fn short_time(length: u64, speed: u64) -> u64 {
    let ticks = from_bits(length) / from_bits(speed) * const { TICKS_PER_SECOND as f32 };
    to_bits(ticks) >> 16
}

/// `part / whole`, scaled by [`WHOLE`].
pub(super) const fn fraction(part: u64, whole: u64) -> u32 {
    // 33 bits of the whole are enough, and the product fits.
    let shift = 31u32.saturating_sub(whole.leading_zeros());
    let (part, whole) = (part >> shift, whole >> shift);
    match (part * WHOLE as u64).checked_div(whole) {
        Some(scaled) if scaled < WHOLE as u64 => scaled as u32,
        _ => WHOLE,
    }
}

/// Distance in raw `Mm` bits over which the squared speed changes by `change`: v^2 / 2a.
pub(super) fn ramp_length(change: u64, a: MmPerSec2) -> u64 {
    to_bits(from_bits(change) / (acceleration(a) * 2.0))
}

/// A part of a way that only ramps may take up, in raw `Mm` bits, given the ratio of it that is to be a cruise.
#[must_use]
pub fn ramps_of(length: u64, cruise: Ratio) -> u64 {
    let part = u64::from((Ratio::ONE.saturating_sub(cruise)).to_bits());
    mul_div(length, part, const { Ratio::ONE.to_bits() as u64 })
}

/// A move over `length` raw `Mm` bits to `end`, of which `ramps` are for accelerating and braking if entry and exit allow
/// it. The entry and exit speed must be possible: `|exit - entry| <= gain(a, length)` but for rounding.
#[must_use]
pub fn profile((length, ramps): (u64, u64), a: MmPerSec2, speeds: Speeds, end: [Steps; 4], watch: EndstopSet) -> Move {
    let meet = speeds.entry / 2 + speeds.exit / 2 + gain(a, ramps) / 2;
    let brakes_first = speeds.entry > speeds.nominal;
    let least = if brakes_first { 1 } else { speeds.entry.max(1) };
    let peak = speeds.nominal.min(meet).max(speeds.exit).max(least);
    let (entry_speed, exit_speed) = (speed(speeds.entry), speed(speeds.exit));
    // In the middle of a long ramp the peak is one of the ends, and its root known.
    let peak_speed = match peak {
        _ if peak == speeds.exit => exit_speed,
        _ if peak == speeds.entry => entry_speed,
        _ => speed(peak),
    };

    let rise = ramp_length(peak.abs_diff(speeds.entry), a).min(length);
    let fall = ramp_length(peak - speeds.exit, a).min(length - rise);
    let level = length - rise - fall;
    // A ramp's length is its time times the mean of its two speeds.
    let share = |one: u64, other: u64| {
        let (one, other) = (from_bits(one), from_bits(other));
        let slow = if one < other { one } else { other };
        ((slow + slow) / (one + other) * const { WHOLE as f32 }) as u32
    };
    Move {
        end,
        accelerated: if rise == 0 { 0 } else { fraction(rise, length) },
        cruised: if fall == 0 { WHOLE } else { fraction(length - fall, length) },
        entry_share: share(entry_speed, peak_speed),
        exit_share: share(exit_speed, peak_speed),
        accelerate: ramp_time(peak_speed.abs_diff(entry_speed), a),
        cruise: if peak == speeds.nominal { cruise_time(level, peak_speed) } else { short_time(level, peak_speed) },
        decelerate: ramp_time(peak_speed - exit_speed, a),
        length,
        acceleration: a,
        advance: Steps::ZERO,
        brakes_first,
        rests: speeds.exit == 0,
        watch,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Mm;

    fn sq(v: f64) -> u64 {
        (v * v * 2f64.powi(32)) as u64
    }

    fn seconds(t: u64) -> f64 {
        t as f64 / 65536.0 / 1e7
    }

    fn run(length: f64, a: f64, entry: f64, nominal: f64, exit: f64) -> Move {
        cruising(0.0, length, a, entry, nominal, exit)
    }

    fn cruising(ratio: f64, length: f64, a: f64, entry: f64, nominal: f64, exit: f64) -> Move {
        let speeds = Speeds { entry: sq(entry), nominal: sq(nominal), exit: sq(exit) };
        let length = Mm::from_num(length).to_bits() as u64;
        let ramps = ramps_of(length, Ratio::from_num(ratio));
        profile((length, ramps), MmPerSec2::from_num(a), speeds, [Steps::ZERO; 4], EndstopSet::NONE)
    }

    #[test]
    fn a_long_move_cruises() {
        let m = run(60.0, 3000.0, 0.0, 100.0, 0.0);
        assert!((seconds(m.accelerate) - 1.0 / 30.0).abs() < 1e-8);
        assert!((seconds(m.cruise) - (60.0 - 100.0 / 30.0) / 100.0).abs() < 1e-7);
        assert_eq!(m.entry_share, 0);
        assert!(m.rests);
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
        assert_eq!((m.accelerate, m.decelerate), (0, 0));
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
