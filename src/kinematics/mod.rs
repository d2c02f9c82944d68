//! Kinematics: between where the tool is and how far each motor has turned.

mod corehbot;
mod forward;
mod groups;
mod mechanism;

pub use corehbot::{BeltSteps, ToolSteps, forward, inverse, residual};
pub use forward::ForwardKinematics;
pub use groups::{Group, Groups, MotorTable, SETS, count_at};
pub use mechanism::{Mechanism, MechanismError, Row};
