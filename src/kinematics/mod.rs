//! Kinematics: between the tool's position and the counts of the motors.

mod forward;
mod groups;
mod mechanism;
mod residuals;
mod row;

pub use forward::ForwardKinematics;
pub use groups::{Group, Grouping, Groupings, Groups, MotorTable, SETS, count_at};
pub use mechanism::{MOST_MULTIPLE, Mechanism, MechanismError};
pub use residuals::{Residual, Residuals, motors_in};
pub use row::{Row, direction, multiple};
