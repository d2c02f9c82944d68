//! Kinematics: between where the tool is and how far each belt motor has turned.

mod corehbot;

pub use corehbot::{
    BeltSteps, GROUPS, Group, ToolSteps, count_at, forward, forward_motors, inverse, is_unstrained, motor_counts,
    motors, residual,
};
