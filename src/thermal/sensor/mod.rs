//! Sensors: samples of the converter become a reliable temperature, or a fault.
//!
//! Kinds of sensor are variants of [`settings::Thermistor`](crate::settings::Thermistor), which lists where each is
//! used; `curve` has their numbers.

mod curve;
mod filter;
mod logarithm;

pub use curve::{Curve, Reading};
pub use filter::{Contact, Filter};
