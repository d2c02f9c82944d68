//! Model: the segment law, and what follows from it for a place of the tool.
//!
//! One law makes every matrix here. A straight segment that goes in direction t from one stop to the next is stretched by
//!
//! ```text
//! e = t . (dP_next - dP_prev) + s_next u_next - s_prev u_prev
//! ```
//!
//! where dP is how far a stop's centre has moved, u = r theta how far its pulley has turned, and s = +1 where the belt passes
//! counter-clockwise, -1 clockwise, 0 on a clamp. It is exact as long as nothing turns but pulleys, and to first order where
//! the bar yaws. A segment pulls with T = T0 + EA e / L.
//!
//! | file | what |
//! |---|---|
//! | [`coordinate`] | what may move |
//! | [`links`] | the law: segments, and spans between motors, as rows over the coordinates |
//! | [`ways`] | which way motors turn for the tool: rows without any stretch |
//! | [`displacements`] | the same with every displacement of its own, as the paper counts degrees of freedom |
//! | [`loads`] | forces on frame, bar and head from tensions |
//! | [`elastic`] | stiffness and mass of what may move |

pub mod coordinate;
pub mod displacements;
pub mod elastic;
pub mod links;
pub mod loads;
pub mod ways;

/// Shortest free length in mm that a stiffness is computed with: a pulley that nearly touches the next is no rigid bond.
pub const SHORTEST_FREE_MM: f64 = 5.0;
