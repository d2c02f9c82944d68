//! Calibration: the machine's numbers from measurements that its owner can make, for every routing.
//!
//! Each [`Figure`] can be measured with a ruler, a phone and a weight, or with an accelerometer, and the model predicts
//! it:
//!
//! | figure | depends on |
//! |---|---|
//! | pitch of a plucked span | the belt's tension over the mass of a metre |
//! | weight of a metre of belt | that mass alone |
//! | weight of head, bar, gantry or bed | that mass alone |
//! | force on a lever at which a motor slips | holding torque alone |
//! | deflection of the tool under a force | belt stiffness, a little holding torque; beside the middle the yaw too |
//! | the same along a diagonal | of crossed belts, the stiffness of one |
//! | frequency at which an axis rings | stiffness and the moving mass |
//! | frequency at which the bar yaws | the yaw's stiffness and inertia |
//! | damping of an axis | damping of belts and guides |
//! | skew that the belts make | difference of their tensions over the yaw's stiffness |
//!
//! [`calibrate`] uses all of them at once: weighted least squares of the logarithms, with what is expected of each
//! number as one more measurement. Undetermined numbers are named and make the rest as uncertain as they must. If
//! nothing is determined, that is an error. An answer says which measurement would help most next.
//!
//! | file | content |
//! |---|---|
//! | `figure` | the figures, and the model's value of each |
//! | `parameter` | the numbers, and what is expected of them |
//! | `search` | the best machine and its covariance |
//! | `calibrate` | the answer: numbers, sources, differences, refusal |
//! | `error` | differences, and why there is no answer |
//! | `further` | the measurements that would help most |

mod calibrate;
mod error;
mod figure;
mod further;
mod parameter;
mod search;

pub use calibrate::{Calibrated, Estimate, calibrate};
pub use error::{CalibrateError, Misfit};
pub use figure::{Direction, Figure, Measurement, Model, Weighed, span_tension_n};
pub use further::{Further, Improved};
pub use parameter::{Parameter, Unknown};
