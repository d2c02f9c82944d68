//! Every command that slicers and hosts send, with its answer.
//!
//! Lines and answers are the examples in the files of the commands. The machine of this test has no heaters, no probe
//! and no storage; so their examples have the messages about that.

mod answers;
mod asker;
mod capabilities;
mod effects;
mod known;

use crate::common::deaf;
use crate::common::plain_lines;
