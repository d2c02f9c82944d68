//! Kinematics: between where the tool is and how far each motor has turned.

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
