//! The plant of heat as commands ask for it.

use crate::input;
use anyhow::{Context as _, Result, bail};
use clap::Args;
use corehbot::settings::Settings;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_rig::thermal_plant::constants;
use corehbot_sim::accident::Accident;
use corehbot_sim::heat_plant::{HeatSetup, truth};
use std::path::{Path, PathBuf};

/// The plant of heat as commands ask for it.
#[derive(Args)]
pub struct HeatArgs {
    /// File with the heaters' true values, whatever the machine's settings say (docs/explanation/heat.md).
    #[arg(long, value_name = "H.toml")]
    plant_heat: Option<PathBuf>,
}

impl HeatArgs {
    /// The file that it reads.
    pub fn file(&self) -> Option<&Path> {
        self.plant_heat.as_deref()
    }

    /// The setup that the options ask for, on a machine with these settings and accidents of heat.
    ///
    /// # Errors
    /// A plant that cannot be.
    pub fn setup(&self, settings: &Settings, accidents: Vec<Accident>) -> Result<HeatSetup> {
        let Some(path) = &self.plant_heat else { return Ok(HeatSetup { truth: None, accidents }) };
        if !settings.thermal.has_heater() {
            bail!("--plant-heat: the machine has no heater; fit one in its file (heaters.hotend.is_fitted = true)");
        }
        let text = input::text(path, Wanted::Heaters)?;
        let truth = truth::read(&text, constants(&settings.thermal)).with_context(|| path.display().to_string())?;
        Ok(HeatSetup { truth: Some(truth), accidents })
    }
}
