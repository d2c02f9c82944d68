//! Fit: frequency of a CoreH-bot's axis over its place, from measured frequencies.
//!
//! Away from the middle an axis rings faster, because belts get stiffer, but motors do not. The firmware uses this law
//! (docs/explanation/shaping.md), and the fit finds its numbers:
//!
//! ```text
//! 1/f^2 = a (1 - (2 d / L)^2) + b,    a = 1/f_belt^2,  b = 1/f_motor^2
//! ```
//!
//! d is the distance from the middle of the axis and L the free length of its belts, both sides together. The law is
//! linear in a and b: least squares over all places. It describes springs in series, which belts and motors are only in
//! the middle. Elsewhere motor fields deflect more. So the fitted f_motor is below the frequency of the motors alone;
//! [`crate::solve::identify`] finds belts and motors.

use crate::math::{powf, square};
use crate::params::Params;
use serde::Serialize;

/// A measured frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The tool's place along the axis, from motor 1's axis.
    pub place_mm: f64,
    /// The measured frequency of the axis.
    pub frequency_hz: f64,
}

/// An axis of a CoreH-bot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// To the right.
    X,
    /// Away from the front.
    Y,
}

/// Result of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// Frequency in the middle of the axis.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// The same with rigid motors.
    #[serde(rename = "belt_frequency_Hz")]
    pub belt_frequency_hz: f64,
    /// With rigid belts; none for rigid motors.
    #[serde(rename = "motor_frequency_Hz")]
    pub motor_frequency_hz: Option<f64>,
    /// Free length of the belts, both sides together.
    pub span_mm: f64,
    /// Largest relative difference between measurement and fit, of 1.
    pub worst_difference: f64,
}

/// Places with less difference in `(2 d / L)^2` than this do not separate belts from motors.
const LEAST_SPREAD: f64 = 0.05;

/// Largest accepted difference of the law from a frequency: three times the uncertainty of a frequency
/// (docs/research/twin.md).
const LIKE: f64 = 0.045;

/// Why there is no fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitError {
    /// Fewer than two places, or too close to each other.
    TooAlike,
    /// It rings no faster away from the middle.
    NotStiffer,
    /// The frequency at this place differs by this part, of 1, from every law.
    Unlike(f64, f64),
}

impl std::fmt::Display for FitError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooAlike => f.write_str("expected two places, one near the middle of the axis and one near its end"),
            Self::NotStiffer => {
                f.write_str("it rings no faster away from the middle, so belts cannot be what gives way")
            }
            Self::Unlike(place_mm, part) => {
                write!(f, "the frequency at {place_mm:.1} mm is {:.0} % from any law of belts; ", 100.0 * part)?;
                f.write_str("measure it again, by the slowest strong peak")
            }
        }
    }
}

impl std::error::Error for FitError {}

/// Belts and motors of an axis.
///
/// # Errors
/// Too little was measured, or belts do not explain it.
pub fn fit(axis: Axis, measured: &[Measured], params: &Params) -> Result<Fit, FitError> {
    let p = params;
    let (length, distance) = match axis {
        Axis::X => (p.width_mm, p.head_pulleys_mm),
        Axis::Y => (p.depth_mm, p.bar_pulleys_mm),
    };
    let span_mm = p.width_mm + p.depth_mm - 4.0 * p.pulley_radius_mm - distance;
    let softer = |place: f64| 1.0 - square(2.0 * (place - length / 2.0) / span_mm);
    let points: Vec<(f64, f64)> = measured.iter().map(|m| (softer(m.place_mm), 1.0 / square(m.frequency_hz))).collect();
    let (mut a, mut b) = line(&points).ok_or(FitError::TooAlike)?;
    if a <= 0.0 {
        return Err(FitError::NotStiffer);
    }
    if b < 0.0 {
        // Motor compliance cannot be negative: the line goes through 0.
        let (over, under) = points.iter().fold((0.0, 0.0), |(o, u), (x, y)| (o + x * y, u + x * x));
        (a, b) = (over / under, 0.0);
    }
    let says = |place: f64| powf(a * softer(place) + b, -0.5);
    let difference = |m: &Measured| (says(m.place_mm) / m.frequency_hz - 1.0).abs();
    let worst = measured.iter().max_by(|a, b| difference(a).total_cmp(&difference(b)));
    let worst_difference = worst.map_or(0.0, difference);
    if let Some(worst) = worst.filter(|_| worst_difference > LIKE) {
        return Err(FitError::Unlike(worst.place_mm, worst_difference));
    }
    Ok(Fit {
        frequency_hz: powf(a + b, -0.5),
        belt_frequency_hz: powf(a, -0.5),
        motor_frequency_hz: (b > 0.0).then(|| powf(b, -0.5)),
        span_mm,
        worst_difference,
    })
}

