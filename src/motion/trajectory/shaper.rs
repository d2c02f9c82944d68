//! Shapers: the taps of each axis, from the settings.
//!
//! An input shaper splits every command into impulses that cancel each other's vibration. Sources: N. Singer, W.
//! Seering, "Preshaping Command Inputs to Reduce System Vibration" (1990) for ZV and ZVD; W. Singhose et al., "Residual
//! Vibration Reduction Using Vector Diagrams to Generate Shaped Inputs" (1994) and "Extra-Insensitive Input Shapers for
//! Controlling Flexible Spacecraft" (1996) for EI and its humps. The fits over the damping are from Klipper's
//! documentation.
//!
//! The function [`taps`] below also makes the two taps of the pressure advance, from `Advance::window`. If the settings
//! leave this window open, [`advance_window`] gives its length.
//!
//! All axes have the same total delay, set by the slowest shaper and the advance, so that they stay together.

use super::{AXES, Stiffening, TAPS, Tap, Taps};
use crate::motion::number::{acceleration, speed};
use crate::settings::{HomedAxis, Range, Settings, Shaper, ShaperKind, Shapers, ranges};
use crate::units::{Mm, Seconds, StepsPerMm, TICKS_PER_SECOND};
use heapless::Vec;

/// An impulse: its time in s, and its weight.
pub(crate) type Impulse = (f32, f32);

/// Most impulses of a shaper: one with two humps has four. Each becomes a tap.
pub(crate) const MOST_IMPULSES: usize = 4;
const _: () = assert!(MOST_IMPULSES <= TAPS);

/// Impulses of a shaper.
pub(crate) type Impulses = Vec<Impulse, MOST_IMPULSES>;

/// Residual vibration of EI shapers.
const LEFT: f32 = 0.05;

/// e to the power of `-x`, for x from 0 to 4: the series of a sixteenth, squared four times.
fn decay(x: f32) -> f32 {
    let y = x / 16.0;
    let mut power = 1.0 - y * (1.0 - y / 2.0 * (1.0 - y / 3.0 * (1.0 - y / 4.0 * (1.0 - y / 5.0))));
    for _ in 0..4 {
        power *= power;
    }
    power
}

/// A polynomial by its factors, that of the highest power last.
const fn polynomial(factors: &[f32], x: f32) -> f32 {
    let (mut sum, mut left) = (0.0, factors);
    while let [rest @ .., factor] = left {
        (sum, left) = (sum * x + *factor, rest);
    }
    sum
}

/// Factors of a fit over the damping.
type Fit = [f32; 4];

/// A fit of EI: rows are the powers of the damping, columns those of the residual vibration.
const fn of_vibration(rows: [[f32; 3]; 4]) -> Fit {
    let [a, b, c, d] = rows;
    [polynomial(&a, LEFT), polynomial(&b, LEFT), polynomial(&c, LEFT), polynomial(&d, LEFT)]
}

/// Time of the second impulse of EI, and weights of the first and the last one.
static EI: [Fit; 3] = [
    of_vibration([[0.4999, 0.0, 0.0], [0.0, 0.46159, 8.57843], [0.0, 4.26169, -108.644], [0.0, 1.75601, 336.989]]),
    of_vibration([[0.24968, 0.24961, 0.0], [0.80008, 1.23328, 0.0], [0.49599, 3.17316, 0.0], [0.0; 3]]),
    of_vibration([[0.25149, 0.21474, 0.0], [-0.83249, 1.41498, 0.0], [0.85181, -4.90094, 0.0], [0.0; 3]]),
];

/// Times and weights of the impulses of EI with two humps, for 5 % of residual vibration. Times are in periods without
/// damping.
static TWO_HUMP_EI: [(Fit, Fit); MOST_IMPULSES] = [
    ([0.0; 4], [0.16054, 0.76699, 2.2656, -1.2275]),
    ([0.4989, 0.1627, -0.54262, 6.1618], [0.33911, 0.45081, -2.5808, 1.7365]),
    ([0.99748, 0.18382, -1.5827, 8.1712], [0.34089, -0.61533, -0.68765, 0.42261]),
    ([1.4992, -0.09297, -0.28338, 1.8571], [0.15997, -0.60246, 1.0028, -0.93145]),
];

