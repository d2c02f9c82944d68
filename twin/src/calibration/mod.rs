//! Calibration: the machine's numbers from measurements that its owner can make.
//!
//! Each [`Figure`] is something that can be measured with a ruler, a phone and a weight, and that the model foretells:
//!
//! | figure | depends on |
//! |---|---|
//! | pitch of a plucked span | preload alone |
//! | weight of head or bar | that mass alone |
//! | force on a lever at which a motor slips | holding torque alone |
//! | deflection of the tool under a force | belt stiffness, and a little on holding torque |
//! | frequency at which an axis rings | the same, and the mass that moves |
//!
//! [`calibrate`] takes all of them at once: weighted least squares of the logarithms. What hardly any figure depends on keeps
//! its value; what the figures together do not determine is an error, never a guess.

mod calibrate;
mod figure;
mod parameter;

pub use calibrate::{CalibrateError, Calibrated, Estimate, Misfit, calibrate};
pub use figure::{Direction, Figure, Measurement, Weighed, span_tension_n};
pub use parameter::Parameter;
