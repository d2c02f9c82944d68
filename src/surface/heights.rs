//! Heights at the points of a grid.

use super::cell::{Bounds, Cell, Height};

/// Most columns, and most rows.
pub const MOST_POINTS: usize = 9;

/// Units of height in a millimetre: half a micrometre each, finer than any probe repeats. 16 bits reach 16 mm up and
/// down.
pub const UNITS_PER_MM: i32 = 2000;

/// A surface's distance from the mean is at most this factor times the largest distance of a point. In the middle of a
/// cell the sizes of the weights of heights add up to 1.25 along each axis.
pub const OVERSHOOT: f32 = 1.25 * 1.25;

/// Heights in units, at points in columns and rows.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Heights {
    columns: u8,
    rows: u8,
    points: [[i16; MOST_POINTS]; MOST_POINTS],
}

/// A line of points through the ring around the grid: twice the height of one point, or once, less the height of
/// another.
#[derive(Clone, Copy)]
struct Line {
    at: usize,
    times: i32,
    less: usize,
}

impl Line {
    /// The line before, on or after those from 0 to `last`.
    const fn new(number: i32, last: u8) -> Self {
        let end = last as i32;
        if number < 0 {
            Self { at: 0, times: 2, less: 1 }
        } else if number > end {
            Self { at: end as usize, times: 2, less: (end - 1) as usize }
        } else {
            Self { at: number as usize, times: 1, less: number as usize }
        }
    }

    /// The height of a column in a row of points.
    #[inline(always)]
    fn height(&self, points: &[i16; MOST_POINTS]) -> i32 {
        let of = |place: usize| points.get(place).copied().map_or(0, i32::from);
        if self.times == 1 { of(self.at) } else { 2 * of(self.at) - of(self.less) }
    }
}

impl Heights {
    /// No points: flat, and everywhere 0.
    pub const NONE: Self = Self { columns: 0, rows: 0, points: [[0; MOST_POINTS]; MOST_POINTS] };

    /// All points at 0; `None` if there are too few columns or rows for a cell, or too many.
    #[must_use]
    pub const fn flat(columns: usize, rows: usize) -> Option<Self> {
        if columns < 2 || columns > MOST_POINTS || rows < 2 || rows > MOST_POINTS {
            return None;
        }
        Some(Self { columns: columns as u8, rows: rows as u8, ..Self::NONE })
    }

