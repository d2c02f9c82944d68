//! Thermistors of a machine file: the name of a sensor, or an NTC by three points of its data sheet, or by its numbers.

use crate::error::MachineFileError;
use crate::numbers::{float, float_toml, number};
use corehbot::settings::rows::{Legal, ValueKind};
use corehbot::settings::{Thermistor, ranges};
use corehbot_twin::math::{exp, ln};
use toml::{Table, Value as Toml};

/// The key of the points.
pub(crate) const POINTS: &str = "points";
/// The keys of the numbers: resistance at 25 C, B, and C if it has one.
pub(crate) const NUMBERS: [&str; 3] = ["ohms", "beta", "cubic"];

/// 0 C in K, and 1/T of 25 C.
const ZERO: f64 = 273.15;
const AT_25: f64 = 1.0 / (ZERO + 25.0);

/// A unit of C, in 1/K, and of Ohm with C.
const CUBIC: f64 = 1e-9;
const OHMS: f64 = 8.0;

/// The thermistor that a file says.
///
/// # Errors
/// The problem of the value.
pub(crate) fn read(key: &str, toml: &Toml) -> Result<Thermistor, MachineFileError> {
    let wrong = || MachineFileError::Thermistor(key.to_owned());
    match toml {
        Toml::String(word) => Thermistor::named(word).ok_or_else(wrong),
        Toml::Table(table) => match table.get(POINTS) {
            Some(Toml::Array(points)) if table.len() == 1 => {
                let points = points.iter().map(|point| pair(key, point)).collect::<Result<Vec<_>, _>>()?;
                through(&points).ok_or_else(wrong)
            }
            _ => of_numbers(key, table),
        },
        _ => Err(wrong()),
    }
}

/// Temperature in C and resistance in Ohm.
fn pair(key: &str, toml: &Toml) -> Result<(f64, f64), MachineFileError> {
    match toml.as_array().map(Vec::as_slice) {
        Some([celsius, ohms]) => Ok((float(key, celsius)?, float(key, ohms)?)),
        _ => Err(MachineFileError::Thermistor(key.to_owned())),
    }
}

fn of_numbers(key: &str, table: &Table) -> Result<Thermistor, MachineFileError> {
    let wrong = || MachineFileError::Thermistor(key.to_owned());
    if !table.keys().all(|name| NUMBERS.contains(&name.as_str())) {
        return Err(wrong());
    }
    let of = |name: &str, legal: Legal| {
        let value = table.get(name).ok_or_else(wrong)?;
        number(&format!("{key}.{name}"), value, ValueKind::Whole, legal)
    };
    let [ohms, beta, cubic] = NUMBERS;
    let (ohms, beta) = (of(ohms, ranges::OHMS.spec().legal)? as u32, of(beta, ranges::BETA.spec().legal)? as u16);
    let cubic = if table.contains_key(cubic) { of(cubic, cubic_legal())? as u16 } else { 0 };
    Ok(Thermistor::Beta { ohms, beta, cubic })
}

/// All numbers of its word.
pub(crate) fn cubic_legal() -> Legal {
    Legal { least: 0, most: Thermistor::MOST_CUBIC.into(), ..ranges::BETA.spec().legal }
}

/// The NTC with these numbers, as a file has it.
pub(crate) fn written(ohms: u32, beta: u16, cubic: u16) -> Toml {
    let numbers = [i64::from(ohms), beta.into(), cubic.into()];
    let is_there = |(_, number): &(&str, i64)| *number != 0;
    let pairs = NUMBERS.into_iter().zip(numbers).filter(is_there);
    Toml::Table(pairs.map(|(key, number)| (key.to_owned(), number.into())).collect())
}

/// Three points, as a file has them.
pub(crate) fn points(points: [(f64, f64); 3]) -> Toml {
    let pair = |(celsius, ohms): (f64, f64)| Toml::Array(vec![float_toml(celsius), float_toml(ohms)]);
    let points = Toml::Array(points.map(pair).to_vec());
    Toml::Table([(POINTS.to_owned(), points)].into_iter().collect())
}

