//! The heat of the simulated machine as commands and files have it: the truth of its heaters (`truth`), and what breaks
//! and when (`accident`).
//!
//! Without a word of it, the plant of heat is what the machine's settings say. A firmware with the wrong idea of its
//! heaters is then never met: with `--plant-heat` they are what they are, and the firmware has to find out.

pub mod accident;
pub mod truth;

pub use accident::{Accident, AccidentError};

use corehbot_rig::plant::PlantConstants;

/// What the heaters are, and what befalls them.
#[derive(Clone, Debug, Default)]
pub struct HeatSetup {
    /// What they are; without it, what the settings say.
    pub truth: Option<PlantConstants>,
    /// What breaks, by time.
    pub accidents: Vec<Accident>,
}
