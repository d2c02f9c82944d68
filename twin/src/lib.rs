//! The belt's twin: how elastic belts, idlers, rotors and guides respond to the steps that the firmware commands.
//!
//! For a host computer, not for a microcontroller: `std`, `f64`, no random numbers except from a seed, so the same
//! input gives the same figures. The firmware does not depend on it.
//!
//! Lengths are in mm, angles in rad, forces in N, masses in kg, times in s, unless a name says otherwise. As in the
//! CoreH-bot paper, x and y are the tool's place seen from motor 1's axis, x to the right and y away from the front.
//! Angles are counter-clockwise seen from above. Pulley rotation is given as belt travel (radius times angle, in mm).
//!
//! Each room uses only the rooms above it:
//!
//! | room | job |
//! |---|---|
//! | [`math`] | sines, exponentials and roots with the same bits on every platform |
//! | [`random`] | random numbers from a seed |
//! | [`params`] | the machine's dimensions, masses and stiffnesses, with their sources |
//! | [`routing`] | the run of the belts, as a table per machine |
//! | [`description`] | a machine as its file has it: routing and numbers |
//! | [`geometry`] | straight segments, wraps and reach, from the routing and a place of the tool |
//! | [`model`] | the segment law and its results: transmission, strains, stiffness, mass |
//! | [`solve`] | equilibria and modes of a model |
//! | [`torque`] | available torque at a speed, and the torque that moves need |
//! | [`shaping`] | input shapers for an axis that rings within a band |
//! | [`calibration`] | the machine's parameters from its owner's measurements |
//! | [`ripple`] | how motors, teeth and pulleys shake the tool at constant speed |
//! | [`queries`] | answers ready to be printed |
//! | [`dynamics`] | the machine between two steps of its motors: forces, and the integration |
//! | [`steps`] | the commanded steps: a trace, and the motor of each of its columns |
//! | [`contour`] | the commanded line of the tool, and its distance from the tool |
//! | [`run`] | a played trace and its report |
//! | [`stepped_machine`] | a machine that takes steps as they are made, with power, pushes and skips |
//!
//! Misprints of the papers and their corrections: docs/research/twin.md.
#![forbid(unsafe_code)]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod calibration;
pub mod contour;
pub mod description;
pub mod dynamics;
pub mod geometry;
pub mod math;
pub mod model;
pub mod params;
pub mod queries;
pub mod random;
pub mod ripple;
pub mod routing;
pub mod run;
pub mod shaping;
pub mod solve;
pub mod stepped_machine;
pub mod steps;
pub mod torque;
