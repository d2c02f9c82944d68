//! Control of heat, held against a plant and against what other firmwares do with the same plant.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod figures;
mod peers;
mod predictive;
mod printer;
mod runs;
mod tuning;
