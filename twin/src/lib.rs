//! The belt's twin: what a belt that stretches, idlers, rotors and guides make of the steps that the firmware commands.
//!
//! For a desk, not for a microcontroller: `std`, `f64`, no random numbers, so the same input gives the same figures. Nothing
//! in the firmware knows of it.
//!
//! Lengths are in mm, angles in rad, forces in N, masses in kg, times in s, unless a name says otherwise; x, y are those of
//! the CoreH-bot paper: the tool's place seen from motor 1's axis, x to the right and y away from the front.
#![forbid(unsafe_code)]

pub mod yin;
