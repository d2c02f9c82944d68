//! Figures 3, 4 and 5 of the paper, computed again on a rig, with the sentences of its text that go with them.
//!
//! The paper's curves cannot be read from its text, and the values of its Table I are unknown. So the figures are
//! compared with the text alone: each sentence is a claim that this rig bears out or not.

mod five;
mod four;
mod three;

pub use five::{Figure5, Varied};
pub use four::{Figure4, Trend};
pub use three::{Figure3, Panel};

use super::{Corners, Direction, Model};
use serde::Serialize;

/// What stands above the claims.
const ABOUT_CLAIMS: &str = "\nthe paper's text, on this rig";

/// Speeds of figure 3, m/s.
pub const SPEEDS: [f64; 3] = [0.020, 0.039, 0.079];

/// The speed of figure 5, m/s.
const FAST: f64 = SPEEDS[2];

/// Both ways round the square, the paper's first, with names for people.
pub const WAYS: [(Direction, &str); 2] =
    [(Direction::CounterClockwise, "counter-clockwise"), (Direction::Clockwise, "clockwise")];

/// Both models, with the names of the paper.
pub const MODELS: [(Model, &str); 2] = [(Model::Full, "full-DoF"), (Model::FourDof, "4-DoF")];

/// Errors of a run, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Turning from x to y.
    pub x_to_y_mm: f64,
    /// Turning from y to x.
    pub y_to_x_mm: f64,
}

impl From<Corners> for Errors {
    fn from(corners: Corners) -> Errors {
        Errors { x_to_y_mm: corners.x_to_y_mm, y_to_x_mm: corners.y_to_x_mm }
    }
}

impl Errors {
    /// Names of both turns.
    pub const TURNS: [&'static str; 2] = ["x to y", "y to x"];

    /// Both, in the order of the names.
    #[must_use]
    pub const fn both(&self) -> [f64; 2] {
        [self.x_to_y_mm, self.y_to_x_mm]
    }
}
