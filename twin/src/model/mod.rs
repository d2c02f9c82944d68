//! Model: the segment law, and its results for a place of the tool.
//!
//! One law gives every matrix here. A straight segment in direction t from one stop to the next is stretched by
//!
//! ```text
//! e = t . (dP_next - dP_prev) + s_next u_next - s_prev u_prev
//! ```
//!
//! dP is the displacement of a stop's centre and u = r theta the rotation of its pulley. s = +1 where the belt passes
//! counter-clockwise, -1 clockwise, 0 on a clamp. The law is exact while only pulleys turn, and of first order where
//! the bar yaws. A segment pulls with T = T0 + EA e / L.
//!
//! | file | content |
//! |---|---|
//! | [`coordinate`] | movable quantities |
//! | [`links`] | the law: segments, and spans between motors, as rows over the coordinates |
//! | [`ways`] | motor travel for the tool: rows without any stretch |
//! | [`displacements`] | the same with all displacements, as the paper counts degrees of freedom |
//! | [`loads`] | forces on frame, bar and head from tensions |
//! | [`elastic`] | stiffness and mass of the movable parts |
//! | [`gantry`] | belts of a CoreXYZ that rack its bar and tilt its gantry |

pub mod coordinate;
pub mod displacements;
pub mod elastic;
pub mod gantry;
pub mod links;
pub mod loads;
pub mod ways;

/// Shortest free length in mm for a stiffness: a pulley that nearly touches the next is no rigid connection.
pub const SHORTEST_FREE_MM: f64 = 5.0;
