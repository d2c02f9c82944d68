//! Labels: the axis of a sweep, or the speed and angle of a run, from a file's name.
//!
//! | name | written by |
//! |---|---|
//! | `raw_data_x_20260101_120000.csv`, `resonances_y.csv` | Klipper, `TEST_RESONANCES AXIS=X OUTPUT=raw_data` |
//! | `raw_data_axis=1.000,-1.000_a.csv` | Klipper, a diagonal |
//! | `belts_20240101_A.csv`, `axis_X.csv` | Shake&Tune; a belt is a path, A or B |
//! | `axesmap_20240101_X.csv` | Shake&Tune's calibration of the sensor's axes, short moves without a sweep |
//! | `vib_an45_00sp120_00n1.csv` | Shake&Tune's profile: 45 degrees, 120 mm/s |

use serde::Serialize;

/// Direction of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub enum Axis {
    /// To the right.
    X,
    /// To the back.
    Y,
    /// Up.
    Z,
    /// Belt path A: the diagonal (1, -1).
    A,
    /// Belt path B: the diagonal (1, 1).
    B,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::X, Self::Y, Self::Z, Self::A, Self::B];

    /// Its letter.
    #[must_use]
    pub const fn letter(self) -> char {
        match self {
            Self::X => 'X',
            Self::Y => 'Y',
            Self::Z => 'Z',
            Self::A => 'A',
            Self::B => 'B',
        }
    }

    /// The axis with this letter.
    #[must_use]
    pub fn of(text: &str) -> Option<Self> {
        let mut letters = text.chars();
        let letter = letters.next()?.to_ascii_uppercase();
        if letters.next().is_some() {
            return None;
        }
        Self::ALL.into_iter().find(|axis| axis.letter() == letter)
    }
}

/// Axis of the sweep that a file's name tells. A vector counts first, then the word that Klipper puts behind its own
/// name for the file. Then the last letter of an axis counts, and at last the last letter of a belt path. The end of
/// the name is the owner's.
#[must_use]
pub fn axis(name: &str) -> Option<Axis> {
    if let Some((_, vector)) = name.split_once("axis=") {
        let number = |part: &str| -> Option<f64> {
            part.chars().take_while(|c| c.is_ascii_digit() || "+-.".contains(*c)).collect::<String>().parse().ok()
        };
        let mut parts = vector.split(',').map(number);
        if let (Some(Some(x)), Some(Some(y))) = (parts.next(), parts.next()) {
            return match (x == 0.0, y == 0.0, x * y < 0.0) {
                (true, true, _) => Some(Axis::Z),
                (false, true, _) => Some(Axis::X),
                (true, false, _) => Some(Axis::Y),
                (false, false, true) => Some(Axis::A),
                (false, false, false) => Some(Axis::B),
            };
        }
    }
    let is_belt = words(name).any(|word| BELTS.iter().any(|belt| word.eq_ignore_ascii_case(belt)));
    let is_path = |axis: &Axis| matches!(axis, Axis::A | Axis::B);
    let of_path = || words(name).filter_map(Axis::of).rfind(is_path);
    if is_belt {
        return of_path();
    }
    let lower = stem(name).to_ascii_lowercase();
    let behind = KLIPPERS.iter().find_map(|begin| lower.strip_prefix(begin)).and_then(|rest| words(rest).next());
    let of_klipper = behind.and_then(Axis::of).filter(|axis| !is_path(axis));
    of_klipper.or_else(|| words(name).filter_map(Axis::of).rfind(|axis| !is_path(axis))).or_else(of_path)
}

/// Klipper's own names for files (`resonance_tester.py`, get_filename): the axis follows, then a sensor, a place and
/// the owner's name.
const KLIPPERS: [&str; 3] = ["raw_data_", "resonances_", "calibration_data_"];

/// Words for a belt path in names.
const BELTS: [&str; 2] = ["belt", "belts"];

/// Whether a name is of a calibration of the sensor's axes.
#[must_use]
pub fn is_axes_map(name: &str) -> bool {
    stem(name).to_ascii_lowercase().starts_with("axesmap")
}

/// The words of a name without folders.
fn words(name: &str) -> impl DoubleEndedIterator<Item = &str> {
    stem(name).split(|c: char| !c.is_ascii_alphanumeric())
}

/// Angle in degrees and speed in mm/s of a run that a file's name tells, as `an45_00sp120_00`.
#[must_use]
pub fn run(name: &str) -> Option<(f64, f64)> {
    let stem = stem(name);
    stem.match_indices("an").find_map(|(at, _)| {
        let (angle, rest) = number(stem.get(at + 2..)?)?;
        let (speed, _) = number(rest.trim_start_matches('_').strip_prefix("sp")?)?;
        Some((angle, speed))
    })
}

/// A number with a point or an underscore before its decimals, and the text after it.
fn number(text: &str) -> Option<(f64, &str)> {
    let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let (whole, rest) = text.split_at(digits(text));
    let decimals = rest.strip_prefix(['.', '_']).map(|decimals| decimals.split_at(digits(decimals)));
    let (decimals, rest) = match decimals {
        Some((decimals, after)) if !decimals.is_empty() => (decimals, after),
        _ => ("0", rest),
    };
    Some((format!("{whole}.{decimals}").parse().ok().filter(|_| !whole.is_empty())?, rest))
}

/// The name without folders and its last ending.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_klipper_and_shake_and_tune_tell_the_axis() {
        for (name, known) in [
            ("raw_data_x_20260101_120000.csv", Some(Axis::X)),
            ("/tmp/x/raw_data_y.csv", Some(Axis::Y)),
            ("raw_data_axis=1.000,-1.000_b.csv", Some(Axis::A)),
            ("raw_data_axis=1.000,1.000_a.csv", Some(Axis::B)),
            ("raw_data_axis=0.000,1.000_1.csv", Some(Axis::Y)),
            // The owner's name is the last word.
            ("raw_data_x_a.csv", Some(Axis::X)),
            ("raw_data_x_b.csv", Some(Axis::X)),
            ("raw_data_x_y.csv", Some(Axis::X)),
            ("resonances_y_lis2dw_x.csv", Some(Axis::Y)),
            ("calibration_data_x_20260101_b.csv", Some(Axis::X)),
            ("x_b.csv", Some(Axis::X)),
            ("sweep_b.csv", Some(Axis::B)),
            ("belts_20240101_B.csv", Some(Axis::B)),
            ("belt_b.stdata", Some(Axis::B)),
            ("belt_X.csv", None),
            ("belts_20240101_y.csv", None),
            ("belt_z.csv", None),
            ("x.csv", Some(Axis::X)),
            ("sweep.csv", None),
            ("matrix.csv", None),
        ] {
            assert_eq!(axis(name), known, "{name}");
        }
    }

    #[test]
    fn a_calibration_of_the_sensor_is_no_sweep() {
        assert!(is_axes_map("axesmap_20240101_X.csv") && is_axes_map("/tmp/AxesMap_x"));
        assert!(!is_axes_map("axes_X.csv") && !is_axes_map("/tmp/axesmap/raw_data_x.csv"));
    }

    #[test]
    fn names_of_runs_tell_angle_and_speed() {
        assert_eq!(run("vib_an45_00sp120_50n1_20240101.csv"), Some((45.0, 120.5)));
        assert_eq!(run("runs/an135sp80.csv"), Some((135.0, 80.0)));
        assert_eq!(run("an90_sp80.5.csv"), Some((90.0, 80.5)));
        assert_eq!(run("raw_data_x.csv"), None);
        assert_eq!(run("titan_an.csv"), None);
    }
}