/// Slope and intercept of the least-squares line.
fn line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    let least = points.iter().map(|(x, _)| *x).fold(f64::INFINITY, f64::min);
    let greatest = points.iter().map(|(x, _)| *x).fold(f64::NEG_INFINITY, f64::max);
    if points.len() < 2 || greatest - least < LEAST_SPREAD {
        return None;
    }
    let (mean_x, mean_y) = points.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / count, sy + y / count));
    let (over, under) =
        points.iter().fold((0.0, 0.0), |(o, u), (x, y)| (o + (x - mean_x) * (y - mean_y), u + square(x - mean_x)));
    let slope = over / under;
    Some((slope, mean_y - slope * mean_x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::elastic::Freedom;
    use crate::queries::Setup;
    use crate::queries::modes::Modes;
    use crate::routing::Machine;

    /// Frequencies of the model with its own parameters, as if they were measured.
    fn measure(freedom: Freedom, params: &Params, places: &[[f64; 2]]) -> [Vec<Measured>; 2] {
        let modes = places.iter().map(|[x, y]| {
            let setup = Setup { params: params.clone(), freedom, ..Setup::nominal(Machine::CoreHBot, *x, *y) };
            (*x, *y, Modes::new(&setup).unwrap())
        });
        let modes: Vec<(f64, f64, Modes)> = modes.collect();
        let of = |axis: usize| {
            let one = |(x, y, modes): &(f64, f64, Modes)| Measured {
                place_mm: [*x, *y][axis],
                frequency_hz: modes.frequencies_hz[1 - axis],
            };
            modes.iter().map(one).collect()
        };
        [of(0), of(1)]
    }

    #[test]
    fn with_motors_that_hold_the_law_is_exact() {
        let [x, y] = measure(Freedom::default(), &Params::default(), &[[235.0, 235.0], [60.0, 50.0], [130.0, 150.0]]);
        for (axis, measured, middle) in [(Axis::X, x, 110.182), (Axis::Y, y, 62.587)] {
            let found = fit(axis, &measured, &Params::default()).unwrap();
            assert!((found.frequency_hz / middle - 1.0).abs() < 1e-4, "{found:?}");
            assert!(found.motor_frequency_hz.is_none_or(|hz| hz > 1e4) && found.worst_difference < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn with_motors_that_give_way_the_law_is_within_a_thousandth_all_along() {
        let rotors = Freedom { idlers: true, rotors: true, ..Freedom::default() };
        let places = [[235.0, 235.0], [50.0, 40.0], [100.0, 90.0], [150.0, 140.0], [200.0, 190.0]];
        let [x, _] = measure(rotors, &Params::default(), &places.map(|[x, _]| [x, 235.0]));
        let [_, y] = measure(rotors, &Params::default(), &places.map(|[_, y]| [235.0, y]));
        for (axis, measured, alone_hz) in [(Axis::X, x, 289.0), (Axis::Y, y, 167.0)] {
            let found = fit(axis, &measured[..2], &Params::default()).unwrap();
            let all = fit(axis, &measured, &Params::default()).unwrap();
            assert!((found.frequency_hz / all.frequency_hz - 1.0).abs() < 1e-3, "{found:?} {all:?}");
            assert!(all.worst_difference < 1e-3, "{all:?}");
            assert!(all.motor_frequency_hz.is_some_and(|hz| hz < alone_hz), "{all:?}");
        }
    }

    #[test]
    fn too_little_is_told() {
        let at = |place_mm, frequency_hz| Measured { place_mm, frequency_hz };
        let params = Params::default();
        assert_eq!(fit(Axis::X, &[at(235.0, 100.0)], &params), Err(FitError::TooAlike));
        assert_eq!(fit(Axis::X, &[at(235.0, 100.0), at(240.0, 101.0)], &params), Err(FitError::TooAlike));
        assert_eq!(fit(Axis::X, &[at(235.0, 100.0), at(60.0, 99.0)], &params), Err(FitError::NotStiffer));
        // Stiffer, but by more than belts with rigid motors.
        assert!(matches!(fit(Axis::X, &[at(235.0, 100.0), at(60.0, 150.0)], &params), Err(FitError::Unlike(..))));
    }
}
