//! Kinematics: between where the tool is and how far each belt motor has turned.

mod corehbot;

pub use corehbot::{BeltSteps, GROUPS, Group, ToolSteps, forward, inverse, is_unstrained, residual};
