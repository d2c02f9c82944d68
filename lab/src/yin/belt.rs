//! The belt's potential energy, equation 6 of the paper: the only place with its springs.
//!
//! A coordinate is a length: x and y of the end-effector, and the belt travel r phi of each pulley. So a section
//! stretches by a signed sum of coordinates, and the energy is V = sum of k/2 (stretch)^2. All other spring equations
//! of the paper (8, 10, 13, 15, 16) follow from this table.

/// The end-effector along x.
pub(super) const X: usize = 0;
/// The end-effector along y, which the y-frame shares.
pub(super) const Y: usize = 1;
/// x, y and ten pulleys.
pub(super) const COORDINATES: usize = 12;

/// The coordinate of a pulley by its number in figure 1; 1 and 2 belong to the motors.
pub(super) const fn pulley(number: usize) -> usize {
    number + 1
}

/// A matrix over all coordinates.
pub(super) type Matrix = [[f64; COORDINATES]; COORDINATES];

/// A belt section: its index among k1 to k5 (from 0), and the signed coordinates that stretch it.
type Section = (usize, &'static [(usize, f64)]);

/// Equation 6, which is right as printed.
const SECTIONS: [Section; 12] = [
    (0, &[(pulley(3), 1.0), (X, 1.0)]),
    (0, &[(pulley(4), 1.0), (X, 1.0)]),
    (0, &[(pulley(6), 1.0), (X, -1.0)]),
    (0, &[(pulley(5), 1.0), (X, -1.0)]),
    (1, &[(pulley(3), 1.0), (pulley(1), 1.0), (Y, -1.0)]),
    (1, &[(pulley(4), 1.0), (pulley(2), 1.0), (Y, 1.0)]),
    (2, &[(pulley(9), 1.0), (pulley(1), -1.0)]),
    (2, &[(pulley(10), 1.0), (pulley(2), -1.0)]),
    (3, &[(pulley(9), 1.0), (pulley(8), -1.0)]),
    (3, &[(pulley(10), 1.0), (pulley(7), -1.0)]),
    (4, &[(pulley(8), 1.0), (pulley(6), -1.0), (Y, -1.0)]),
    (4, &[(pulley(7), 1.0), (pulley(5), -1.0), (Y, 1.0)]),
];

/// Second derivatives of the potential energy, N/m.
pub(super) fn stiffness(sections: &[f64; 5]) -> Matrix {
    let mut matrix = [[0.0; COORDINATES]; COORDINATES];
    for (section, terms) in SECTIONS {
        let Some(k) = sections.get(section) else { continue };
        for &(row, a) in terms {
            for &(column, b) in terms {
                matrix[row][column] += k * a * b;
            }
        }
    }
    matrix
}

/// Static condensation: pulleys 3 to 10 move to where no force is left on them, which removes their rows from the
/// matrix.
///
/// One at a time, by Gaussian elimination. The rest couples x, y and the motors' pulleys with k_e of equation 13. A
/// force on a pulley is passed on to its neighbours in the same proportions.
pub(super) fn condense(matrix: &mut Matrix, force: &mut [f64; COORDINATES]) {
    for gone in pulley(3)..=pulley(10) {
        let (springs, load) = (matrix[gone], force[gone]);
        for (row, force) in matrix.iter_mut().zip(force.iter_mut()) {
            let share = row[gone] / springs[gone];
            row.iter_mut().zip(springs).for_each(|(entry, spring)| *entry -= share * spring);
            *force -= share * load;
        }
    }
}
