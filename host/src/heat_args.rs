//! The plant of heat as commands ask for it.

use crate::input;
use anyhow::{Context as _, Result, bail};
use clap::Args;
use corehbot::settings::Settings;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_rig::heat::constants;
use corehbot_sim::asked;
use corehbot_sim::bed_plant::ProbeAccident;
use corehbot_sim::heat_plant::{HeatSetup, truth};
use std::path::{Path, PathBuf};

/// The plant of heat as commands ask for it.
#[derive(Args)]
pub struct HeatArgs {
    /// File with the heaters' true values, whatever the machine's settings say (docs/explanation/heat.md).
    #[arg(long, value_name = "H.toml")]
    plant_heat: Option<PathBuf>,
    /// Breaks something: part, place and time after power-up, such as `open:hotend@60s`, `stuck-on:bed@10m`,
    /// `fan-dead:part@2m` or `early:probe@1m`. May be repeated. An unknown word gets a list of the known ones.
    #[arg(long = "break", value_name = "WHAT[:WHERE]@TIME")]
    breaks: Vec<String>,
}

impl HeatArgs {
    /// The file that it reads.
    pub fn file(&self) -> Option<&Path> {
        self.plant_heat.as_deref()
    }

    /// The accidents of the probe, on a machine with these settings.
    ///
    /// # Errors
    /// No such accident, or no probe that could break.
    pub fn probe_accidents(&self, settings: &Settings) -> Result<Vec<ProbeAccident>> {
        Ok(asked::probe_accidents(&self.breaks, settings)?)
    }

    /// The setup that the options ask for, on a machine with these settings.
    ///
    /// # Errors
    /// No such accident, a plant that cannot be, or no heater that could break.
    pub fn setup(&self, settings: &Settings) -> Result<HeatSetup> {
        let accidents = asked::heat_accidents(&self.breaks, settings)?;
        let Some(path) = &self.plant_heat else { return Ok(HeatSetup { truth: None, accidents }) };
        if !settings.thermal.has_heater() {
            bail!("--plant-heat: the machine has no heater; fit one in its file (heaters.hotend.is_fitted = true)");
        }
        let text = input::text(path, Wanted::Heaters)?;
        let truth = truth::read(&text, constants(&settings.thermal)).with_context(|| path.display().to_string())?;
        Ok(HeatSetup { truth: Some(truth), accidents })
    }
}
