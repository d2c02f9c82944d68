//! The stepper: its effect on the lines, and its step counts.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod clock;
mod counts;
mod cycles;
mod playing;
mod settling;
