//! Control of heat, tested on a plant and compared with other firmwares on the same plant.

mod figures;
mod mats;
mod peers;
mod predictive;
mod ptc;
mod runs;
mod tuning;
