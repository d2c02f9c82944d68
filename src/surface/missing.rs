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

/// The mean height of a point on the straight lines through its neighbours, or else of its next neighbours; `None` if
/// there are none.
#[inline(never)]
fn mean(points: &Points, at: [usize; 2], is_on_lines: bool) -> Option<i16> {
    let (mut sum, mut count) = (0, 0);
    for [columns, rows] in DIRECTIONS {
        let Some(near) = beside(points, at, [columns, rows]) else { continue };
        let mut height = i32::from(near);
        if is_on_lines {
            let Some(far) = beside(points, at, [2 * columns, 2 * rows]) else { continue };
            height = 2 * height - i32::from(far);
        }
        (sum, count) = (sum + height, count + 1);
    }
    let mean: i32 = if count == 0 { return None } else { sum / count };
    Some(mean.clamp(i16::MIN.into(), i16::MAX.into()) as i16)
}

/// Gives the points without a height their [`mean`] of the points before. Returns how many had none, and how many got
/// one.
#[inline(never)]
fn fill(points: &mut Points, before: &Points, [columns, rows]: [usize; 2], is_on_lines: bool) -> [usize; 2] {
    let (mut missing, mut filled) = (0, 0);
    for (row, heights) in points.iter_mut().take(rows).enumerate() {
        for (column, height) in heights.iter_mut().take(columns).enumerate() {
            if height.is_none() {
                *height = mean(before, [column, row], is_on_lines);
                missing += 1;
                filled += usize::from(height.is_some());
            }
        }
    }
    [missing, filled]
}

impl Heights {
    /// Heights of all points from those that have one; a height belongs to a column and a row. `None` if no point has
    /// one, or the grid is none.
    #[must_use]
    pub fn filled(columns: usize, rows: usize, mut measured: impl FnMut(usize, usize) -> Option<i16>) -> Option<Self> {
        let mut heights = Self::flat(columns, rows)?;
        let mut points: Points = [[None; MOST_POINTS]; MOST_POINTS];
        for (row, points) in points.iter_mut().take(rows).enumerate() {
            for (column, point) in points.iter_mut().take(columns).enumerate() {
                *point = measured(column, row);
            }
        }
        // Each round gives at least one point its height.
        for _ in 0..MOST_POINTS * MOST_POINTS {
            // All points of a round come from those of the round before, so that their order makes no difference.
            let before = points;
            let [missing, filled] = fill(&mut points, &before, [columns, rows], true);
            if missing == 0 {
                for (row, points) in points.iter().enumerate() {
                    for (column, point) in points.iter().enumerate() {
                        heights.set(column, row, point.unwrap_or_default());
                    }
                }
                return Some(heights);
            }
            if filled == 0 {
                fill(&mut points, &before, [columns, rows], false);
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
