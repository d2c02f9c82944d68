//! Stop: a pulley or a clamp, and the place where it is.

use crate::params::Params;

/// What a coordinate of a place is counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// The left or front side: motor 1's axis.
    Low,
    /// The right or back side: W or D.
    High,
    /// The tool.
    Tool,
}

/// One coordinate of a place: a mark, and so many radii and half distances (e for x, d for y) beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along {
    /// What it is counted from.
    pub from: Mark,
    /// How many pulley radii beyond.
    pub radii: f64,
    /// How many halves of the pulleys' distance beyond: that of the head's for x, of the bar's for y.
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

/// What a stop moves with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    /// It stands.
    Frame,
    /// With the bar, in y.
    Bar,
    /// With the head, in x and y.
    Head,
}

/// On which side of the belt a pulley lies.
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

/// What a stop does to the belt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Drives it.
    Motor,
    /// Turns with it.
    Idler(Side),
    /// Holds it.
    Clamp,
}

/// A pulley or a clamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The pulley's number in the paper's figure, where it has one; clamps have 0.
    pub number: u8,
    /// Where its centre is, to the right.
    pub x: Along,
    /// Where its centre is, away from the front.
    pub y: Along,
    /// What it does.
    pub role: Role,
}

impl Stop {
    /// A motor of this number at a corner.
    pub(super) const fn motor_at(number: u8, x: Mark, y: Mark) -> Self {
        Self { number, x: Along::new(x, 0.0, 0.0), y: Along::new(y, 0.0, 0.0), role: Role::Motor }
    }

    /// A pulley with the belt's teeth on it.
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

    /// What it moves with.
    #[must_use]
    pub const fn block(&self) -> Block {
        match (self.x.from, self.y.from) {
            (Mark::Tool, _) => Block::Head,
            (_, Mark::Tool) => Block::Bar,
            _ => Block::Frame,
        }
    }

    /// How the belt passes it: +1 counter-clockwise, -1 clockwise, 0 not at all.
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
