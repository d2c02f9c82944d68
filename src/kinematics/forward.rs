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
        let [mut a, mut b, mut c, mut d, mut e, mut f, mut filament] = [0; 7];
        for row in rows {
            let [x, y, z, of_filament] = row.map(i32::from);
            (a, b, c) = (a + x * x, b + x * y, c + x * z);
            (d, e, f) = (d + y * y, e + y * z, f + z * z);
            filament += of_filament * of_filament;
        }
        // Symmetric, so six numbers suffice.
        let (bc, ac, ab) = (c * e - b * f, b * e - c * d, b * c - a * e);
        // Squares of eight rows of 16 each are 2^11 at most, products of two of them 2^22, and their differences 2^23.
        let bb = d * f - e * e;
        let mut adjugate = [[bb, bc, ac], [bc, a * f - c * c, ab], [ac, ab, a * d - b * b]];
        let [a, b, c] = [a, b, c].map(i64::from);
        let determinant = a * i64::from(bb) + b * i64::from(bc) + c * i64::from(ac);
        // In lowest terms, to keep sums of counts short.
        let mut divisor = determinant;
        for weight in adjugate.as_flattened() {
            divisor = greatest_divisor(divisor, (*weight).into());
        }
        let divisor = divisor.max(1);
        for weight in adjugate.as_flattened_mut() {
            *weight = (i64::from(*weight) / divisor) as i32;
        }
        let (determinant, filament) = (determinant / divisor, i64::from(filament));
        (determinant != 0 && filament != 0).then_some(Self { adjugate, determinant, filament })
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
#[inline(never)]
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
