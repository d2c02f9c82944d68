//! Shaper: a command in parts with vibrations that cancel.
//!
//! ZV, ZVD: Singer and Seering, Journal of Dynamic Systems, Measurement, and Control 112, 1990. EI and 2HUMP_EI for 5 %
//! of vibration: Singhose, Seering and Singer, "Input shaping for vibration reduction with specified insensitivity to
//! modeling errors", 1996. MZV, and all of them as in printer firmware: Klipper, `shaper_defs.py`.

use crate::math::{cos, exp, hypot, sin};
use serde::Serialize;
use std::f64::consts::{SQRT_2, TAU};

/// A kind of input shaper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum ShaperKind {
    /// Zero vibration.
    Zv,
    /// Modified zero vibration.
    Mzv,
    /// Zero vibration and derivative.
    Zvd,
    /// Extra insensitive.
    Ei,
    /// Extra insensitive with two humps.
    #[serde(rename = "2HUMP_EI")]
    TwoHumpEi,
}

/// Residual vibration of EI and 2HUMP_EI at their own frequency.
const TOLERATED: f64 = 0.05;

impl ShaperKind {
    /// All of them, the shortest first.
    pub const ALL: [Self; 5] = [Self::Zv, Self::Mzv, Self::Zvd, Self::Ei, Self::TwoHumpEi];

    /// Its usual name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Zv => "ZV",
            Self::Mzv => "MZV",
            Self::Zvd => "ZVD",
            Self::Ei => "EI",
            Self::TwoHumpEi => "2HUMP_EI",
        }
    }

    /// Its T of M593.
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::Zv => 0,
            Self::Zvd => 1,
            Self::Mzv => 2,
            Self::Ei => 3,
            Self::TwoHumpEi => 4,
        }
    }
}

/// A part of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// Its part of the command, of 1.
    pub amount: f64,
    /// Its delay, in s.
    pub time_s: f64,
}

/// The parts of a shaper for this frequency and damping.
#[must_use]
pub fn impulses(kind: ShaperKind, frequency_hz: f64, damping: f64) -> Vec<Impulse> {
    let root = (1.0 - damping * damping).sqrt();
    let period = 1.0 / (frequency_hz * root);
    let decay = |part: f64| exp(-part * TAU * damping / root);
    let parts: Vec<(f64, f64)> = match kind {
        ShaperKind::Zv => vec![(1.0, 0.0), (decay(0.5), 0.5)],
        ShaperKind::Zvd => vec![(1.0, 0.0), (2.0 * decay(0.5), 0.5), (decay(1.0), 1.0)],
        ShaperKind::Mzv => {
            let ends = 1.0 - 1.0 / SQRT_2;
            vec![(ends, 0.0), ((SQRT_2 - 1.0) * decay(0.375), 0.375), (ends * decay(0.75), 0.75)]
        }
        ShaperKind::Ei => ei(damping),
        // Its times are in undamped periods.
        ShaperKind::TwoHumpEi => two_hump(damping).into_iter().map(|(a, t)| (a, t * root)).collect(),
    };
    let sum: f64 = parts.iter().map(|(amount, _)| amount).sum();
    parts.into_iter().map(|(amount, t)| Impulse { amount: amount / sum, time_s: t * period }).collect()
}

/// Singhose's fits of the damped EI shaper, times in damped periods.
fn ei(z: f64) -> Vec<(f64, f64)> {
    let v = TOLERATED;
    let first = 0.24968 + 0.24962 * v + 0.80008 * z + 1.23328 * v * z + 0.49599 * z * z + 3.17316 * v * z * z;
    let last = 0.25149 + 0.21474 * v - 0.83249 * z + 1.41498 * v * z + 0.85181 * z * z - 4.90094 * v * z * z;
    let middle = 0.49990
        + (0.46159 * z + 4.26169 * z * z + 1.75601 * z * z * z) * v
        + (8.57843 * z - 108.644 * z * z + 336.989 * z * z * z) * v * v;
    vec![(first, 0.0), (1.0 - first - last, middle), (last, 1.0)]
}

/// Singhose's fits of the damped shaper with two humps, times in undamped periods.
fn two_hump(z: f64) -> Vec<(f64, f64)> {
    let cubic = |[a, b, c, d]: [f64; 4]| a + z * (b + z * (c + z * d));
    vec![
        (cubic([0.16054, 0.76699, 2.2656, -1.2275]), 0.0),
        (cubic([0.33911, 0.45081, -2.5808, 1.7365]), cubic([0.49890, 0.16270, -0.54262, 6.1618])),
        (cubic([0.34089, -0.61533, -0.68765, 0.42261]), cubic([0.99748, 0.18382, -1.5827, 8.1712])),
        (cubic([0.15997, -0.60246, 1.0028, -0.93145]), cubic([1.4992, -0.09297, -0.28338, 1.8571])),
    ]
}

