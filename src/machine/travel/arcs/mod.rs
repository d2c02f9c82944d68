//! Arcs: the chords that stand for G2 and G3.
//!
//! ```text
//!   I J K or R ──▶ arc::Shape ──▶ arc::Arc ── point(1), point(2), ... ──▶ one straight move each
//!                                  └─ angle: direction of a vector, cosine and sine by CORDIC
//! ```
//!
//! Pure: nothing here knows the Console. `travel::moves` requests one point after the other.
//!
//! | word | means |
//! |---|---|
//! | chord | a straight move between two points of the arc |
//! | sweep | the angle from start to end, negative if clockwise |
//! | across | the axis that is at right angles to the plane of the arc |

pub(in crate::machine) mod angle;
pub(in crate::machine) mod arc;

#[cfg(test)]
mod slicers;