/// The impulses of a shaper; their weights sum to 1.
#[inline(never)]
pub(crate) fn impulses(shaper: &Shaper) -> Impulses {
    let z: f32 = shaper.damping.to_num();
    let frequency: f32 = shaper.frequency.to_num();
    let root = crate::motion::number::root(1.0 - z * z);
    let period = 1.0 / (frequency * root);
    // The amplitude that is left after half a damped period: later impulses are weaker by as much.
    let k = decay(z * core::f32::consts::PI / root);
    let mut all = [(0.0, 1.0); MOST_IMPULSES];
    let [first, second, third, _] = &mut all;
    let count = match shaper.kind {
        ShaperKind::None => 1,
        ShaperKind::Zv => {
            *second = (0.5, k);
            2
        }
        ShaperKind::Zvd => {
            (*second, *third) = ((0.5, 2.0 * k), (1.0, k * k));
            3
        }
        // Its impulses are three eighths of a period apart, three quarters of the half for which `k` holds.
        ShaperKind::Mzv => {
            let k = decay(0.75 * z * core::f32::consts::PI / root);
            first.1 = 1.0 - core::f32::consts::FRAC_1_SQRT_2;
            *second = (0.375, (core::f32::consts::SQRT_2 - 1.0) * k);
            *third = (0.75, first.1 * k * k);
            3
        }
        ShaperKind::Ei => {
            let [time, begin, end] = &EI;
            first.1 = polynomial(begin, z);
            *third = (1.0, polynomial(end, z));
            *second = (polynomial(time, z), 1.0 - first.1 - third.1);
            3
        }
        ShaperKind::TwoHumpEi => {
            for ((time, weight), (of_time, of_weight)) in all.iter_mut().zip(&TWO_HUMP_EI) {
                (*time, *weight) = (root * polynomial(of_time, z), polynomial(of_weight, z));
            }
            MOST_IMPULSES
        }
    };
    // The laws leave out a common factor, and fits do not sum to 1 exactly.
    let mut sum = 0.0;
    for (_, weight) in all.iter().take(count) {
        sum += weight;
    }
    let mut impulses = Impulses::new();
    for (time, weight) in all.iter().take(count) {
        // There is a place for each.
        let _ = impulses.push((time * period, weight / sum));
    }
    impulses
}

/// Mean delay of an impulse response.
fn mean(impulses: &Impulses) -> f32 {
    impulses.iter().map(|(time, weight)| time * weight).sum()
}

/// Spread of a shaper: the standard deviation of its impulses, in s.
fn spread(impulses: &Impulses) -> f32 {
    let mean = mean(impulses);
    let square = impulses.iter().map(|(time, weight)| weight * (time - mean) * (time - mean)).sum();
    crate::motion::number::root(square)
}

/// A uniform window of length h has a standard deviation of h over this, the square root of 12.
const EVEN: f32 = 3.464_102;

/// The part of that length which suits a shaper. Where the tool turns, x and y are both between two speeds. So its path
/// is slower than the speed of the plan through the shaper, and a shorter window follows it better. A still shorter one
/// starves the bead behind corners. Measured: `corehbot-lab flow`, docs/explanation/shaping.md#the-window.
const FITTING: f32 = 0.78;

/// Window where an axis has no shaper, in s. The extruder's motor must not be asked for jumps, and the nozzle itself
/// smooths over about 50 ms. Measured: 12 to 15 ms lose nothing (docs/explanation/shaping.md#the-window).
const LEAST_WINDOW: f32 = 0.012;

/// Filament per length of path that the window must support: a line of 0.5 by 0.24 mm from filament of 1.75 mm. The
/// planner accelerates heavier lines more slowly.
const HEAVY_LINE: f32 = 0.05;

/// Largest part of the extruder's speed for ramps, as the planner shares it (`motion::planner::pressure`). No window
/// has to support more acceleration than that.
pub(in crate::motion) const MOST_PUSH: f32 = 0.75;

/// Longest window for the extruder's sake, in s: beyond, the flow would lose more than acceleration gains. It was the
/// window of all earlier firmware, as it is Klipper's.
const LONGEST_FOR_EXTRUDER: f32 = 0.04;

