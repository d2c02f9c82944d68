//! The surface of a bed: heights that were measured, and the smooth law through them. Data and arithmetic alone; no
//! machine.
//!
//! ```text
//!  heights at the points of a grid --> cell: 4 by 4 heights --> at: height, slopes     what z adds
//!                 ^ missing                     |
//!           points without a measurement        +--> bounds: steepest, most bent       what the planner allows for
//! ```
//!
//! Between points the surface is a Catmull-Rom spline with the tension 1/2: it passes through all points, and its
//! slope has no jump. Around the grid lies one ring of points on the straight lines through the last two. Outside of
//! the grid the height is the height at its border. Source: E. Catmull, R. Rom, "A class of local interpolating
//! splines" (1974). Marlin has the same law for its subdivided mesh (`bedlevel/abl/bbl.cpp`).
//!
//! The arithmetic is single precision in a fixed order, with sums, differences and products alone, so that every
//! platform computes the same bits ([`motion::number`](crate::motion) says why).
//!
//! | file | for |
//! |---|---|
//! | `heights` | heights at the points of a grid |
//! | `cell` | the law within a cell, and its bounds |
//! | `mesh` | heights with their place on the bed, in mm |
//! | `fade` | less and less of the surface as z rises |
//! | `missing` | heights for points without a measurement |
//!
//! | word | means |
//! |---|---|
//! | point | a measured place; points stand in columns along x and rows along y |
//! | cell | a rectangle between four points |
//! | u, v | the place on the grid: 0 at the first column or row, 1 at the second |
//! | deviation | distance from the mean |

mod cell;
mod fade;
mod heights;
mod mesh;
mod missing;

pub use cell::{Bounds, Height};
pub use fade::Fade;
pub use heights::{Heights, MOST_POINTS, OVERSHOOT, UNITS_PER_MM};
pub use mesh::{Mesh, MeshError};
