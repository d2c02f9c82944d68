//! Control of heat, tested on a plant and compared with other firmwares on the same plant.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

mod figures;
mod peers;
mod predictive;
mod printer;
mod runs;
mod tuning;
