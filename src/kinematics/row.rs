//! A row: what one motor does for the axes.

/// Steps of a motor for one step of x, y, z and e: -1, 0 or 1 for each, times a whole number of the motor. This number
/// exceeds 1 where motors with pulleys of different sizes share axes.
pub type Row = [i8; 4];

/// The whole number of a row; 0 for a motor that is not fitted.
#[must_use]
pub fn multiple(row: Row) -> i8 {
    row.into_iter().map(i8::saturating_abs).max().unwrap_or_default()
}

/// A row without its whole number: the motor's direction for each axis.
#[must_use]
pub const fn direction([x, y, z, e]: Row) -> Row {
    [x.signum(), y.signum(), z.signum(), e.signum()]
}
