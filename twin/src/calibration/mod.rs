//! Calibration: the machine's parameters from measurements that its owner can make.
//!
//! Each [`Figure`] can be measured with a ruler, a phone and a weight, and the model predicts it:
//!
//! | figure | depends on |
//! |---|---|
//! | pitch of a plucked span | preload over the mass of a metre of belt |
//! | weight of a metre of belt | that mass alone |
//! | weight of head or bar | that mass alone |
//! | force on a lever at which a motor slips | holding torque alone |
//! | deflection of the tool under a force | belt stiffness, and a little on holding torque |
//! | frequency at which an axis rings | the same, and the moving mass |
//!
//! [`calibrate`] uses all of them at once: weighted least squares of the logarithms, with each nominal value as one
//! more measurement of its assumed uncertainty. Undetermined parameters are named and make the rest as uncertain as
//! they must. If nothing is determined, that is an error.

mod calibrate;
mod figure;
mod parameter;

pub use calibrate::{CalibrateError, Calibrated, Estimate, Misfit, calibrate};
pub use figure::{Direction, Figure, Measurement, Weighed, span_tension_n};
pub use parameter::Parameter;
