//! Every command that slicers and hosts send, with its answer, as a table.
//!
//! The rows are the commands that a printer of this dialect must or should know. The machine of this test has no
//! heaters, no probe and no storage; so their rows have the messages about that.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod answers;
mod asker;
mod capabilities;
#[path = "../common/deaf.rs"]
mod deaf;
mod effects;
mod known;
#[path = "../common/plain_lines.rs"]
mod plain_lines;
mod table;
