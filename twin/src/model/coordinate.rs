//! Coordinate: one movable quantity.

/// One movable quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// The head along the bar, in mm.
    X,
    /// The middle of the bar along its guides, in mm.
    Y,
    /// The bar about its middle, in rad.
    Yaw,
    /// The idler at this stop, in mm of belt.
    Idler(usize),
    /// The motor of this number, in mm of belt.
    Motor(u8),
}

impl std::fmt::Display for Coordinate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::X => f.write_str("x"),
            Self::Y => f.write_str("y"),
            Self::Yaw => f.write_str("yaw of the bar"),
            Self::Idler(_) => f.write_str("idlers"),
            Self::Motor(number) => write!(f, "motor {number}"),
        }
    }
}
