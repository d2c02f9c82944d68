//! A row: what one motor does for the axes.

/// How many times a motor steps for one step of x, y, z and e.
pub type Row = [i8; 4];
