//! Kinematics: between where the tool is and how far each motor has turned.

mod groups;
mod mechanism;
mod way_back;

pub use groups::{Group, Groups, MotorTable, SETS, count_at};
pub use mechanism::{Mechanism, MechanismError, Row};
pub use way_back::WayBack;
