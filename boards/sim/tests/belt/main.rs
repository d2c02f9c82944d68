//! Prints on the belt plant: the firmware's commands, and their effect.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod accidents;
mod alignment;
mod buzz;
mod ended;
#[path = "../common/life.rs"]
#[allow(dead_code, reason = "other tests need all of it")]
mod life;
mod limp;
mod loads;
mod machines;
mod parts;
mod phases;
mod power;
mod printer;
mod pulleys;
mod quiet;
mod routings;
mod skips;
mod trust;
