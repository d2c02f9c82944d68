//! Contour: the tool's distance from its commanded line.
//!
//! [`path`] makes the line from the steps, through commanded places and within a step of all of them. [`error`]
//! compares the tool with it sample by sample, and treats each corner separately. [`pace`] gives the intended times if
//! the line is from another file.
//!
//! Steps limit the accuracy of the line: on slanted moves its places are whole steps, so up to half a step (6 um) of
//! error is the line's own.

pub mod cut;
pub mod error;
pub mod pace;
pub mod path;
pub mod trail;
