//! Coordinate: one movable quantity.

/// One movable quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinate {
    /// The head along the bar, in mm.
    X,
    /// The middle of the bar along its guides, in mm.
    Y,
    /// The gantry along its guides, up, in mm; only where belts lift it.
    Z,
    /// The bar about its middle, in rad.
    Yaw,
    /// The frame on the ground along x (0) or y (1), with all on it, in mm.
    Frame(usize),
    /// The idler at this stop, in mm of belt.
    Idler(usize),
    /// The motor of this number, in mm of belt.
    Motor(u8),
}

impl Coordinate {
    /// The tool's along each axis.
    pub const TOOL: [Self; 3] = [Self::X, Self::Y, Self::Z];
}

impl std::fmt::Display for Coordinate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::X => f.write_str("x"),
            Self::Y => f.write_str("y"),
            Self::Z => f.write_str("z"),
            Self::Yaw => f.write_str("yaw of the bar"),
            Self::Frame(0) => f.write_str("frame in x"),
            Self::Frame(_) => f.write_str("frame in y"),
            Self::Idler(_) => f.write_str("idlers"),
            Self::Motor(number) => write!(f, "motor {number}"),
        }
    }
}
