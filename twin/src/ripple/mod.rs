//! Ripple: how motors, teeth and pulleys shake the tool while it moves at constant speed.
//!
//! Everything that repeats with the belt's travel is a [`source`]: it pulls at the machine at a frequency in proportion
//! to the speed. The machine's modes pass it on to the tool ([`response`]), and the part across the path is a ripple on
//! the wall (in forums "VFA", vertical fine artefacts). [`quiet`] tells which speeds are calm.
//!
//! The answer is linear: fields, belts and guides are springs and dampers about the moving machine. Dry friction is
//! constant while parts move, so it takes no part.

pub mod quiet;
pub mod response;
pub mod source;
