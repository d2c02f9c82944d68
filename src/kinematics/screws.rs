//! Screws: how far each of several z motors turns so that bed and nozzle are level, given heights at a few points.
//!
//! Heights at points of the bed become heights at the screws by a least-squares fit. It is a line through two screws, a
//! plane over three, and a plane with a twist over four, because four belts carry a gantry that can twist. The fit is
//! evaluated at the screws' own places. Points that are taken for the screws themselves would correct too little, by
//! the ratio of the two distances.

/// Screws that a machine may have.
pub const SCREWS: usize = 4;

/// Coordinates in the fit are parts of this length in mm, so that its sums are near 1.
const UNIT: f32 = 100.0;

/// Pivots below this are rounding errors of sums near 1.
const LEAST_PIVOT: f32 = 1e-4;

/// A place in the plane, in mm.
pub type Place = [f32; 2];

/// Why there is no fit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FitError {
    /// Fewer than two screws, more than [`SCREWS`], or fewer points than screws.
    TooFew,
    /// The points lie on a line, or at one place: they do not show the tilt.
    NoBase,
}

/// The heights of the fit at `screws` and at `reference`, in mm, given `heights` in mm at `points`.
///
/// # Errors
/// [`FitError`].
pub fn heights_at_screws(
    screws: &[Place],
    points: &[Place],
    heights: &[f32],
    reference: Place,
) -> Result<([f32; SCREWS], f32), FitError> {
    let terms = screws.len();
    let (Some(&origin), 2..=SCREWS) = (screws.first(), terms) else { return Err(FitError::TooFew) };
    if points.len() < terms || heights.len() != points.len() {
        return Err(FitError::TooFew);
    }
    let basis = Basis::new(origin, screws.get(1).copied().unwrap_or(origin), points, terms);
    let mut rows = [[0.0; SCREWS + 1]; SCREWS];
    for (point, height) in points.iter().zip(heights) {
        let values = basis.at(*point);
        for (row, own) in rows.iter_mut().zip(values) {
            for (slot, value) in row.iter_mut().zip(values.into_iter().chain([*height])) {
                *slot += own * value;
            }
        }
    }
    // The normal equations of the fit, with the heights as their last column.
    let factors = solve(rows, terms)?;
    let at = |place| basis.at(place).into_iter().zip(factors).map(|(value, factor)| value * factor).sum::<f32>();
    let mut fitted = [0.0; SCREWS];
    for (slot, screw) in fitted.iter_mut().zip(screws) {
        *slot = at(*screw);
    }
    Ok((fitted, at(reference)))
}

/// The functions of the fit: 1 and the way along the screws, or 1, x and y, or these and x y.
struct Basis {
    centre: Place,
    /// Direction from the first screw to the second, of length 1; used for two screws.
    along: Place,
    terms: usize,
}

impl Basis {
    fn new([x, y]: Place, [other_x, other_y]: Place, points: &[Place], terms: usize) -> Self {
        let count = points.len() as f32;
        let centre = [0, 1].map(|axis| points.iter().filter_map(|place| place.get(axis)).sum::<f32>() / count);
        let (dx, dy) = (other_x - x, other_y - y);
        // Longer than the way and shorter than 1.5 times it, which a unit of length may be.
        let length = (dx.abs() + dy.abs()).max(1.0);
        Self { centre, along: [dx / length, dy / length], terms }
    }

    /// Their values at a place; 0 for those that are not used.
    fn at(&self, [x, y]: Place) -> [f32; SCREWS] {
        let [centre_x, centre_y] = self.centre;
        let (x, y) = ((x - centre_x) / UNIT, (y - centre_y) / UNIT);
        let [along_x, along_y] = self.along;
        match self.terms {
            2 => [1.0, x * along_x + y * along_y, 0.0, 0.0],
            3 => [1.0, x, y, 0.0],
            _ => [1.0, x, y, x * y],
        }
    }
}

