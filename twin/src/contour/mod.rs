//! Contour: the tool's distance from its commanded line.
//!
//! [`plan`] makes the line from the planned moves, without rounding. Where only steps are known, [`path`] makes it from
//! them, through commanded places and within a step of all of them. [`error`] compares the tool with it sample by
//! sample, each [`corner`] separately and [`touches`] of switches apart. [`pace`] gives the intended times if the line
//! is from another file. [`line_types`] has the errors of each type of line apart.
//!
//! Motors make whole steps, so commanded places are off the planned line by up to a step's rounding. That is told apart
//! from the tool's error. A line from steps alone may itself be off by a step.

pub mod corner;
pub mod cut;
pub mod error;
pub mod line_types;
pub mod pace;
pub mod path;
pub mod plan;
pub mod touches;
pub mod trail;