/// Residual vibration after the last part, relative to the vibration of the whole command at once.
#[must_use]
pub fn residual(impulses: &[Impulse], frequency_hz: f64, damping: f64) -> f64 {
    let decay = TAU * frequency_hz * damping;
    let omega = TAU * frequency_hz * (1.0 - damping * damping).sqrt();
    let end = impulses.last().map_or(0.0, |last| last.time_s);
    let sum = |part: fn(f64) -> f64| -> f64 {
        impulses.iter().map(|i| i.amount * exp(decay * (i.time_s - end)) * part(omega * i.time_s)).sum()
    };
    hypot(sum(cos), sum(sin))
}

/// Acceleration for smoothing figures, in mm/s^2; as in Klipper.
pub const SMOOTHED_ACCELERATION: f64 = 5000.0;

/// Corner speed for smoothing figures, in mm/s; as in Klipper.
pub const CORNER_SPEED: f64 = 5.0;

/// Corner rounding of a shaper in mm, at these figures.
#[must_use]
pub fn smoothing_mm(impulses: &[Impulse]) -> f64 {
    smoothing_at_mm(impulses, SMOOTHED_ACCELERATION, CORNER_SPEED)
}

/// Corner rounding of a shaper in mm: at a corner of 90 degrees that is passed at `corner_speed`, or the shortening of
/// a turn by 180, the larger one (Klipper's measure).
#[must_use]
pub fn smoothing_at_mm(impulses: &[Impulse], acceleration: f64, corner_speed: f64) -> f64 {
    let middle: f64 = impulses.iter().map(|i| i.amount * i.time_s).sum();
    let half = acceleration / 2.0;
    let (mut corner, mut turn) = (0.0, 0.0);
    for Impulse { amount, time_s } in impulses {
        let late = time_s - middle;
        if late >= 0.0 {
            corner += amount * (corner_speed + half * late) * late;
        }
        turn += amount * half * late * late;
    }
    f64::max(corner * SQRT_2, turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 60 Hz and a damping of 0.05, from the literature: amounts, and times in ms.
    #[test]
    fn impulses_are_those_of_the_literature() {
        let known: [(ShaperKind, &[f64], &[f64]); 5] = [
            (ShaperKind::Zv, &[0.53924, 0.46076], &[0.0, 8.3438]),
            (ShaperKind::Zvd, &[0.29078, 0.49692, 0.21230], &[0.0, 8.3438, 16.6875]),
            (ShaperKind::Mzv, &[0.32822, 0.41253, 0.25925], &[0.0, 6.2578, 12.5157]),
            (ShaperKind::Ei, &[0.30688, 0.46746, 0.22566], &[0.0, 8.3788, 16.6875]),
            (ShaperKind::TwoHumpEi, &[0.20430, 0.35523, 0.30830, 0.13217], &[0.0, 8.4408, 16.7289, 24.9013]),
        ];
        for (kind, amounts, times) in known {
            let found = impulses(kind, 60.0, 0.05);
            assert_eq!(found.len(), amounts.len());
            for (impulse, (amount, ms)) in found.iter().zip(amounts.iter().zip(times)) {
                assert!((impulse.amount - amount).abs() <= 1e-5, "{kind:?}: {impulse:?}");
                assert!((impulse.time_s * 1e3 - ms).abs() <= 1e-4, "{kind:?}: {impulse:?}");
            }
        }
    }

    #[test]
    fn a_shaper_that_is_off_by_5_percent_leaves_as_much_as_is_known() {
        for (kind, known) in [(ShaperKind::Zv, 0.07643), (ShaperKind::Mzv, 0.04883), (ShaperKind::Ei, 0.04427)] {
            let left = residual(&impulses(kind, 66.0, 0.03933), 62.587, 0.03933);
            assert!((left / known - 1.0).abs() < 0.01, "{kind:?}: {left}");
        }
    }

    #[test]
    fn longer_shapers_round_more() {
        let smoothing = |kind| smoothing_mm(&impulses(kind, 60.0, 0.05));
        assert!(smoothing(ShaperKind::Zv) < smoothing(ShaperKind::Mzv));
        assert!(smoothing(ShaperKind::Mzv) < smoothing(ShaperKind::Ei));
        assert!(smoothing(ShaperKind::Ei) < smoothing(ShaperKind::TwoHumpEi));
    }
}
