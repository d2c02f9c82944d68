//! Missing points: heights for the points of a grid that were not measured.
//!
//! A point gets the mean of the straight lines through its next two neighbours, along the column and the row, where
//! both have a height. This is done in rounds, so that it does not depend on an order of points. A round without such a
//! point copies the mean of next neighbours instead.

use super::heights::{Heights, MOST_POINTS};

/// A grid with points that may have no height yet.
type Points = [[Option<i16>; MOST_POINTS]; MOST_POINTS];

/// The height so many columns and rows from a point, if there is one.
fn beside(points: &Points, [column, row]: [usize; 2], [columns, rows]: [isize; 2]) -> Option<i16> {
    let (column, row) = (column.checked_add_signed(columns)?, row.checked_add_signed(rows)?);
    points.get(row)?.get(column).copied().flatten()
}

/// The four directions along columns and rows.
const DIRECTIONS: [[isize; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/// The mean of the heights that the directions give for a point; `None` if they give none.
fn mean(of_direction: impl Fn([isize; 2]) -> Option<i32>) -> Option<i16> {
    let (sum, count) = DIRECTIONS.into_iter().filter_map(of_direction).fold((0, 0), |(s, n), h| (s + h, n + 1));
    let mean: i32 = if count == 0 { return None } else { sum / count };
    Some(mean.clamp(i16::MIN.into(), i16::MAX.into()) as i16)
}

/// The height of a missing point on the straight lines through its neighbours.
fn on_lines(points: &Points, at: [usize; 2]) -> Option<i16> {
    mean(|[columns, rows]| {
        let near = beside(points, at, [columns, rows])?;
        let far = beside(points, at, [2 * columns, 2 * rows])?;
        Some(2 * i32::from(near) - i32::from(far))
    })
}

/// The mean height of its next neighbours.
fn as_neighbours(points: &Points, at: [usize; 2]) -> Option<i16> {
    mean(|direction| beside(points, at, direction).map(i32::from))
}

impl Heights {
    /// Heights of all points from those that have one; a height belongs to a column and a row. `None` if no point has
    /// one, or the grid is none.
    #[must_use]
    pub fn filled(columns: usize, rows: usize, mut measured: impl FnMut(usize, usize) -> Option<i16>) -> Option<Self> {
        let mut heights = Self::flat(columns, rows)?;
        let all = || (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let mut points: Points = [[None; MOST_POINTS]; MOST_POINTS];
        let set = |points: &mut Points, [column, row]: [usize; 2], height: Option<i16>| {
            if let Some(point) = points.get_mut(row).and_then(|row| row.get_mut(column)) {
                *point = height;
            }
        };
        all().for_each(|[column, row]| set(&mut points, [column, row], measured(column, row)));
        // Each round gives at least one point its height.
        for _ in 0..MOST_POINTS * MOST_POINTS {
            // All points of a round come from those of the round before, so that their order makes no difference.
            let before = points;
            let missing = || all().filter(|at| beside(&before, *at, [0, 0]).is_none());
            if missing().next().is_none() {
                all().for_each(|[column, row]| {
                    heights.set(column, row, beside(&points, [column, row], [0, 0]).unwrap_or_default());
                });
                return Some(heights);
            }
            missing().for_each(|at| set(&mut points, at, on_lines(&before, at)));
            if points == before {
                missing().for_each(|at| set(&mut points, at, as_neighbours(&before, at)));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_with_holes_is_filled_as_the_plane() {
        let plane = |column: usize, row: usize| (100 * column) as i16 - (37 * row) as i16 + 5;
        let holes: [&[[usize; 2]]; 4] =
            [&[[0, 0]], &[[0, 0], [1, 0], [0, 1]], &[[4, 4], [3, 4], [4, 3], [2, 2]], &[[0, 2], [1, 2], [2, 2]]];
        for holes in holes {
            let filled =
                Heights::filled(5, 5, |column, row| (!holes.contains(&[column, row])).then(|| plane(column, row)));
            let filled = filled.expect("most points are known");
            for (column, row) in (0..5).flat_map(|column| (0..5).map(move |row| (column, row))) {
                assert_eq!(filled.get(column, row), plane(column, row), "{holes:?}: {column}, {row}");
            }
        }
    }

    #[test]
    fn a_single_point_gives_its_height_to_all_and_none_gives_nothing() {
        let one = Heights::filled(9, 3, |column, row| (column == 8 && row == 2).then_some(-7));
        assert!(one.is_some_and(|heights| heights.points().count() == 27 && heights.points().all(|h| h == -7)));
        assert_eq!(Heights::filled(9, 9, |_, _| None), None);
        assert_eq!(Heights::filled(1, 9, |_, _| Some(0)), None);
    }
}
