//! The bed and the probe as commands ask for them.

use anyhow::{Context as _, Result, bail};
use clap::Args;
use corehbot::settings::Settings;
use corehbot_rig::bed::{BedPlant, has_probe};
use corehbot_sim::bed_plant;

/// The bed under the nozzle, on a machine with a probe.
#[derive(Args)]
pub struct BedArgs {
    /// A bed and a probe that differ from the machine's settings, such as `tilt.x=0.0004,bowl=0.25,noise=0.005`. An
    /// unknown key gets a list of the known ones (docs/reference/commands.md).
    #[arg(long, value_name = "KEY=VALUE,..", allow_hyphen_values = true)]
    bed: Option<String>,
}

impl BedArgs {
    /// The bed, if the option asks for one, on a machine with these settings.
    ///
    /// # Errors
    /// No such bed, or no probe that could find it.
    pub(crate) fn plant(&self, settings: &Settings) -> Result<Option<Box<BedPlant>>> {
        let Some(text) = &self.bed else { return Ok(None) };
        if !has_probe(settings) {
            bail!("--bed: the machine has no probe; its file plugs one in (endstops.probe)");
        }
        let setup = bed_plant::read(text, settings).with_context(|| format!("--bed {text}"))?;
        Ok(Some(Box::new(BedPlant::new(settings, &setup))))
    }
}
