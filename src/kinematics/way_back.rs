//! The way back: from what motors have turned to where the tool is, in whole numbers.
//!
//! With as many coordinates as axes this is the inverse of their rows; with more, the position that fits best (least
//! squares), `(R^T R)^-1 R^T`. Rows are small integers, so each axis is a sum of counts over one small number, and for
//! counts that belong to a position it is that position exactly.

use super::mechanism::Row;
use crate::units::Steps;

/// Sums of counts that are the axes, of counts with these rows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WayBack<const N: usize> {
    /// How many times each count is taken, by axis.
    times: [[i16; N]; 4],
    /// What the sum of each axis is to be divided by.
    over: [i16; 4],
}

impl<const N: usize> WayBack<N> {
    /// Of counts that say nothing: all axes are 0.
    pub const NONE: Self = Self { times: [[0; N]; 4], over: [0; 4] };

    /// Of counts with these rows; `None` if they do not hold every axis.
    #[must_use]
    pub fn new(rows: &[Row; N]) -> Option<Self> {
        let tool = |row: &Row| [i32::from(row[0]), i32::from(row[1]), i32::from(row[2])];
        let mut square = [[0; 3]; 3];
        for row in rows.iter().map(tool) {
            for i in 0..3 {
                for j in 0..3 {
                    square[i][j] += row[i] * row[j];
                }
            }
        }
        let mut adjugate = [[0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let (a, b, c, d) = ((j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3);
                adjugate[i][j] = square[a][c] * square[b][d] - square[a][d] * square[b][c];
            }
        }
        let determinant = dot(square[0], adjugate[0]);
        let filament = rows.iter().map(|row| i32::from(row[3]) * i32::from(row[3])).sum();
        if determinant == 0 || filament == 0 {
            return None;
        }
        let mut back = Self::NONE;
        for (axis, (times, over)) in back.times.iter_mut().zip(&mut back.over).enumerate() {
            let weight = |row: &Row| match adjugate.get(axis) {
                Some(weights) => dot(*weights, tool(row)),
                None => i32::from(row[3]),
            };
            let whole = if axis < 3 { determinant } else { filament };
            let common = rows.iter().fold(whole, |common, row| greatest_divisor(common, weight(row)));
            for (times, row) in times.iter_mut().zip(rows) {
                *times = (weight(row) / common) as i16;
            }
            *over = (whole / common) as i16;
        }
        Some(back)
    }

    /// The sum of each axis, and what it is to be divided by.
    #[must_use]
    pub fn fractions(&self, counts: &[i64; N]) -> [(i64, i64); 4] {
        let mut fractions = [(0, 1); 4];
        for ((fraction, times), over) in fractions.iter_mut().zip(&self.times).zip(self.over) {
            let sum = times.iter().zip(counts).map(|(times, count)| i64::from(*times) * count).sum();
            *fraction = (sum, i64::from(over).max(1));
        }
        fractions
    }

    /// x, y, z and e in steps; exact unless the number that a sum is divided by is no power of two.
    #[must_use]
    pub fn position(&self, counts: &[i64; N]) -> [Steps; 4] {
        self.fractions(counts).map(|(sum, over)| {
            let (whole, rest) = (sum.div_euclid(over), sum.rem_euclid(over));
            Steps::from_bits((whole << 32).wrapping_add((rest << 32) / over))
        })
    }
}

const fn dot(a: [i32; 3], b: [i32; 3]) -> i32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The greatest number that divides both, never negative (Euclid, Elements, VII.2).
pub(super) const fn greatest_divisor(a: i32, b: i32) -> i32 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
