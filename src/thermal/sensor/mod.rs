//! Sensors: from samples of the converter to a temperature that can be trusted, or a fault.

mod curve;
mod filter;
mod logarithm;

pub use curve::{Curve, Reading};
pub use filter::{Contact, Filter};
