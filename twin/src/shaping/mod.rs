//! Shaping: input shapers for an axis with a known band of frequencies.
//!
//! [`shaper`] has the firmware's shapers (docs/explanation/shaping.md), implemented separately from the literature:
//! residual vibration and corner rounding. [`design`] finds the one with the least vibration over a band. [`fit`]
//! separates belts from motors by measured frequencies.

pub mod design;
pub mod fit;
pub mod shaper;
