//! Kinematics: between the tool's position and the counts of the motors.

mod forward;
mod groups;
mod mechanism;
mod residuals;
mod row;
mod screws;

pub use forward::ForwardKinematics;
pub use groups::{Group, Grouping, Groupings, Groups, MotorTable, SETS, count_at};
pub use mechanism::{Mechanism, MechanismError};
pub use residuals::{Residual, Residuals, motors_in};
pub use row::{MOST_MULTIPLE, MOST_NUMBER, Row, direction, multiple, row_number, row_of};
pub use screws::{FitError, Place, SCREWS, heights_at_screws};