    /// Whether it has no points.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.columns == 0
    }

    /// Columns, along x.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns as usize
    }

    /// Rows, along y.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows as usize
    }

    /// The height of a point; 0 if there is no such point.
    #[must_use]
    pub fn get(&self, column: usize, row: usize) -> i16 {
        self.points.get(row).and_then(|row| row.get(column)).copied().unwrap_or_default()
    }

    /// Sets the height of a point.
    pub fn set(&mut self, column: usize, row: usize, height: i16) {
        if column < self.columns()
            && row < self.rows()
            && let Some(point) = self.points.get_mut(row).and_then(|row| row.get_mut(column))
        {
            *point = height;
        }
    }

    /// A row with all its places.
    #[must_use]
    pub fn row(&self, row: usize) -> [i16; MOST_POINTS] {
        self.points.get(row).copied().unwrap_or_default()
    }

    /// Sets a row with all its places.
    pub fn set_row(&mut self, row: usize, heights: [i16; MOST_POINTS]) {
        if let Some(row) = self.points.get_mut(row) {
            *row = heights;
        }
    }

    /// The heights of all points.
    pub fn points(&self) -> impl Iterator<Item = i16> {
        let columns = self.columns();
        (0..columns * self.rows()).map(move |number| self.get(number % columns, number / columns))
    }

    /// The mean height of the points.
    #[must_use]
    pub fn mean(&self) -> f32 {
        let sum: i32 = self.points().map(i32::from).sum();
        sum as f32 / (self.columns() * self.rows()).max(1) as f32
    }

    /// The largest distance of a point from the mean.
    #[must_use]
    pub fn deviation(&self) -> f32 {
        let mean = self.mean();
        self.points().fold(0.0, |most, point| {
            let distance = (f32::from(point) - mean).abs();
            if distance > most { distance } else { most }
        })
    }

    /// The cell of a column and a row, with the points around it. It has loops: optimisation for the least size calls
    /// the closures of `from_fn` as functions.
    fn cell(&self, column: u8, row: u8) -> Cell {
        let (last_column, last_row) = (self.columns.saturating_sub(1), self.rows.saturating_sub(1));
        let (column, row) = (i32::from(column), i32::from(row));
        let columns = [
            Line::new(column - 1, last_column),
            Line::new(column, last_column),
            Line::new(column + 1, last_column),
            Line::new(column + 2, last_column),
        ];
        let mut cell = [[0.0; 4]; 4];
        for (number, heights) in (row - 1..).zip(&mut cell) {
            let row = Line::new(number, last_row);
            let Some(points) = self.points.get(row.at) else { continue };
            if row.times == 1 {
                for (height, column) in heights.iter_mut().zip(&columns) {
                    *height = column.height(points) as f32;
                }
            } else {
                let Some(others) = self.points.get(row.less) else { continue };
                for (height, column) in heights.iter_mut().zip(&columns) {
                    *height = (2 * column.height(points) - column.height(others)) as f32;
                }
            }
        }
        Cell(cell)
    }

    /// The cell of a place along one axis, and the part of the cell before it, from 0 to 1. `None` for the part if the
    /// place lies outside of the grid, where it counts as the border.
    #[inline(always)]
    fn place(at: f32, points: u8) -> (u8, f32, bool) {
        let last = points.saturating_sub(2);
        let end = f32::from(points.saturating_sub(1));
        if at <= 0.0 || at.is_nan() {
            (0, 0.0, at == 0.0)
        } else if at >= end {
            (last, 1.0, at == end)
        } else {
            let cell = at as u8;
            (cell, at - f32::from(cell), true)
        }
    }

    /// Height, slopes and curvatures at a place, in units, a cell each way.
    #[must_use]
    pub fn at(&self, u: f32, v: f32) -> Height {
        if self.is_none() {
            return Height::FLAT;
        }
        let ((column, u, is_in_x), (row, v, is_in_y)) = (Self::place(u, self.columns), Self::place(v, self.rows));
        let mut height = self.cell(column, row).at(u, v);
        // Outside, the height stays the same.
        if !is_in_x {
            (height.dx, height.dxx, height.dxy) = (0.0, 0.0, 0.0);
        }
        if !is_in_y {
            (height.dy, height.dyy, height.dxy) = (0.0, 0.0, 0.0);
        }
        height
    }

    /// Height and slopes alone, which is what motion needs many thousand times a second.
    #[must_use]
    pub fn slopes_at(&self, u: f32, v: f32) -> [f32; 3] {
        if self.is_none() {
            return [0.0; 3];
        }
        let ((column, u, is_in_x), (row, v, is_in_y)) = (Self::place(u, self.columns), Self::place(v, self.rows));
        let [z, dx, dy] = self.cell(column, row).slopes_at(u, v);
        [z, if is_in_x { dx } else { 0.0 }, if is_in_y { dy } else { 0.0 }]
    }

    /// Bounds of slopes and curvatures over all cells from one place to another; the second is nowhere before the
    /// first.
    #[must_use]
    pub fn bounds(&self, from: [f32; 2], to: [f32; 2]) -> Bounds {
        let mut bounds = Bounds::FLAT;
        if self.is_none() {
            return bounds;
        }
        let ([from_u, from_v], [to_u, to_v]) = (from, to);
        let cell = |at: f32, points: u8| Self::place(at, points).0;
        for row in cell(from_v, self.rows)..=cell(to_v, self.rows) {
            for column in cell(from_u, self.columns)..=cell(to_u, self.columns) {
                bounds = bounds.or(&self.cell(column, row).bounds());
            }
        }
        bounds
    }
}