/// Solves the first `terms` equations, each with its right side last, by elimination with the greatest pivot.
fn solve(mut rows: [[f32; SCREWS + 1]; SCREWS], terms: usize) -> Result<[f32; SCREWS], FitError> {
    for column in 0..terms {
        let size = |row: &[f32; SCREWS + 1]| row.get(column).map_or(0.0, |value| value.abs());
        let best = (column..terms).max_by(|a, b| {
            let [a, b] = [a, b].map(|number| rows.get(*number).map_or(0.0, size));
            a.total_cmp(&b)
        });
        rows.swap(column, best.unwrap_or(column));
        let Some(&pivot_row) = rows.get(column) else { break };
        let pivot = pivot_row.get(column).copied().unwrap_or_default();
        if pivot.abs() < LEAST_PIVOT {
            return Err(FitError::NoBase);
        }
        // The rows above, too: then each factor stands alone, and nothing has to be put in backwards.
        for row in rows.iter_mut().take(terms).enumerate().filter(|(number, _)| *number != column).map(|(_, row)| row) {
            let times = row.get(column).copied().unwrap_or_default() / pivot;
            for (value, subtracted) in row.iter_mut().zip(pivot_row) {
                *value -= times * subtracted;
            }
        }
    }
    let mut factors = [0.0; SCREWS];
    for (number, (factor, row)) in factors.iter_mut().zip(&rows).take(terms).enumerate() {
        let pivot = row.get(number).copied().unwrap_or_default();
        *factor = row.last().copied().unwrap_or_default() / pivot;
    }
    Ok(factors)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    /// A hundredth of a microstep of a fine screw (1.25 um).
    const NEAR: f32 = 1e-5;

    fn assert_heights(screws: &[Place], points: &[(Place, f32)], expected: &[f32]) {
        let places: Vec<Place> = points.iter().map(|(place, _)| *place).collect();
        let heights: Vec<f32> = points.iter().map(|(_, height)| *height).collect();
        let (found, _) = heights_at_screws(screws, &places, &heights, [0.0; 2]).expect("a fit");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < NEAR, "{found} instead of {expected}");
        }
    }

    const TWO: [Place; 2] = [[-25.0, 200.0], [455.0, 200.0]];

    #[test]
    fn two_screws_get_a_line_at_their_own_places() {
        let points = [([40.0, 200.0], 0.31), ([390.0, 200.0], -0.17)];
        assert_heights(&TWO, &points, &[0.399_143, -0.259_143]);
        let points = [([40.0, 200.0], 0.31), ([390.0, 200.0], -0.17), ([215.0, 200.0], 0.08)];
        assert_heights(&TWO, &points, &[0.402_476, -0.255_810]);
    }

    #[test]
    fn two_screws_may_lie_in_any_direction() {
        let screws = TWO.map(|[x, y]| [y, x]);
        let points = [([200.0, 40.0], 0.31), ([200.0, 390.0], -0.17)];
        assert_heights(&screws, &points, &[0.399_143, -0.259_143]);
    }

    /// The points lie 50 mm off the line through the screws, one on each side: only the way along it counts.
    #[test]
    fn two_screws_may_lie_across() {
        let points = [([20.0, 110.0], 0.2), ([280.0, 290.0], -0.1)];
        assert_heights(&[[0.0, 0.0], [300.0, 400.0]], &points, &[0.3, -0.2]);
    }

    #[test]
    fn three_screws_get_the_least_squares_plane() {
        let screws = [[-25.0, 0.0], [455.0, 0.0], [215.0, 400.0]];
        let points = [([40.0, 60.0], 0.31), ([390.0, 60.0], -0.17), ([215.0, 340.0], 0.08), ([215.0, 60.0], 0.05)];
        assert_heights(&screws, &points, &[0.388_905, -0.269_381, 0.083_571]);
    }

    #[test]
    fn four_belts_may_twist_their_gantry() {
        let screws = [[-60.0, -10.0], [-60.0, 370.0], [360.0, 370.0], [360.0, -10.0]];
        let points = [([50.0, 25.0], 0.10), ([50.0, 225.0], -0.05), ([250.0, 225.0], 0.20), ([250.0, 25.0], 0.0)];
        assert_heights(&screws, &points, &[0.214_938, -0.435_813, 0.622_063, -0.123_688]);
    }

    #[test]
    fn the_reference_is_a_point_of_the_same_fit() {
        let points = [[40.0, 200.0], [390.0, 200.0]];
        let (_, reference) = heights_at_screws(&TWO, &points, &[0.31, -0.17], [215.0, 0.0]).expect("a fit");
        assert!((reference - 0.07).abs() < NEAR, "{reference}");
    }

    #[test]
    fn points_that_show_no_tilt_are_refused() {
        let on_a_line = [[0.0, 0.0], [100.0, 100.0], [200.0, 200.0]];
        let screws = [[0.0, 0.0], [300.0, 0.0], [150.0, 300.0]];
        assert_eq!(heights_at_screws(&screws, &on_a_line, &[0.0; 3], [0.0; 2]), Err(FitError::NoBase));
        let at_one_place = [[100.0, 50.0]; 2];
        assert_eq!(heights_at_screws(&TWO, &at_one_place, &[0.0; 2], [0.0; 2]), Err(FitError::NoBase));
        let across = [[100.0, 50.0], [100.0, 350.0]];
        assert_eq!(heights_at_screws(&TWO, &across, &[0.0; 2], [0.0; 2]), Err(FitError::NoBase));
        assert_eq!(heights_at_screws(&TWO[..1], &across, &[0.0; 2], [0.0; 2]), Err(FitError::TooFew));
        assert_eq!(heights_at_screws(&screws, &across, &[0.0; 2], [0.0; 2]), Err(FitError::TooFew));
    }
}
