//! G-code of a sweep, for a machine without a firmware that makes one.
//!
//! A half period is one move from rest to rest, `d = a / (16 f^2)` long. With the acceleration a it lasts half a
//! period, and the next one goes back. So every firmware with a limit of acceleration can shake its machine. The slow
//! swing of Klipper's sweep is left out, for moves begin and end at rest.

use crate::label::Axis;
use crate::sweep::Sweep;
use std::f64::consts::FRAC_1_SQRT_2;

/// The acceleration is set again when it has changed by this part; the frequency is then off by half of it.
const AGAIN: f64 = 0.01;

/// Speed words are this much above the fastest move, so that they do not limit it.
const ABOVE: f64 = 2.0;

/// Speed of the way to the middle, in mm/s.
const WAY_MM_S: f64 = 50.0;

/// Rest before and after the sweep, in ms.
const REST_MS: u32 = 500;

/// The direction of an axis in the bed plane.
#[must_use]
pub const fn direction(axis: Axis) -> Option<[f64; 2]> {
    match axis {
        Axis::X => Some([1.0, 0.0]),
        Axis::Y => Some([0.0, 1.0]),
        Axis::A => Some([FRAC_1_SQRT_2, -FRAC_1_SQRT_2]),
        Axis::B => Some([FRAC_1_SQRT_2, FRAC_1_SQRT_2]),
        Axis::Z => None,
    }
}

/// Greatest acceleration of a sweep in mm/s^2, without its swing.
#[must_use]
pub fn greatest_acceleration(sweep: &Sweep) -> f64 {
    sweep.halves().map(|half| half.accel).fold(0.0, f64::max)
}

/// How far the tool goes from the middle, in mm.
#[must_use]
pub fn reach_mm(sweep: &Sweep) -> f64 {
    sweep.accel_per_hz / (16.0 * sweep.from_hz)
}

/// The lines of a sweep around this place.
#[must_use]
pub fn lines(sweep: &Sweep, axis: Axis, [x, y]: [f64; 2]) -> Vec<String> {
    let Some([along_x, along_y]) = direction(axis) else { return Vec::new() };
    let speed = ABOVE * sweep.accel_per_hz / 4.0;
    let word = |letter: char, middle: f64, along: f64, off: f64| match along {
        0.0 => String::new(),
        _ => format!(" {letter}{:.4}", middle + along * off),
    };
    let mut lines = vec![
        format!("; sweep of {} from {} to {} Hz, {:.0} s", axis.letter(), sweep.from_hz, sweep.to_hz, sweep.lasts_s()),
        "; home first; load your settings again after it (M501)".to_owned(),
        // A cruise in each move would make it 6 % longer; firmwares that do not know the line have none.
        "SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO=0".to_owned(),
        "M593 X F0".to_owned(),
        "M593 Y F0".to_owned(),
        "G90".to_owned(),
        format!("G1 X{x:.3} Y{y:.3} F{:.0}", 60.0 * WAY_MM_S),
        format!("G4 P{REST_MS}"),
        format!("G1 F{:.0}", 60.0 * speed),
    ];
    let (mut set, mut off) = (None, 0.0);
    for half in sweep.halves() {
        if !set.is_some_and(|set: f64| (half.accel / set - 1.0).abs() < AGAIN) {
            lines.push(format!("M204 P{0:.0} T{0:.0}", half.accel));
            set = Some(half.accel);
        }
        off += half.sign * half.length_mm();
        lines.push(format!("G1{}{}", word('X', x, along_x, off), word('Y', y, along_y, off)));
    }
    lines.extend([format!("G1 X{x:.3} Y{y:.3}"), format!("G4 P{REST_MS}"), "M400".to_owned()]);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_period_is_a_move_that_lasts_it() {
        let sweep = Sweep { from_hz: 10.0, to_hz: 50.0, accel_per_hz: 34.0, resolution_mm: 0.0125, ..Sweep::default() };
        let (mut acceleration, mut x, mut seconds) = (0.0, 100.0, 0.0);
        for line in lines(&sweep, Axis::X, [100.0, 80.0]).iter().skip(9) {
            let number = |letter: char| {
                line.split_once(letter).and_then(|(_, rest)| rest.split(' ').next()?.parse::<f64>().ok())
            };
            if line.starts_with("M204") {
                acceleration = number('P').unwrap();
            } else if let (Some(to), None) = (number('X'), number('Y')) {
                // Up to half way and down again, as a firmware does it.
                seconds += 2.0 * ((to - x).abs() / acceleration).sqrt();
                assert!((to - 100.0).abs() <= reach_mm(&sweep) + 1e-4, "{line}");
                x = to;
            }
        }
        assert!((seconds / sweep.lasts_s() - 1.0).abs() < 0.005, "{seconds} {}", sweep.lasts_s());
        assert!(
            acceleration <= greatest_acceleration(&sweep) + 1.0 && acceleration > 0.7 * greatest_acceleration(&sweep)
        );
    }

    #[test]
    fn diagonals_move_both_axes_and_z_is_not_swept() {
        let sweep = Sweep::default();
        assert!(lines(&sweep, Axis::Z, [0.0, 0.0]).is_empty());
        let a = lines(&sweep, Axis::A, [100.0, 100.0]);
        let first = a.iter().find(|line| line.starts_with("G1 X100.") && line.contains("Y99.")).unwrap();
        assert_eq!(first, "G1 X100.5303 Y99.4697");
    }
}