/// The NTC through three points, by the equation of Steinhart and Hart. With points that bend the other way it has no
/// C, and B is the slope from the first to the last, as in Klipper (`thermistor.py`, setup_coefficients).
pub(crate) fn through(points: &[(f64, f64)]) -> Option<Thermistor> {
    let mut points: [(f64, f64); 3] = points.try_into().ok()?;
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let is_legal = |(celsius, ohms): &(f64, f64)| (-ZERO + 1.0..1e4).contains(celsius) && (1e-3..1e9).contains(ohms);
    let falls = points[0].1 > points[1].1 && points[1].1 > points[2].1;
    let is_apart = points[0].0 < points[1].0 && points[1].0 < points[2].0;
    if !(points.iter().all(is_legal) && falls && is_apart) {
        return None;
    }
    let [(y0, x0), (y1, x1), (y2, x2)] = points.map(|(celsius, ohms)| (1.0 / (celsius + ZERO), ln(ohms)));
    // Slopes of two chords, and the slope of the slopes.
    let (first, second) = ((y1 - y0) / (x1 - x0), (y2 - y0) / (x2 - x0));
    let c = (second - first) / ((x2 - x1) * (x0 + x1 + x2));
    if !c.is_finite() || c <= 0.0 {
        return of_slope(points[0], second);
    }
    // C is stored rounded, so B and the place follow from the outer points with the stored C.
    let stored = (c / CUBIC).round() * CUBIC;
    let b = (y2 - y0 - stored * (x2 * x2 * x2 - x0 * x0 * x0)) / (x2 - x0);
    let a = y0 - b * x0 - stored * x0 * x0 * x0;
    // The logarithm at 25 C, by Newton's steps.
    let mut log = x0;
    for _ in 0..STEPS {
        log -= (a + b * log + stored * log * log * log - AT_25) / (b + 3.0 * stored * log * log);
    }
    numbers((exp(log) / OHMS).round() * OHMS, 1.0 / b, stored / CUBIC)
}

/// Steps of Newton from one of the points: each doubles the digits that are right.
const STEPS: usize = 20;

/// The NTC through a point, with a slope of 1/T over ln R.
pub(crate) fn of_slope((celsius, ohms): (f64, f64), slope: f64) -> Option<Thermistor> {
    numbers(ohms * exp((AT_25 - 1.0 / (celsius + ZERO)) / slope), 1.0 / slope, 0.0)
}

