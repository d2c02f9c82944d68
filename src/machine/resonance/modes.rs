//! Modes: frequency and damping of the peaks of a response.
//!
//! Near a peak a mode has, with u for the square of the frequency over its own,
//!
//! ```text
//! 1 / abs(H)^2 = (1 - u)^2 + 4 z^2 u        so abs(H)^2 (a + b u + c u^2) = 1 + d (u - 1)
//! ```
//!
//! with d for the other modes, which bend it a little there. That is linear in a, b, c and d: the least squares of its
//! difference, relative to the response, need neither logarithms nor a search. The window widens every peak: in the
//! square of the damping, by a third of the square of its frequency step (the variance of Hann's window).

use super::response::{FREQUENCIES, Response};
use crate::motion::root;
use core::ops::RangeInclusive;
use heapless::Vec;

/// A mode of the tool.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Mode {
    /// Hundredths of a Hz.
    pub centihertz: u32,
    /// Thousandths of critical damping.
    pub damping: u16,
    /// Thousandths by which the response differs from the mode's (root mean square).
    pub fit_error: u16,
}

/// Most modes.
pub(super) const MOST: usize = 2;

/// The fit takes a peak down to this part of its response.
const FOOT: f32 = 1.0 / 16.0;

/// It ends in a valley, where the response rises by this factor again.
const RISE: f32 = 1.5;

/// A peak is this much higher than its surroundings: 1 is a rigid machine.
const LEAST: f32 = 2.0;

/// A further peak has this part of the highest at least.
const LEAST_PART: f32 = 1.0 / 60.0;

/// Ends of a sweep that do not count.
const MARGIN_HZ: f32 = 3.0;

/// Frequencies that a fit needs.
const FEWEST: usize = 6;

/// The numbers of frequencies that a sweep from and to these frequencies has shaken evenly: near its ends there are
/// other harmonics.
pub(super) fn shaken(step: f32, [from, to]: [f32; 2]) -> RangeInclusive<usize> {
    let number = |hz: f32| ((hz / step) as usize).min(FREQUENCIES - 1);
    number(from + MARGIN_HZ) + 1..=number(to - MARGIN_HZ)
}

/// The modes of a response, the highest peak first.
pub(super) fn modes(response: &Response, step: f32, ends: &RangeInclusive<usize>) -> Vec<Mode, MOST> {
    let mut found = Vec::new();
    let mut taken: Vec<RangeInclusive<usize>, MOST> = Vec::new();
    let mut highest = 0.0;
    for _ in 0..MOST {
        let mut best: Option<(usize, f32)> = None;
        for number in *ends.start()..=*ends.end() {
            let height = response.at(number);
            let is_taken = taken.iter().any(|range| range.contains(&number));
            if !is_taken && best.is_none_or(|(_, most)| height > most) {
                best = Some((number, height));
            }
        }
        let Some((peak, height)) = best else { break };
        if highest == 0.0 {
            highest = height;
        }
        let range = foot(response, peak, *ends.start())..=foot(response, peak, *ends.end());
        let is_peak = height > LEAST && height > LEAST_PART * highest;
        if !is_peak || peak == *range.start() || peak == *range.end() {
            break;
        }
        if let Some(mode) = fit(response, step, peak, range.clone()) {
            let _ = found.push(mode);
        }
        let _ = taken.push(range);
    }
    found
}

/// The number from a peak towards an end at its foot, or in a valley.
#[inline(never)]
fn foot(response: &Response, peak: usize, end: usize) -> usize {
    let height = response.at(peak);
    let (mut last, mut lowest) = (peak, height);
    let mut number = peak;
    while number != end {
        number = if end < peak { number - 1 } else { number + 1 };
        let here = response.at(number);
        if here < FOOT * height || here > RISE * lowest {
            break;
        }
        if here < lowest {
            (last, lowest) = (number, here);
        }
    }
    last
}

/// The mode of a peak; `None` if it has none of a possible damping.
#[inline(never)]
fn fit(response: &Response, step: f32, peak: usize, range: RangeInclusive<usize>) -> Option<Mode> {
    let height = response.at(peak);
    let count = range.clone().count();
    if count < FEWEST {
        return None;
    }
    // Scaled, so that all columns are of one size.
    let (below, above) = (-square(peak, *range.start()), square(peak, *range.end()));
    let width = if below > above { below } else { above };
    let mut sums = [[0.0; 5]; 4];
    let row = |number: usize| row(response.at(number) / height, square(peak, number) / width);
    for number in range.clone() {
        add_products(&mut sums, &row(number));
    }
    let solution = solve(&mut sums)?;
    let mut error = 0.0;
    for number in range {
        let row = row(number);
        let fitted: f32 = row.iter().zip(solution).map(|(column, part)| column * part).sum();
        error += (fitted - 1.0) * (fitted - 1.0);
    }
    let [a, b, c, _] = solution;
    // The polynomial in u: x is (u - 1) / width.
    let (b, c) = (b / width, c / (width * width));
    let (u0, u1, u2) = (a - b + c, b - 2.0 * c, c);
    if u0 <= 0.0 || u2 <= 0.0 {
        return None;
    }
    let own = root(u0 / u2);
    let (hz, relative) = (root(own) * peak as f32 * step, 1.0 / (root(own) * peak as f32));
    let damping = 0.25 * (u1 / (u2 * own) + 2.0) - relative * relative / 3.0;
    let is_possible = damping > 0.0 && damping < 0.25;
    is_possible.then(|| Mode {
        centihertz: (hz * 100.0 + 0.5) as u32,
        damping: (root(damping) * 1000.0 + 0.5) as u16,
        fit_error: (root(error / count as f32) * 1000.0 + 0.5) as u16,
    })
}

/// The square of a frequency over the peak's, less 1.
fn square(peak: usize, number: usize) -> f32 {
    let ratio = number as f32 / peak as f32;
    ratio * ratio - 1.0
}

/// The columns at a frequency: of a, b, c and d, and the right side.
fn row(s: f32, x: f32) -> [f32; 5] {
    [s, s * x, s * x * x, -x, 1.0]
}

/// Adds the products of each two columns. Rows of any number: loops are smaller than 20 sums.
#[inline(never)]
fn add_products(sums: &mut [[f32; 5]], row: &[f32]) {
    for (sums, a) in sums.iter_mut().zip(row) {
        for (sum, b) in sums.iter_mut().zip(row) {
            *sum += a * b;
        }
    }
}

/// Solves four linear equations with a symmetric, positive matrix, the right side in the last column.
#[inline(never)]
fn solve(sums: &mut [[f32; 5]]) -> Option<[f32; 4]> {
    for i in 0..sums.len() {
        let pivot_row = *sums.get(i)?;
        let pivot = *pivot_row.get(i)?;
        if pivot <= 0.0 {
            return None;
        }
        for (j, row) in sums.iter_mut().enumerate() {
            let factor = if j == i { continue } else { row.get(i)? / pivot };
            for (value, of_pivot) in row.iter_mut().zip(pivot_row) {
                *value -= factor * of_pivot;
            }
        }
    }
    let mut solution = [0.0; 4];
    for (i, (value, row)) in solution.iter_mut().zip(sums).enumerate() {
        let [.., right] = row;
        *value = *right / *row.get(i)?;
    }
    Some(solution)
}
