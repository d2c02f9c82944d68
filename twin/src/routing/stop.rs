//! Stop: a pulley or a clamp, and its place.

use crate::params::Params;

/// Origin of a coordinate of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// The left or front side: motor 1's axis.
    Low,
    /// The right or back side: W or D.
    High,
    /// The tool.
    Tool,
}

/// One coordinate of a place: an origin, and radii and half distances (e for x, d for y) beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along {
    /// Its origin.
    pub from: Mark,
    /// Pulley radii beyond it.
    pub radii: f64,
    /// Halves of the pulleys' distance beyond it: the head's for x, the bar's for y.
    pub halves: f64,
}

impl Along {
    const fn new(from: Mark, radii: f64, halves: f64) -> Self {
        Self { from, radii, halves }
    }

    /// In mm, on an axis of this length with the tool at this place and pulleys at this distance.
    fn at(self, length_mm: f64, tool_mm: f64, distance_mm: f64, radius_mm: f64) -> f64 {
        let from = match self.from {
            Mark::Low => 0.0,
            Mark::High => length_mm,
            Mark::Tool => tool_mm,
        };
        from + self.radii * radius_mm + self.halves * distance_mm / 2.0
    }
}

/// A place of the tool, in mm from motor 1's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// To the right.
    pub x: f64,
    /// Away from the front: the middle of the bar.
    pub y: f64,
}

/// The part that a stop moves with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// The frame: it does not move.
    Frame,
    /// The bar, in y.
    Bar,
    /// The head, in x and y.
    Head,
}

/// The side of the belt on which a pulley lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The toothed one: the belt passes it counter-clockwise.
    Inside,
    /// The smooth one: the belt passes it clockwise.
    Outside,
}

impl Side {
    /// +1 if the belt turns the pulley counter-clockwise as it travels, else -1.
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Inside => 1.0,
            Self::Outside => -1.0,
        }
    }
}

/// Role of a stop for the belt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It drives the belt.
    Motor,
    /// It turns with the belt.
    Idler(Side),
    /// It holds the belt.
    Clamp,
}

/// A pulley or a clamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The pulley's number in the paper's figure, where it has one; clamps have 0.
    pub number: u8,
    /// Place of its centre, to the right.
    pub x: Along,
    /// Place of its centre, away from the front.
    pub y: Along,
    /// Its role.
    pub role: Role,
}

impl Stop {
    /// A motor of this number at a corner.
    pub(super) const fn motor_at(number: u8, x: Mark, y: Mark) -> Self {
        Self { number, x: Along::new(x, 0.0, 0.0), y: Along::new(y, 0.0, 0.0), role: Role::Motor }
    }

    /// A pulley on the belt's toothed side.
    pub(super) const fn inside(number: u8, x: (Mark, f64, f64), y: (Mark, f64, f64)) -> Self {
        Self::new(number, x, y, Role::Idler(Side::Inside))
    }

    /// A pulley on the belt's back.
    pub(super) const fn outside(number: u8, x: (Mark, f64, f64), y: (Mark, f64, f64)) -> Self {
        Self::new(number, x, y, Role::Idler(Side::Outside))
    }

    /// A clamp.
    pub(super) const fn clamp(x: (Mark, f64, f64), y: (Mark, f64, f64)) -> Self {
        Self::new(0, x, y, Role::Clamp)
    }

    const fn new(number: u8, x: (Mark, f64, f64), y: (Mark, f64, f64), role: Role) -> Self {
        Self { number, x: Along::new(x.0, x.1, x.2), y: Along::new(y.0, y.1, y.2), role }
    }

    /// Its number, if it is a motor.
    #[must_use]
    pub fn motor(&self) -> Option<u8> {
        (self.role == Role::Motor).then_some(self.number)
    }

    /// The part that it moves with.
    #[must_use]
    pub const fn block(&self) -> Block {
        match (self.x.from, self.y.from) {
            (Mark::Tool, _) => Block::Head,
            (_, Mark::Tool) => Block::Bar,
            _ => Block::Frame,
        }
    }

    /// Direction in which the belt passes it: +1 counter-clockwise, -1 clockwise, 0 for a clamp.
    #[must_use]
    pub const fn sign(&self) -> f64 {
        match self.role {
            Role::Motor => 1.0,
            Role::Idler(side) => side.sign(),
            Role::Clamp => 0.0,
        }
    }

    /// Its centre in mm with the tool at `tool`.
    #[must_use]
    pub fn centre(&self, params: &Params, tool: Place) -> [f64; 2] {
        let radius = params.pulley_radius_mm;
        [
            self.x.at(params.width_mm, tool.x, params.head_pulleys_mm, radius),
            self.y.at(params.depth_mm, tool.y, params.bar_pulleys_mm, radius),
        ]
    }
}
