//! Kinematics: between where the tool is and how far each motor has turned.

mod corehbot;
mod groups;
mod mechanism;
mod way_back;

pub use corehbot::{BeltSteps, ToolSteps, forward, inverse, residual};
pub use groups::{Group, Groups, MotorTable, SETS, count_at};
pub use mechanism::{Mechanism, MechanismError, Row};
pub use way_back::WayBack;
