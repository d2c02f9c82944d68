//! The stepper: its effect on the lines, and its step counts.

mod counts;
mod cycles;
mod playing;
mod settling;
