//! Control of heat, tested on a plant and compared with other firmwares on the same plant.

mod figures;
mod peers;
mod predictive;
mod runs;
mod tuning;
