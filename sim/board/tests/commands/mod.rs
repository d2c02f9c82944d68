//! Every command that slicers and hosts send, with its answer, as a table.
//!
//! The rows are the commands that a printer of this dialect must or should know. The machine of this test has no
//! heaters, no probe and no storage; so their rows have the messages about that.

mod answers;
mod asker;
mod capabilities;
mod effects;
mod known;
pub mod table;

use crate::common::deaf;
use crate::common::plain_lines;