/// The window of the pressure advance: from the settings, or else from the spread of the slower shaper.
///
/// A shaper delays by different times with different weights. A uniform window with the same standard deviation follows
/// the shaped motion of one axis best: both agree up to the second order. For the tool's path it is `FITTING` of
/// that. It is longer if the extruder could not otherwise follow a heavy line at the highest acceleration of x or y.
/// Both ends of the window may see K a, which it spreads over its length.
#[must_use]
pub fn advance_window(s: &Settings) -> Seconds {
    if let Some(window) = s.advance.window {
        return window;
    }
    let (x, y) = (spread(&impulses(&s.shapers.x)), spread(&impulses(&s.shapers.y)));
    let k: f32 = s.advance.time.to_num();
    let (v, a) = (speed(s.axes.e.max_speed), acceleration(s.axes.e.max_acceleration));
    let path = acceleration(s.axes.x.max_acceleration.max(s.axes.y.max_acceleration));
    // With q = K times the filament's acceleration: `(a_e + 2 q / h) <= a`.
    let push = (k * (HEAVY_LINE * path)).min(MOST_PUSH * v);
    let left = a - HEAVY_LINE * path;
    let needed = if left * LONGEST_FOR_EXTRUDER > 2.0 * push { 2.0 * push / left } else { LONGEST_FOR_EXTRUDER };
    let needed = if push > 0.0 { needed } else { 0.0 };
    let least = if x.min(y) > 0.0 { 0.0 } else { LEAST_WINDOW };
    let seconds = (const { FITTING * EVEN } * x.max(y)).max(least).max(needed);
    // In whole tenths of a millisecond, which are easier to read and much finer than needed.
    let tenths = u64::from(((seconds * 10_000.0 + 0.5) as u32).min(10_000));
    ranges::ADVANCE_WINDOW.clamp(Seconds::from_bits((((tenths << Seconds::FRAC_NBITS) + 5000) / 10_000) as u32))
}

fn tap((time, weight): Impulse) -> Tap {
    Tap { delay: (time.max(0.0) * const { TICKS_PER_SECOND as f32 * 256.0 }) as u32, weight }
}

/// The taps of each axis: x, y, z, e, and the advance, if it has a window for averaging its speed.
#[must_use]
pub fn taps(shapers: &Shapers, window: Option<Seconds>) -> [Taps; AXES] {
    let (x, y) = (impulses(&shapers.x), impulses(&shapers.y));
    let window: f32 = window.unwrap_or_default().to_num();
    let half = window / 2.0;
    let delay = mean(&x).max(mean(&y)).max(half);
    let shaped = |impulses: Impulses| {
        let early = delay - mean(&impulses);
        impulses.into_iter().map(|(time, weight)| tap((early + time, weight))).collect()
    };
    // No window means no advance; `sim/board/src/limits.rs` divides by it too. A delay holds 1.67 s. If it is longer
    // than `SPANS` of short moves, short moves take longer (docs/explanation/shaping.md has the delays, and the events
    // of `examples/shaping.gcode`).
    const {
        assert!(
            ranges::ADVANCE_WINDOW.least.to_bits() > 0
                && ranges::ADVANCE_WINDOW.most.to_bits() < Seconds::ONE.to_bits()
        )
    };
    let late: Taps = [tap((delay, 1.0))].into_iter().collect();
    let advance = if window > 0.0 {
        [tap((delay - half, 1.0 / window)), tap((delay + half, -1.0 / window))].into_iter().collect()
    } else {
        Taps::new()
    };
    [shaped(x), shaped(y), late.clone(), late, advance]
}

/// Frequency of x and y away from the middle. Belts of the lengths l1 and l2 on both sides of the tool have the
/// stiffness `EA (1/l1 + 1/l2)`. It is lowest in the middle, and 1 / (1 - (2 d/L)^2) times that at the distance d from
/// it, with their sum L. The motors that drive the belts are equally compliant everywhere:
/// `1/f^2 = 1/f_belt^2 + 1/f_motor^2`.
#[must_use]
pub fn stiffenings(s: &Settings) -> [Stiffening; 2] {
    [
        stiffening(&s.shapers.x, s.axes.x.steps_per_mm, s.reach(HomedAxis::X)),
        stiffening(&s.shapers.y, s.axes.y.steps_per_mm, s.reach(HomedAxis::Y)),
    ]
}

fn stiffening(shaper: &Shaper, resolution: StepsPerMm, reach: Range<Mm>) -> Stiffening {
    if shaper.span == Mm::ZERO {
        return Stiffening::NONE;
    }
    let (frequency, motor): (f32, f32) = (shaper.frequency.to_num(), shaper.motor_frequency.to_num());
    let (span, steps_per_mm): (f32, f32) = (shaper.span.to_num(), resolution.to_num());
    let softness = if motor > 0.0 { frequency / motor } else { 0.0 };
    let half = 0.5 * span * steps_per_mm;
    let centre = (reach.least.saturating_add(reach.most) * resolution) >> 1;
    Stiffening { centre, rate: (1.0 - softness * softness) / (half * half) }
}
