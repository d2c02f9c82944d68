//! The stepper: what it does to the lines, and how its steps are counted.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod clock;
mod counts;
mod cycles;
mod playing;
mod settling;
