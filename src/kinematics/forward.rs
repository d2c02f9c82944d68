//! Forward kinematics: from motor counts to the tool's position, in whole numbers.
//!
//! With as many coordinates as axes this is the inverse of their rows. With more it is the least-squares position
//! `(R^T R)^-1 R^T n`, with the inverse as adjugate over determinant. Rows are small integers, so each axis is a sum of
//! counts divided by one small number. Counts that belong to a position give exactly that position.

use super::row::Row;
use crate::units::{Steps, part_of};

/// The inverse of `R^T R`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Weights {
    /// Of x, y and z.
    adjugate: [[i32; 3]; 3],
    determinant: i64,
    /// Sum of the squares of the filament's coefficients.
    filament: i64,
}

impl Weights {
    /// One copy and no unrolled loop: the firmware needs it once.
    #[inline(never)]
    fn new(rows: &[Row]) -> Option<Self> {
        let mut square = [[0i64; 3]; 3];
        let mut filament = 0;
        for &[x, y, z, e] in rows {
            let row = [x, y, z].map(i64::from);
            for (sums, a) in square.iter_mut().zip(row) {
                for (sum, b) in sums.iter_mut().zip(row) {
                    *sum += a * b;
                }
            }
            filament += i64::from(e) * i64::from(e);
        }
        let [[a, b, c], [_, d, e], [.., f]] = square;
        // Symmetric, so six numbers suffice.
        let (bc, ac, ab) = (c * e - b * f, b * e - c * d, b * c - a * e);
        let adjugate = [[d * f - e * e, bc, ac], [bc, a * f - c * c, ab], [ac, ab, a * d - b * b]];
        let determinant = a * adjugate[0][0] + b * bc + c * ac;
        // In lowest terms, to keep sums of counts short.
        let divisor = adjugate.as_flattened().iter().fold(determinant, |all, one| greatest_divisor(all, *one)).max(1);
        // Squares of eight rows of 16 each are 2^11 at most, products of two of them 2^22, and their differences 2^23.
        let adjugate = adjugate.map(|row| row.map(|weight| (weight / divisor) as i32));
        (determinant != 0 && filament != 0).then_some(Self { adjugate, determinant: determinant / divisor, filament })
    }

    /// Each axis as a sum and its divisor.
    fn fractions(&self, rows: &[Row], counts: &[i64]) -> [(i64, i64); 4] {
        let [x, y, z] = self.adjugate.map(|[a, b, c]| (sum([a, b, c, 0], rows, counts), self.determinant));
        [x, y, z, (sum([0, 0, 0, 1], rows, counts), self.filament)]
    }
}

/// Sum of the counts, each multiplied by its row times these weights.
#[inline(never)]
fn sum([a, b, c, d]: [i32; 4], rows: &[Row], counts: &[i64]) -> i64 {
    let mut sum = 0;
    for ([x, y, z, e], count) in rows.iter().map(|row| row.map(i32::from)).zip(counts) {
        sum += i64::from(a * x + b * y + c * z + d * e) * count;
    }
    sum
}

/// A divided sum, in steps.
#[inline(never)]
fn steps((sum, over): (i64, i64)) -> Steps {
    let (whole, rest) = (sum.div_euclid(over), sum.rem_euclid(over));
    let part = part_of(rest, 1 << 32, over.unsigned_abs());
    Steps::from_bits((whole << 32).wrapping_add(part))
}

/// Greatest common divisor, never negative (Euclid, Elements, VII.2).
pub(super) const fn greatest_divisor(a: i64, b: i64) -> i64 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// Whether counts with these rows hold every axis.
pub(super) fn is_held(rows: &[Row]) -> bool {
    Weights::new(rows).is_some()
}

/// From N counts to x, y, z and e.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ForwardKinematics<const N: usize> {
    rows: [Row; N],
    weights: Weights,
}

impl<const N: usize> ForwardKinematics<N> {
    /// For counts that determine nothing: all axes are 0.
    pub const NONE: Self =
        Self { rows: [[0; 4]; N], weights: Weights { adjugate: [[0; 3]; 3], determinant: 0, filament: 0 } };

    /// For counts with these rows; `None` if they do not hold every axis.
    #[must_use]
    pub fn new(rows: [Row; N]) -> Option<Self> {
        Weights::new(&rows).map(|weights| Self { rows, weights })
    }

    /// Each axis as a sum and its divisor.
    #[must_use]
    pub fn fractions(&self, counts: &[i64; N]) -> [(i64, i64); 4] {
        self.weights.fractions(&self.rows, counts).map(|(sum, over)| (sum, over.max(1)))
    }

    /// x, y, z and e in steps; exact unless a divisor is no power of two.
    #[must_use]
    pub fn position(&self, counts: &[i64; N]) -> [Steps; 4] {
        self.fractions(counts).map(steps)
    }
}
