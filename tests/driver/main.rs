//! The drivers' room against a bus that answers as a test wants.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod bench;
mod changes;
mod proof;
mod watch;
