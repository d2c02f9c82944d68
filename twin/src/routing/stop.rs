//! Stop: a pulley or a clamp, and its place.

use crate::params::Params;

/// Origin of a coordinate of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// The left or front side: motor 1's axis.
    Low,
    /// Half way to the other side.
    Middle,
    /// The right or back side, or the top: W, D or H.
    High,
    /// The tool.
    Tool,
}

/// One coordinate of a place: an origin, and radii and half distances (e for x, d for y, 0 for z) beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Along {
    /// Its origin.
    pub from: Mark,
    /// Pulley radii beyond it.
    pub radii: f64,
    /// Halves of the pulleys' distance beyond it: the head's for x, the bar's for y.
    pub halves: f64,
    /// How far it was mounted beyond its place, in mm.
    pub off_mm: f64,
}

impl Along {
    pub(super) const fn new(from: Mark, radii: f64, halves: f64) -> Self {
        Self { from, radii, halves, off_mm: 0.0 }
    }

    /// Exactly at an origin.
    pub(super) const fn at_mark(from: Mark) -> Self {
        Self::new(from, 0.0, 0.0)
    }

    /// In mm, on an axis of this length with the tool at this place and pulleys at this distance.
    fn at(self, length_mm: f64, tool_mm: f64, distance_mm: f64, radius_mm: f64) -> f64 {
        let from = match self.from {
            Mark::Low => 0.0,
            Mark::Middle => length_mm / 2.0,
            Mark::High => length_mm,
            Mark::Tool => tool_mm,
        };
        from + self.radii * radius_mm + self.halves * distance_mm / 2.0 + self.off_mm
    }
}

/// A place of the tool, in mm from motor 1's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// To the right.
    pub x: f64,
    /// Away from the front: the middle of the bar.
    pub y: f64,
    /// Up, where belts lift the tool; otherwise 0.
    pub z: f64,
}

impl Place {
    /// A place on a machine with belts for x and y alone.
    #[must_use]
    pub const fn flat(x: f64, y: f64) -> Self {
        Self { x, y, z: 0.0 }
    }

    /// Its coordinates.
    #[must_use]
    pub const fn xyz(&self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }

    /// The place at these coordinates.
    #[must_use]
    pub const fn of_xyz([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
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
    /// Place of its centre, up.
    pub z: Along,
    /// Its role.
    pub role: Role,
}

impl Stop {
    /// A motor of this number at a corner.
    pub(super) const fn motor_at(number: u8, x: Mark, y: Mark) -> Self {
        Self::new(number, (x, 0.0, 0.0), (y, 0.0, 0.0), Role::Motor)
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
        let z = Along::at_mark(Mark::Low);
        Self { number, x: Along::new(x.0, x.1, x.2), y: Along::new(y.0, y.1, y.2), z, role }
    }

    /// Its number, if it is a motor.
    #[must_use]
    pub fn motor(&self) -> Option<u8> {
        (self.role == Role::Motor).then_some(self.number)
    }

    /// Whether it turns with the belt.
    #[must_use]
    pub const fn is_idler(&self) -> bool {
        matches!(self.role, Role::Idler(_))
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

    /// Its motion along an axis (0 to 2 for x to z) per millimetre of the tool: 1 or 0.
    #[must_use]
    pub fn follows(&self, axis: usize) -> f64 {
        let along = [self.x, self.y, self.z].get(axis).copied();
        f64::from(u8::from(along.is_some_and(|along| along.from == Mark::Tool)))
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

    /// Its height in mm with the tool at `tool`.
    #[must_use]
    pub fn height(&self, params: &Params, tool: Place) -> f64 {
        self.z.at(params.height_mm, tool.z, 0.0, params.pulley_radius_mm)
    }
}
