//! Every machine of `examples/machines` prints: it homes, and every step is as its rows and limits say.
#![allow(clippy::unwrap_used, clippy::panic, reason = "clippy does not see that the helpers here belong to tests")]

mod answers;
mod circulation;
mod eight_motors;
mod endstops;
#[path = "../common/lines.rs"]
mod lines;
mod print;
mod prints;
mod shared_motors;
mod stops;
