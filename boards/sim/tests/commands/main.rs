//! Every command that slicers and hosts send: what each is answered, as a table.
//!
//! The rows are those that a printer of this dialect must or should know. What belongs to heaters, probing, storage
//! or motor drivers stands here with the words in which this firmware says what it does not do.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod answers;
mod asker;
#[path = "../common/deaf.rs"]
mod deaf;
mod effects;
mod table;
