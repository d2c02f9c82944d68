//! The belt's twin: what a belt that stretches, idlers, rotors and guides make of the steps that the firmware commands.
//!
//! For a desk, not for a microcontroller: `std`, `f64`, no random numbers but those of a seed, so the same input gives the
//! same figures. Nothing in the firmware knows of it.
//!
//! Lengths are in mm, angles in rad, forces in N, masses in kg, times in s, unless a name says otherwise; x, y are those of
//! the CoreH-bot paper: the tool's place seen from motor 1's axis, x to the right and y away from the front, angles
//! counter-clockwise seen from above. Pulleys turn by the belt that they move (radius times angle, in mm).
//!
//! The rooms, each of which uses only those above it:
//!
//! | room | job |
//! |---|---|
//! | [`params`] | the machine's dimensions, masses and stiffnesses, with their sources |
//! | [`routing`] | where the belt goes, as a table a machine |
//! | [`geometry`] | straight segments, wraps and reach, from the routing and a place of the tool |
//! | [`model`] | the segment law, and what follows from it: ways, strains, stiffness, mass |
//! | [`solve`] | equilibria and modes of a model |
//! | [`torque`] | what motors have at a speed, and what moves ask of them |
//! | [`shaping`] | input shapers for an axis that rings within a band |
//! | [`calibration`] | the machine's numbers from what its owner measured |
//! | [`queries`] | answers ready to be printed |
//! | [`dynamics`] | the machine between two steps of its motors: forces, and the integration |
//! | [`steps`] | what the firmware commanded: a trace, and which motor each of its columns turns |
//! | [`contour`] | the line along which steps send the tool, and how far the tool is from it |
//! | [`compensation`] | steps, or chords for a planner, sent ahead by what belts and motors give way |
//! | [`run`] | a trace played, and what there is to say of it |
//! | [`sampling`] | which points of a space of parameters a study looks at |
//! | [`live`] | a machine whose steps come as they are made, with power, pushes and skips |
//! | [`yin`] | Yin et al.'s CoreXY on a square, a model of its own |
//!
//! What the papers printed, what is right and what was corrected: docs/twin.md.
#![forbid(unsafe_code)]

pub mod calibration;
pub mod compensation;
pub mod contour;
pub mod dynamics;
pub mod geometry;
pub mod live;
pub mod model;
pub mod params;
pub mod queries;
pub mod routing;
pub mod run;
pub mod sampling;
pub mod shaping;
pub mod solve;
pub mod steps;
pub mod torque;
pub mod yin;
