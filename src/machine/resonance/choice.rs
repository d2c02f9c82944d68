//! Choice: the shortest shaper that leaves little of the measured vibration, even if the frequency is a little off.
//!
//! The vibration that is left is Klipper's (`shaper_calibrate.py`): the shaper's response times the measured one, less
//! a twentieth of its peak. The frequency is the one of a mode, and the shaper gets the mode's damping. Klipper builds
//! shapers for a damping of 0.1 and moves their frequency instead, so its numbers are a little higher. Corners are
//! rounded by 0.12 mm at the acceleration that is told, as Klipper reckons it.

use super::response::Response;
use crate::machine::answers::resonance_answer::Mode;
use crate::motion::impulses;
use crate::settings::{Shaper, ShaperKind};
use crate::units::{Hertz, MmPerSec2, Ratio};
use core::ops::RangeInclusive;

/// The shapers, the shortest first. ZV is not suggested: it leaves twice as much as MZV where the frequency is a little
/// off, and Klipper takes it only if no other leaves less.
const KINDS: [ShaperKind; 4] = [ShaperKind::Mzv, ShaperKind::Ei, ShaperKind::Zvd, ShaperKind::TwoHumpEi];

/// A shaper may leave this part.
const MOST_LEFT: f32 = 0.05;

/// The frequency may be off by this factor: over the bed of a belt machine it changes by up to 14 %
/// (docs/explanation/shaping.md).
const OFF: [f32; 3] = [1.0, 0.93, 1.07];

/// Klipper's limit of smoothing in mm, and the speed of corners in mm/s that it reckons with.
const SMOOTHING: f32 = 0.12;
const CORNER: f32 = 5.0;

/// A shaper, and what it does.
#[derive(Clone, Copy)]
pub(super) struct Chosen {
    pub shaper: Shaper,
    /// Part of the vibration that it leaves at the measured frequency.
    pub left: f32,
}

/// The shaper for a response with these modes, the highest first; what it has besides is as in `base`.
pub(super) fn choose(
    response: &Response,
    step_hz: f32,
    ends: &RangeInclusive<usize>,
    modes: &[Mode],
    base: Shaper,
) -> Option<Chosen> {
    let mut best: Option<(f32, Chosen)> = None;
    for kind in KINDS {
        for mode in modes {
            let shaper = Shaper {
                kind,
                frequency: Hertz::from_bits(((mode.centihertz << 16) + 50) / 100),
                damping: Ratio::from_bits(((u32::from(mode.damping) << 16) + 500) / 1000),
                ..base
            };
            let left = OFF.map(|off| left(response, step_hz * off, ends, &shaper));
            let worst = left.into_iter().fold(0.0, |worst, left| if left > worst { left } else { worst });
            let [left, ..] = left;
            if best.as_ref().is_none_or(|(least, _)| worst < *least) {
                best = Some((worst, Chosen { shaper, left }));
            }
        }
        if best.as_ref().is_some_and(|(worst, _)| *worst < MOST_LEFT) {
            break;
        }
    }
    best.map(|(_, chosen)| chosen)
}

/// Part of the vibration that a shaper leaves, with frequencies of the response so far apart.
#[inline(never)]
fn left(response: &Response, step_hz: f32, ends: &RangeInclusive<usize>, shaper: &Shaper) -> f32 {
    let impulses = impulses(shaper);
    let damping: f32 = shaper.damping.to_num();
    let last = impulses.last().map_or(0.0, |(time, _)| *time);
    // Of each impulse: its part at this frequency, and the factor from one frequency to the next.
    let mut all = [[0.0; 4]; 4];
    for (part, (time, weight)) in all.iter_mut().zip(&impulses) {
        let angle = core::f32::consts::TAU * step_hz * *time;
        // The last impulse is not damped, the others until then.
        let damped = 1.0 - damping * core::f32::consts::TAU * step_hz * (last - *time);
        *part = [*weight, 0.0, damped * cosine(angle), damped * sine(angle)];
    }
    let floor =
        ends.clone().map(|number| response.at(number)).fold(0.0, |most, at| if at > most { at } else { most }) / 20.0;
    let (mut before, mut after) = (0.0, 0.0);
    for number in 0..=*ends.end() {
        let (mut re, mut im) = (0.0, 0.0);
        for [a, b, c, s] in &mut all {
            re += *a;
            im += *b;
            (*a, *b) = (*a * *c - *b * *s, *a * *s + *b * *c);
        }
        if number >= *ends.start() {
            let at = response.at(number);
            let more = |value: f32| if value > floor { value - floor } else { 0.0 };
            before += more(at);
            after += more(at * crate::motion::root(re * re + im * im));
        }
    }
    if before > 0.0 { after / before } else { 0.0 }
}

/// The acceleration at which the shaper rounds corners by [`SMOOTHING`].
pub(super) fn most_acceleration(shaper: &Shaper) -> MmPerSec2 {
    let impulses = impulses(shaper);
    let mean: f32 = impulses.iter().map(|(time, weight)| time * weight).sum();
    // A turn by 180 degrees, and by 90.
    let (mut square, mut way, mut late) = (0.0, 0.0, 0.0);
    for (time, weight) in &impulses {
        let off = time - mean;
        square += weight * (off * off);
        if off > 0.0 {
            way += weight * off;
            late += weight * (off * off);
        }
    }
    let back = 2.0 * SMOOTHING / square;
    let aside = 2.0 * (SMOOTHING * core::f32::consts::FRAC_1_SQRT_2 - CORNER * way) / late;
    MmPerSec2::saturating_from_num(if back < aside { back } else { aside })
}

/// Cosine and sine of a small angle.
fn cosine(x: f32) -> f32 {
    1.0 - x * x / 2.0 * (1.0 - x * x / 12.0)
}

fn sine(x: f32) -> f32 {
    x * (1.0 - x * x / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Settings;

    /// Klipper's own numbers for its choices.
    #[test]
    fn the_acceleration_is_klippers() {
        for (kind, hz, most) in [
            (ShaperKind::Zv, 48.8, 9281.0),
            (ShaperKind::Mzv, 50.2, 7424.0),
            (ShaperKind::Mzv, 81.2, 19_424.0),
            (ShaperKind::Mzv, 44.4, 5807.0),
        ] {
            let frequency = Hertz::from_num(hz);
            let shaper = Shaper { kind, frequency, damping: Ratio::from_num(0.1), ..Settings::prototype().shapers.x };
            let found: f64 = most_acceleration(&shaper).to_num();
            assert!((found / most - 1.0).abs() < 0.03, "{kind:?}: {found}");
        }
    }
}
