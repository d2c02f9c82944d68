//! Model: the power of a band of frequencies by the modes, and its derivatives by their numbers.

use nalgebra::{DMatrix, DVector};
use realfft::num_complex::Complex;

/// A frequency within a band, and the power that was commanded there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub hz: f64,
    pub power: f64,
}

/// A band of frequencies of the fit.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Its middle.
    pub hz: f64,
    /// What was commanded. A sharp mode is narrower than a band, so the model is summed over these.
    pub lines: Vec<Line>,
    /// Logarithm of the measured power.
    pub measured: f64,
    /// The source that shakes here, from 0 on.
    pub source: usize,
    /// How much the point counts, of 1: little where it is the sensor's noise.
    pub weight: f64,
}

impl Point {
    pub fn commanded(&self) -> f64 {
        self.lines.iter().map(|line| line.power).sum()
    }
}

/// The points and the sensor's noise.
pub(super) struct Data {
    pub points: Vec<Point>,
    pub noise: f64,
    /// Sources of unknown strength; 0 if the strength is known.
    pub sources: usize,
}

/// Three numbers a mode, the logarithms of frequency and damping, and the gain; then the share of the belt's damping.
pub(super) type Numbers = DVector<f64>;

/// The numbers of the modes.
pub(super) fn modes(numbers: &Numbers) -> impl Iterator<Item = [f64; 3]> {
    numbers.as_slice().chunks_exact(3).map(|mode| [mode[0], mode[1], mode[2]])
}

/// The share; 0 without modes.
pub(super) fn share(numbers: &Numbers) -> f64 {
    numbers.as_slice().chunks_exact(3).remainder().first().copied().unwrap_or(0.0)
}

/// What a mode adds to the response at a frequency, and the derivatives of this by its numbers and the share.
fn mode_at([frequency, damping, gain]: [f64; 3], share: f64, hz: f64) -> [Complex<f64>; 5] {
    let r = hz * (-frequency).exp();
    let b = 2.0 * damping.exp() * r;
    let below = Complex::new(1.0 - r * r, b).inv();
    let unit = Complex::new(1.0, b * share) * below;
    let turned = Complex::new(0.0, b);
    [
        unit * gain,
        (-turned * share - unit * (Complex::from(2.0 * r * r) - turned)) * below * gain,
        turned * (Complex::from(share) - unit) * below * gain,
        unit,
        turned * below * gain,
    ]
}

/// |H|^2. Without modes the tool follows its command.
pub(super) fn response(numbers: &Numbers, hz: f64, sources: usize) -> f64 {
    if numbers.is_empty() {
        return 1.0;
    }
    let share = share(numbers);
    let all = modes(numbers).map(|mode| mode_at(mode, share, hz)[0]);
    if sources == 0 { all.sum::<Complex<f64>>().norm_sqr() } else { all.map(|one| one.norm_sqr()).sum() }
}

/// Adds the power of a line and its derivatives to those of its band.
fn add_line(numbers: &Numbers, line: Line, sources: usize, power: &mut f64, slopes: &mut [f64]) {
    let (share, end) = (share(numbers), slopes.len().saturating_sub(1));
    let all: Vec<[Complex<f64>; 5]> = modes(numbers).map(|mode| mode_at(mode, share, line.hz)).collect();
    let whole: Complex<f64> = all.iter().map(|one| one[0]).sum();
    for (i, one) in all.iter().enumerate() {
        // Modes of several sources add up by power, because those along different axes do.
        let own = if sources == 0 { whole } else { one[0] };
        let slope = |by: Complex<f64>| 2.0 * line.power * (own.conj() * by).re;
        for (k, by) in one[1..4].iter().enumerate() {
            slopes[3 * i + k] += slope(*by);
        }
        if sources == 0 {
            slopes[end] += slope(one[4]);
        } else {
            *power += line.power * own.norm_sqr();
        }
    }
    if sources == 0 {
        *power += line.power * whole.norm_sqr();
    }
}

/// Differences of logarithms, weighted.
pub(super) fn differences(numbers: &Numbers, data: &Data) -> DVector<f64> {
    let of = |point: &Point| {
        let lines = point.lines.iter().map(|line| line.power * response(numbers, line.hz, data.sources));
        ((lines.sum::<f64>() + data.noise).max(f64::MIN_POSITIVE).ln() - point.measured) * point.weight
    };
    let mut all = DVector::from_iterator(data.points.len(), data.points.iter().map(of));
    let slope = |values: &mut [f64]| centred(values, data);
    slope(all.as_mut_slice());
    all
}

/// Differences, and their derivatives by each number.
pub(super) fn with_slopes(numbers: &Numbers, data: &Data) -> (DVector<f64>, DMatrix<f64>) {
    let (rows, columns) = (data.points.len(), numbers.len());
    let (mut all, mut matrix) = (DVector::zeros(rows), DMatrix::zeros(rows, columns));
    let mut slopes = vec![0.0; columns];
    for (row, point) in data.points.iter().enumerate() {
        slopes.fill(0.0);
        let mut power = 0.0;
        point.lines.iter().for_each(|line| add_line(numbers, *line, data.sources, &mut power, &mut slopes));
        let power = (power + data.noise).max(f64::MIN_POSITIVE);
        all[row] = (power.ln() - point.measured) * point.weight;
        for (column, slope) in slopes.iter().enumerate() {
            matrix[(row, column)] = slope / power * point.weight;
        }
    }
    centred(all.as_mut_slice(), data);
    for column in 0..columns {
        centred(matrix.column_mut(column).as_mut_slice(), data);
    }
    (all, matrix)
}

/// Takes the mean of each source of unknown strength away (variable projection: G. Golub and V. Pereyra, SIAM J. Numer.
/// Anal. 10, 1973).
fn centred(values: &mut [f64], data: &Data) {
    for source in 0..data.sources {
        let own = || data.points.iter().enumerate().filter(move |(_, p)| p.source == source).map(|(i, _)| i);
        let mean = own().map(|i| values[i]).sum::<f64>() / own().count().max(1) as f64;
        own().for_each(|i| values[i] -= mean);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_differences() {
        let line = |hz: f64| Line { hz, power: 2.0 };
        let point = |i: u32| {
            let hz = 20.0 + 3.0 * f64::from(i);
            let lines = vec![line(hz), line(hz + 1.0)];
            Point { hz, lines, measured: 0.3, source: i as usize % 2, weight: 0.7 }
        };
        for sources in [0, 2] {
            let data = Data { points: (0..30).map(point).collect(), noise: 0.01, sources };
            let numbers = DVector::from_vec(vec![40.0_f64.ln(), -2.5, 0.6, 70.0_f64.ln(), -3.0, -0.4, 0.3]);
            let (_, slopes) = with_slopes(&numbers, &data);
            // The share counts for one source alone.
            for column in 0..if sources == 0 { 7 } else { 6 } {
                let moved = |by: f64| {
                    let mut other = numbers.clone();
                    other[column] += by;
                    differences(&other, &data)
                };
                let known = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                assert!((slopes.column(column) - known).norm() < 1e-6, "{sources} {column}");
            }
        }
    }
}