/// Numbers in their ranges.
fn numbers(ohms: f64, beta: f64, cubic: f64) -> Option<Thermistor> {
    let whole = |number: f64, legal: Legal| {
        let number = number.round();
        (number.is_finite() && legal.holds(number as i64)).then_some(number as i64)
    };
    Some(Thermistor::Beta {
        ohms: whole(ohms, ranges::OHMS.spec().legal)? as u32,
        beta: whole(beta, ranges::BETA.spec().legal)? as u16,
        cubic: whole(cubic, cubic_legal())? as u16,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Klipper's own curve through three points, as its code computes it (`thermistor.py`, setup_coefficients): linear
    /// equations for c3, c2 and c1. The resistance at a temperature is found by halving.
    fn ohms_of_klipper(points: [(f64, f64); 3], celsius: f64) -> f64 {
        let [(i1, l1), (i2, l2), (i3, l3)] = points.map(|(celsius, ohms)| (1.0 / (celsius + 273.15), ln(ohms)));
        let cube = |log: f64| log * log * log;
        let (i12, i13, l12, l13) = (i1 - i2, i1 - i3, l1 - l2, l1 - l3);
        let c3 = (i12 - i13 * l12 / l13) / ((cube(l1) - cube(l2)) - (cube(l1) - cube(l3)) * l12 / l13);
        let c2 = (i12 - c3 * (cube(l1) - cube(l2))) / l12;
        let c1 = i1 - c2 * l1 - c3 * cube(l1);
        let (mut low, mut high) = (0.0, 20.0);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            let is_above = c1 + c2 * middle + c3 * cube(middle) > 1.0 / (celsius + 273.15);
            (low, high) = if is_above { (low, middle) } else { (middle, high) };
        }
        exp(low)
    }

    /// The temperature that the firmware shows for a resistance; the converter has steps of a thousandth of its own
    /// there, which do not count.
    fn shown(thermistor: Thermistor, ohms: f64) -> f64 {
        let Thermistor::Beta { ohms: at_25, beta, cubic } = thermistor else { panic!("{thermistor:?}") };
        let (log, log_25) = (ln(ohms), ln(f64::from(at_25)));
        let bend = f64::from(cubic) * 1e-9 * (log * log * log - log_25 * log_25 * log_25);
        1.0 / (1.0 / 298.15 + (log - log_25) / f64::from(beta) + bend) - 273.15
    }

    /// Data sheets of Klipper's list, and three of none.
    #[test]
    fn three_points_are_the_curve_that_klipper_computes() {
        for points in [
            [(25.0, 100_000.0), (150.0, 1641.9), (250.0, 226.15)],
            [(25.0, 100_000.0), (50.0, 31_230.0), (125.0, 2066.0)],
            [(25.0, 100_000.0), (150.0, 1770.0), (250.0, 230.0)],
            [(25.0, 500_000.0), (200.0, 3734.0), (400.0, 240.0)],
            [(20.0, 126_800.0), (150.0, 1360.0), (300.0, 80.65)],
            [(25.0, 100_000.0), (160.0, 1074.0), (300.0, 82.78)],
            [(25.0, 100_000.0), (90.0, 8700.0), (150.0, 1770.0)],
            [(25.0, 10_000.0), (100.0, 680.0), (200.0, 70.0)],
            [(20.0, 250_000.0), (120.0, 6500.0), (260.0, 350.0)],
        ] {
            let found = through(&points).unwrap();
            for celsius in 20..=300 {
                let celsius = f64::from(celsius);
                let told = shown(found, ohms_of_klipper(points, celsius));
                assert!((told - celsius).abs() < 0.3, "{points:?}: {told} at {celsius}");
            }
        }
    }

    #[test]
    fn points_that_are_no_sensor_are_refused_and_others_are_stored_as_they_are_read() {
        for points in [
            &[(25.0, 1e5), (150.0, 1641.9)][..],
            &[(25.0, 1e5), (25.0, 1e5), (250.0, 226.15)],
            &[(25.0, 1e5), (150.0, -1.0), (250.0, 226.15)],
            &[(25.0, 1e5), (150.0, 2e5), (250.0, 4e5)],
            &[(25.0, f64::NAN), (150.0, 2e3), (250.0, 4e2)],
            &[(25.0, 5.0), (150.0, 0.08), (250.0, 0.01)],
        ] {
            assert_eq!(through(points), None, "{points:?}");
        }
        use corehbot::settings::rows::Field;
        let found = through(&[(250.0, 226.15), (25.0, 1e5), (150.0, 1641.9)]).unwrap();
        let mut read = Thermistor::PT1000;
        assert!(read.set(&found.get()) && read == found, "{found:?} {read:?}");
        // Points that bend the other way: B of the outer ones.
        let flat = through(&[(25.0, 100_000.0), (150.0, 1590.0), (250.0, 250.0)]).unwrap();
        assert!(matches!(flat, Thermistor::Beta { cubic: 0, .. }), "{flat:?}");
        // Klipper sorts an owner's points before it takes B of the first and the last (`CustomThermistor`).
        let mixed = [(150.0, 1590.0), (250.0, 250.0), (25.0, 100_000.0)];
        assert_eq!(through(&mixed), Some(flat));
        let beta = ln(100_000.0 / 250.0) / (1.0 / 298.15 - 1.0 / 523.15);
        let Thermistor::Beta { beta: found, .. } = flat else { panic!("{flat:?}") };
        assert!((f64::from(found) - beta).abs() < 1.0, "{found} {beta}");
    }
}
