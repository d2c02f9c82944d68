//! Prints on the belt plant: the firmware's commands, and their effect.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod accidents;
mod alignment;
mod buzz;
mod ended;
mod limp;
mod loads;
mod machines;
mod parts;
mod phases;
mod power;
mod printer;
mod quiet;
mod routings;
mod skips;
mod trust;
