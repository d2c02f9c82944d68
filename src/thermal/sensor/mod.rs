//! Sensors: from samples of the converter to a temperature that can be trusted, or a fault.
//!
//! Kinds of sensor are variants of [`settings::Thermistor`](crate::settings::Thermistor), which says where each is known; `curve`
//! has their numbers.

mod curve;
mod filter;
mod logarithm;

pub use curve::{Curve, Reading};
pub use filter::{Contact, Filter};
