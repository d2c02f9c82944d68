//! Contour: how far the tool is from the line that it was sent along.
//!
//! [`path`] makes the line of the steps: through places at which the tool was commanded to be, and none further from it than
//! a step. [`error`] holds the tool to it, sample by sample, and keeps what happens at each corner apart; [`pace`] says when the
//! tool was meant to be where it is, if the line is that of another file.
//!
//! The line is as good as steps are: on slanted moves the places are whole steps beside the line that was meant, so up to
//! half a step (6 um) of error there is the line's own.

pub mod cut;
pub mod error;
pub mod pace;
pub mod path;
pub mod trail;
