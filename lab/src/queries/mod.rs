//! Queries: answers as tables for people, and as figures with units in their names for programs.
//!
//! [`compare`] has machines of one size, [`frame`] the torque on the frame and [`soft_frame`] its vibration,
//! [`misalignment`] pulleys off their places. [`paper`] compares the CoreH-bot paper with the model. [`zigzag`] and
//! [`level`] answer Carlyle about his CoreXYZ, with sentences of papers as [`claim`]s.

pub mod claim;
pub mod compare;
pub mod frame;
pub mod level;
pub mod misalignment;
pub mod paper;
pub mod soft_frame;
pub mod zigzag;
