//! The heat of the simulated machine as commands and files define it: the true values of its heaters (`truth`), and its
//! accidents with their times.
//!
//! By default, the heat plant follows the machine's settings. Then the firmware never meets heaters that differ from
//! its settings. With `--plant-heat` the heaters have their own values, and the firmware has to find out.

pub mod truth;

use crate::accident::Accident;
use corehbot_rig::plant::PlantConstants;

/// The heaters' true values, and their accidents.
#[derive(Clone, Debug, Default)]
pub struct HeatSetup {
    /// The true values; without them, the settings.
    pub truth: Option<PlantConstants>,
    /// Accidents, by time.
    pub accidents: Vec<Accident>,
}
