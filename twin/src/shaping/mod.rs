//! Shaping: input shapers for an axis whose frequency is known within a band.
//!
//! [`shaper`] has the shapers of the firmware (docs/shaping.md), written anew from the literature: what they leave of a
//! vibration, and by how much they round corners. [`design`] finds the one that leaves least over a band. [`fit`] tells
//! belts from motors by frequencies that were measured.

pub mod design;
pub mod fit;
pub mod shaper;
