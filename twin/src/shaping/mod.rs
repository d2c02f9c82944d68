//! Shaping: input shapers for an axis with a known band of frequencies.
//!
//! [`shaper`] has the firmware's shapers (docs/explanation/shaping.md), implemented separately from the literature:
//! residual vibration and corner rounding. [`design`] finds the one with the least vibration over a band, [`by_tool`]
//! the one with the least error of the tool on printed walls ([`wall`]). [`fit`] separates belts from motors by
//! measured frequencies.

pub mod by_tool;
pub mod design;
pub mod fit;
pub mod shaper;
pub mod wall;
